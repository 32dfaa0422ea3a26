"""The python engine: one communication step after the other, in the order that a reader would write.

Time is a count: t_k = start + k * step_size. What step k does, under `gauss_seidel`:

1. stimuli and the messages that are due and carry outputs valid at t_k are written to the inputs' side;
2. each unit in written order, if k is a multiple of its period: its inputs are taken, overrides and
   biases applied, it steps to t_k + period, and its outputs are read. They are visible to later units at
   once; the continuous ones of a unit whose period is longer than a step only from the communication
   point on at which they are valid. A message with discrete signals is sent right after its sender's turn.
   On a bus with a delay, what was sent that long ago arrives where a message would be sent;
3. row k is recorded: the inputs of this step, discrete outputs after it, continuous ones valid at t_k.

Under `jacobi` all messages are sent and all inputs taken before any unit steps, so that every value takes
one communication step to arrive.
"""

from __future__ import annotations

import dataclasses
import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..cosim.channel import ChannelError, MessageChannel
from ..cosim.errors import RunError
from ..cosim.plan import MessagePlan, Plan, Route, UnitPlan
from ..cosim.rows import RowStore, Table
from .unit import Unit, floats

_CHUNK = 256
"""Steps between two looks at progress and Ctrl-C; stimuli are evaluated for so many steps at once."""


def compile_routes(routes: Sequence[Route]) -> Callable[[memoryview[float]], None]:
    """A function that writes all inputs of a unit from their routes: one assignment for each."""
    lines = [f"    m[{r.sink}] = {r.map.expression(f'm[{r.source}]')}" for r in routes] or ["    pass"]
    scope: dict[str, Callable[[memoryview[float]], None]] = {}
    exec("def take(m):\n" + "\n".join(lines), scope)
    return scope["take"]


class _Turn:
    """One unit in the schedule, with what happens round its step."""

    def __init__(self, unit: Unit, plan: UnitPlan, run: Engine) -> None:
        self.unit = unit
        self.every = plan.every
        self.take = compile_routes(plan.routes)
        self.set_inputs, self.get_feedthrough = unit.set_inputs, unit.get_feedthrough
        self.start_step, self.finish_step = unit.start_step, unit.finish_step
        self.get_outputs = unit.get_outputs
        self.step_size = run.plan.experiment.step_size * plan.every / plan.substeps
        self.substeps = plan.substeps
        outputs = [b for b in plan.blocks if b.kind != "input"]
        self.continuous = [
            (slice(b.slot, b.slot + n), run.view[b.latest : b.latest + n])
            for b in outputs
            if b.kind == "continuous"
            for n in [len(b.variables)]
        ]
        self.read = [
            (run.view[f : f + len(b.variables)], b)
            for b in outputs
            if b.type == "Real"
            for f in [b.latest if b.kind == "continuous" else b.slot]
        ]
        self.has_feedthrough = any(b.feedthrough for b in outputs)
        self.effects: dict[int, tuple[Literal["override", "bias"], float]] = {}

    def apply_effects(self, memory: memoryview[float]) -> None:
        for slot, (action, value) in self.effects.items():
            memory[slot] = value if action == "override" else memory[slot] + value

    def check_finite(self) -> None:
        """Raise RunError when an output that was just read is NaN or infinite."""
        for values, block in self.read:
            # NaN and infinity survive the sum: the fastest way to see one; so may a sum of huge values look
            if not math.isfinite(sum(values)):
                for v, value in zip(block.variables, values, strict=True):
                    if not math.isfinite(value):
                        unit = f" {v.unit}" if v.unit else ""
                        raise RunError(f"{self.unit.name}.{v.name} = {value}{unit}: an output must be finite")


@dataclasses.dataclass
class _Sender:
    """A message in the schedule."""

    plan: MessagePlan
    channel: MessageChannel

    def send(self, memory: memoryview[float], k: int) -> None:
        if k >= self.plan.first and (k - self.plan.first) % self.plan.every == 0:
            self.sample(memory, k)

    def sample(self, memory: memoryview[float], k: int) -> None:
        try:
            self.channel.transmit(memory, k)
        except ChannelError as error:
            name = f"{self.plan.bus}.{self.plan.message.name}.{error.signal}"
            sender = self.plan.senders.get(error.signal, "")
            raise RunError(f"{sender} via {name}: {error.rule}") from error


@dataclasses.dataclass
class _LateSender(_Sender):
    """A message whose values reach the mailboxes `plan.delay` steps after they were sampled."""

    under_way: deque[tuple[int, list[float]]] = dataclasses.field(default_factory=deque)

    def send(self, memory: memoryview[float], k: int) -> None:
        while self.under_way and self.under_way[0][0] <= k:
            _, values = self.under_way.popleft()
            for (_, mailbox), value in zip(self.plan.arrivals, values, strict=True):
                memory[mailbox] = value
        super().send(memory, k)

    def sample(self, memory: memoryview[float], k: int) -> None:
        super().sample(memory, k)
        values = [memory[slot] for slot, _ in self.plan.arrivals]
        self.under_way.append((k + self.plan.delay, values))


