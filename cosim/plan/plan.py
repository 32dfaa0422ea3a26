"""The plan of a run, resolved to slots of one array: every engine runs it.

All values of a run stand in one float64 array, `memory` of shape (memory_size,). Each input, and each output
that is recorded or connected, has a slot; Integer, Boolean and Enumeration values are stored as floats, and
so are the numbers of texts (`texts`). An output that is not sampled has two: `valid` holds its value at the
current communication point t_k, `latest` the one after the unit's last step (t_{k+1} once it has stepped). An
input over a bus, or one that nothing drives, has a mailbox beside its slot: the value last received, or set
by the user. An input slot is written from its route each step, so an override or a bias acts on what the unit
receives and never on what was sent.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..can.bus_settings import BusSettings
from ..can.channel import SignalRoute
from ..can.database import Message
from ..can.framing import Framing
from ..can.logs.replay import Replayed
from ..can.send_types import Sending
from ..clock import Clock
from ..results.results import ResultVariable
from ..system.fault_spec import Fault
from ..system.scenario import Event
from ..system.stimuli import TimeFunction, initial_value
from ..system.system import Algorithm, Experiment
from ..texts import Texts
from ..units.measure import Affine
from .unit_plan import UnitPlan


@dataclasses.dataclass(frozen=True)
class Link:
    """A direct connection, by variable name, for initialization. `map` converts into the receiver's unit."""

    source: tuple[str, str]
    sink: tuple[str, str]
    map: Affine