class Engine:
    """A plan with its units, and the steps done so far.

    `recorded` gives the rows up to now; those of long runs are in a temporary file (see `cosim.rows`).
    """

    def __init__(self, plan: Plan, units: Mapping[str, Unit], log_raw: bool = False) -> None:
        self.plan = plan
        self.k = 0
        self.whole = True
        self.memory: NDArray[np.float64] = np.zeros(plan.memory_size)
        self._columns = np.array(plan.column_slots, dtype=np.intp)
        self.view = floats(self.memory)
        for unit_plan in plan.units:
            units[unit_plan.name].bind(self.memory, unit_plan)
        self.turns = [_Turn(units[p.name], p, self) for p in plan.units]
        self.senders = [
            (_LateSender if m.delay else _Sender)(m, self._channel(m, log_raw)) for m in plan.messages
        ]
        self._at_start = [s for s in self.senders if s.plan.after is None]
        self._after = [[s for s in self.senders if s.plan.after == i] for i in range(len(self.turns))]
        self._events = list(plan.events)
        self._store = RowStore(len(self._columns))
        self._step = self._gauss_seidel if plan.algorithm == "gauss_seidel" else self._jacobi
        self._by_slot = {b.slot + i: t for t, p in zip(self.turns, plan.units, strict=True)
                         for b in p.blocks if b.kind == "input" for i in range(len(b.variables))}  # fmt: skip

    @staticmethod
    def _channel(plan: MessagePlan, log_raw: bool) -> MessageChannel:
        return MessageChannel(plan.message, plan.routes, plan.settings, log_raw=log_raw)

    @property
    def time(self) -> float:
        """The current communication point t_k [s]."""
        return self.time_at(self.k)

    def time_at(self, k: int) -> float:
        """t_k [s]."""
        return self.plan.experiment.start_time + k * self.plan.experiment.step_size

    def start(self) -> None:
        """Read all outputs at the start time. The units have left initialization mode."""
        for slot, value in self.plan.initial.items():
            self.memory[slot] = value
        for turn in self.turns:
            turn.get_outputs()
            self._publish(turn)
            turn.check_finite()

    # ---- stepping

    def advance(self, steps: int, progress: Callable[[int], None] | None = None) -> None:
        """Do `steps` steps. What was recorded before an error or Ctrl-C is kept.

        Raises UnitError or RunError with the unit, the time and the reason.
        """
        end = self.k + steps
        while self.k < end:
            count = min(_CHUNK, end - self.k)
            self._advance_chunk(count)
            if progress is not None:
                progress(self.k)

    def _advance_chunk(self, count: int) -> None:
        times = np.array([self.time_at(k) for k in range(self.k, self.k + count)])
        drives = [(d.sink, (d.map.scale * d.signal(times) + d.map.offset).tolist()) for d in self.plan.drives]
        width = int(self._columns.max(initial=-1)) + 1
        rows = np.empty((count, width))
        first, view, row = self.k, self.view, self.memory[:width]
        try:
            for i in range(count):
                while self._events and self._events[0][0] <= self.k:
                    self._happen()
                for slot, values in drives:
                    view[slot] = values[i]
                self._step(self.k, self.time_at(self.k))
                rows[i] = row
                self._publish_all(self.k)
                self.k += 1
        except RunError as error:
            raise type(error)(f"at t = {self.time:.6g} s (step {self.k}): {error}") from error
        finally:
            self.whole = self.k == first + count
            self._store.append(rows[: self.k - first, self._columns])

    def _gauss_seidel(self, k: int, time: float) -> None:
        memory = self.view
        for sender in self._at_start:
            sender.send(memory, k)
        for turn, messages in zip(self.turns, self._after, strict=True):
            if k % turn.every == 0:
                turn.take(memory)
                self._begin(turn, time)
                self._end(turn)
            for sender in messages:
                sender.send(memory, k)

    def _jacobi(self, k: int, time: float) -> None:
        memory = self.view
        for sender in self.senders:
            sender.send(memory, k)
        due = [turn for turn in self.turns if k % turn.every == 0]
        for turn in due:
            turn.take(memory)
        for (
            turn
        ) in due:  # all begin before any is waited for: units in processes of their own step side by side
            self._begin(turn, time)
        for turn in due:
            self._end(turn)

    def _begin(self, turn: _Turn, time: float) -> None:
        if turn.effects:
            turn.apply_effects(self.view)
        turn.set_inputs()
        if turn.has_feedthrough:
            turn.get_feedthrough()
        turn.start_step(time, turn.step_size, turn.substeps)

    @staticmethod
    def _end(turn: _Turn) -> None:
        turn.finish_step()
        turn.get_outputs()
        turn.check_finite()

    def _publish_all(self, k: int) -> None:
        for turn in self.turns:
            if (k + 1) % turn.every == 0:
                self._publish(turn)

    def _publish(self, turn: _Turn) -> None:
        """The continuous outputs after the step become those valid at the next communication point."""
        for valid, latest in turn.continuous:
            self.view[valid] = latest

    # ---- events and results

    def _happen(self) -> None:
        _, event = self._events.pop(0)
        self.effect(event.variable, event.action, event.value)

    def effect(self, name: str, action: str, value: float | None = None) -> None:
        """Override or bias what an input receives from now on, or reset it (see `resolve.check_effect`)."""
        slot = self.plan.inputs[name].slot
        effects = self._by_slot[slot].effects
        if value is None:
            effects.pop(slot, None)
        else:
            effects[slot] = ("override" if action == "override" else "bias", value)

    def recorded(self) -> Table:
        """The rows so far, a column for each of the plan's; unless the last step broke off, one more for now.

        In that one the inputs and the discrete outputs are those of the last step.
        """
        return self._store.table(self.memory[None, self._columns] if self.whole else None)