@dataclasses.dataclass(frozen=True)
class Drive:
    """A stimulus: `signal` over time in its own unit, converted by `map`, drives the input slot `sink`."""

    variable: str
    sink: int
    signal: TimeFunction
    map: Affine

    def at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values that the input receives at the times [s], both of shape (n,)."""
        return self.map.scale * self.signal(times) + self.map.offset

    def first(self, start_time: float) -> float:
        """Return the value that the input has in the initialization, which is at the start time [s]."""
        return self.map(initial_value(self.signal, start_time))


@dataclasses.dataclass(frozen=True)
class MessagePlan:
    """A message that is sent at the steps k with k >= first and (k - first) % every == 0.

    It is sampled at the start of the step (`after` is None), or right after the turn of the unit with index
    `after`, where sampled outputs come from that unit's step. `settings` are those of its
    bus; `every`, `delay` and the signals of `message` follow from them. `senders` are the variables behind
    the signals, for messages to the user.

    With a `delay` of d > 0 steps the routes end in slots of their own, and what a transmission writes there
    reaches the mailboxes d steps later, at the same place in the step: `arrivals` are the pairs (slot,
    mailbox). A message with a `framing` is sent as the bytes of a frame: its routes end in the mailboxes.

    A multiplexed message has a plan for each page that is sent; `page` are the raw values of its
    multiplexers by name. In `latest` [ps] as many of its frames are sent as faults make late at once.
    By its `sending` it may be looked at only at these steps, and sent where there is something to send.

    A message that is `replayed` is sent by nobody: its frames come from a log, in a ReplayPlan, and `every`
    and `first` say when somebody looks whether one came.
    """

    bus: str
    message: Message
    settings: BusSettings
    routes: tuple[SignalRoute, ...]
    senders: dict[str, str]
    every: int
    first: int
    after: int | None
    delay: int = 0
    arrivals: tuple[tuple[int, int], ...] = ()
    framing: Framing | None = None
    page: Mapping[str, int] = dataclasses.field(default_factory=dict)
    latest: int = 0
    sending: Sending = Sending()  # noqa: RUF009 - Sending is frozen, so a shared default is safe
    replayed: bool = False

    @property
    def label(self) -> str:
        """The name of the message, and of a page the raw values of its multiplexers, as "MSG Page = 1"."""
        return self.message.name + "".join(f" {name} = {raw}" for name, raw in self.page.items())

    @property
    def watched(self) -> bool:
        """True where somebody looks, once a cycle, whether a frame came."""
        own = self.settings.of_message(self.message.name)
        return self.framing is not None and self.sending.regular and self.framing.watched(own)

    @property
    def cycle(self) -> int:
        """The steps from one frame to the next, where one comes regularly."""
        apart = -(-self.sending.interval // self.every) * self.every
        return self.sending.cycle or max(self.every, apart)

    @property
    def timed(self) -> bool:
        """True where its frames take time on the bus."""
        return self.settings.timing == "frame"


@dataclasses.dataclass(frozen=True)
class FaultPlan:
    """A fault from `since` to before `until` [ps after the start], on a message or a node of a bus.

    `varied`: it is a loss of a `BusVariation`, and not of the scenario.
    """

    fault: Fault
    bus: str
    message: str
    node: str
    since: int
    until: int
    varied: bool = False


@dataclasses.dataclass(frozen=True)
class ReplayPlan:
    """A log whose frames are replayed on a bus.

    `counts` are the frames within the run by message; `before` and `after` are those before its start and not
    before its stop time. `span` are the times [s] of the run at which the channel of the log begins and ends,
    and its times are rounded to `resolution` [s].
    """

    bus: str
    path: Path
    frames: Replayed
    counts: Mapping[str, int]
    span: tuple[float, float]
    resolution: float
    before: int
    after: int

    def as_data(self) -> dict[str, object]:
        """Return what is replayed, for JSON."""
        return {
            "bus": self.bus,
            "file": self.path.name,
            "channel": self.frames.channel,
            "offset": self.frames.offset * 1e-9,
            "first": self.span[0],
            "last": self.span[1],
            "resolution": self.resolution,
            "messages": dict(self.counts),
            "before": self.before,
            "after": self.after,
        }


@dataclasses.dataclass(frozen=True)
class Plan:
    """A system with a scenario, ready to run at the times of `clock`.

    `events` have the step at which each happens, in order. `inputs` are by "unit.variable"; column j of the
    results shows the slot `column_slots[j]`, and of the texts the slot `text_slots[j]`. `texts` has the texts
    whose numbers stand in slots. `initial` are the values of slots, in the inputs' own units,
    before anything was computed or received. `unreached` are sentences on what the stop time leaves no time
    for. `babblers` are the frames of those of `faults` that babble, in their order; `receiving_nodes` are bus
    and node of mailboxes whose node can be off the bus.
    """

    system: str
    scenario: str
    experiment: Experiment
    algorithm: Algorithm
    clock: Clock
    ideal: bool
    units: tuple[UnitPlan, ...]
    links: tuple[Link, ...]
    messages: tuple[MessagePlan, ...]
    drives: tuple[Drive, ...]
    events: tuple[tuple[int, Event], ...]
    inputs: dict[str, InputPlan]
    columns: tuple[ResultVariable, ...]
    column_slots: tuple[int, ...]
    initial: dict[int, float]
    memory_size: int
    warnings: tuple[str, ...]
    text_columns: tuple[ResultVariable, ...] = ()
    text_slots: tuple[int, ...] = ()
    texts: Texts = dataclasses.field(default_factory=Texts, compare=False)
    unreached: tuple[str, ...] = ()
    faults: tuple[FaultPlan, ...] = ()
    babblers: tuple[MessagePlan, ...] = ()
    receiving_nodes: Mapping[int, tuple[str, str]] = dataclasses.field(default_factory=dict)
    replays: tuple[ReplayPlan, ...] = ()

    @functools.cached_property
    def timed_buses(self) -> tuple[str, ...]:
        """The buses on which frames take time."""
        return tuple(dict.fromkeys(message.bus for message in self.messages if message.timed))

    @functools.cached_property
    def framed_bus(self) -> str:
        """The first bus that has frames, whose times count; "" where there is none."""
        return next((message.bus for message in self.messages if message.framing is not None), "")

    @property
    def steps(self) -> int:
        """The number of communication steps to the stop time."""
        return self.clock.steps

    def open_ended(self) -> Plan:
        """Return the plan of a run that may be stepped beyond the stop time, which units are not told."""
        return dataclasses.replace(self, clock=dataclasses.replace(self.clock, told=False), unreached=())

    @functools.cached_property
    def text_names(self) -> dict[str, int]:
        """The slots that show the recorded texts at the communication point, by "unit.variable"."""
        return {c.name: slot for c, slot in zip(self.text_columns, self.text_slots, strict=True)}

    @functools.cached_property
    def slots(self) -> dict[str, int]:
        """The slots that show the recorded variables at the communication point, by "unit.variable"."""
        return {c.name: slot for c, slot in zip(self.columns, self.column_slots, strict=True)}


@dataclasses.dataclass(frozen=True)
class InputPlan:
    """An input: its slot, its mailbox (None: it has none), and what drives it ("": nothing)."""

    slot: int
    mailbox: int | None
    driver: str
