"""The base of both engines: units and messages in the schedule, chunks of steps, events, recorded rows.

`python_engine` does the steps in Python, `compiled` in machine code. Both follow `schedule` and give the same
results, bit for bit.
"""

from __future__ import annotations

import contextlib
import functools
import sys
import time
from collections.abc import Callable, Mapping
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from ...cosim.errors import RunError
from ...cosim.interface import Value
from ...cosim.plan.plan import Plan
from ...cosim.row_store import RowStore, Table
from ...cosim.system.scenario import Bias, Event, Override, Reset, Set
from ..unit import Unit, floats
from .ending import EndedWithin, Ending
from .frame_path import frames_of
from .initialization import typed
from .profile import Profile
from .routes import Act
from .schedule import Action, schedule, waiting
from .sender import senders_of
from .text_notes import TextNotes
from .turn import Effect, Turn

CHUNK_SECONDS = 0.1
"""The time [s] after which a chunk of steps ends; progress and Ctrl-C are looked at between two chunks."""
_LEAST, _FIRST = 256, 16384  # the longest chunk has at least so many steps; the first one at most
_ROOM = 2**22  # bytes that a chunk's rows and stimuli may take


class Engine:
    """A plan with its units, and the steps done so far; a subclass does the steps of a chunk in `_run`.

    `k` counts the steps done, `memory` has shape (size,), `chunks` counts the chunks begun, `before` is the
    number of rows before the last one, and `whole` is False within one and from an error on. `store` has the
    recorded rows, those of a long run in a file, `text_notes` their texts.
    """

    name: str
    notice = ""
    """A sentence about a defect of the engine itself; "": it has none."""
    profile: Profile | None = None
    """The seconds of each part, if it is set before the start; None: not measured."""

    def __init__(self, plan: Plan, units: Mapping[str, Unit], log_raw: bool = False) -> None:
        self.plan = plan
        self._units = dict(units)
        self.k, self.whole = 0, True
        self.schedule = schedule(plan)
        self.late, size = waiting(plan)
        self.memory: NDArray[np.float64] = np.zeros(size)
        self.view = floats(self.memory)
        self.columns = np.array(plan.column_slots, dtype=np.intp)
        self.store = RowStore(len(self.columns))
        self.text_notes = TextNotes(plan, self.view)
        self.chunks = self.before = 0
        self._under_way: tuple[int, NDArray[np.float64]] | None = None  # its first step, and its rows
        self._most = max(_LEAST, _ROOM // (8 * (len(self.columns) + len(plan.drives) + 1)))
        self._chunk = min(_FIRST, self._most)
        for unit_plan in plan.units:
            units[unit_plan.name].bind(self.memory, unit_plan)
        self.ending = Ending()
        self.turns = [Turn(units[p.name], p, self.view, plan.clock, self.ending) for p in plan.units]
        self.senders = senders_of(plan, self.view, self.late, log_raw)
        self.frames = frames_of(plan, self.senders, self.memory, log_raw)
        self._events = list(plan.events)
        self._followed: dict[str, Effect] = {}  # the courses of inputs that no step sets
        self._turn_of_input = {
            group.slot + i: turn
            for turn in self.turns
            for group in turn.plan.groups
            if group.kind == "input"
            for i in range(len(group.variables))
        }

    @property
    def time(self) -> float:
        """The current communication point t_k [s]."""
        return self.time_at(self.k)

    def time_at(self, k: int) -> float:
        """Return t_k [s]."""
        return self.plan.clock.at(k)

    def start(self) -> None:
        """Read all outputs at the start time; the units have left initialization mode.

        Raises RunError for an output that is NaN or infinite.
        """
        for slot, value in self.plan.initial.items():
            self.memory[slot] = value
        for turn in self.turns:
            turn.unit.get_outputs()
            turn.publish(0)
            turn.check_finite()

    # ---- stepping

    def advance(self, steps: int, progress: Callable[[int], None] | None = None) -> None:
        """Do `steps` steps in chunks, calling `progress` with k after each; fewer if a unit ends it.

        The rows recorded before an error or Ctrl-C are kept. Raises RunError naming unit, time and reason.
        """
        end = self.k + steps
        while self.k < min(end, self.ending.step):
            self._apply_events()
            left = min(end, self.ending.step) - self.k
            self._advance_chunk(min(self._chunk, left, self._steps_to_event()))
            if progress is not None:
                progress(self.k)

    def _advance_chunk(self, count: int) -> None:
        """Do at most `count` steps and keep their rows, also those before an error."""
        first, begin = self.k, time.perf_counter()
        drives = self._finite(self._stimuli(count))
        count = drives.shape[1]
        rows = np.empty((count, len(self.columns)))
        # in this order: another thread that sees the chunk must not take the rows of the last one for its own
        self._under_way, self.before = None, len(self.store)
        self.whole = False
        self.chunks += 1
        try:
            with contextlib.suppress(EndedWithin):
                self._run(count, drives, rows)
            self._finish_begun()
            self.whole = True
        except RunError as error:
            raise type(error)(f"at t = {self.time:.6g} s (step {self.k}): {error}") from error
        finally:
            done = self.k - first
            self._keep(rows if done == count else rows[:done].copy())
        self._adapt(count, done, time.perf_counter() - begin)

    def _keep(self, rows: NDArray[np.float64]) -> None:
        """Keep rows and frames. Raises RunError where no disk takes them, unless the step itself failed."""
        try:
            self.store.append(rows)
            for sender in self.senders:
                sender.channel.flush()
            self.frames.flush()
        except RunError as error:
            if self.whole:
                stop = f" of {self.plan.clock.stop:.6g}" if self.plan.clock.told else ""
                raise RunError(f"the run was stopped at t = {self.time:.6g}{stop} s: {error}") from error

    def _finish_begun(self) -> None:
        """Wait for the units that had begun a step when another one ended within it."""
        if self.ending.step == self.k:
            for turn in self.turns:
                turn.unit.finish_step()

    def _stimuli(self, count: int) -> NDArray[np.float64]:
        """Return the stimuli at the next `count` communication points, shape (drives, count)."""
        if not self.plan.drives:
            return np.empty((0, count))
        times = self.plan.clock.times(self.k, self.k + count)
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused
            return np.array([drive.at(times) for drive in self.plan.drives])

    def _finite(self, drives: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the stimuli, shape (drives, n), up to the first step at which one is not finite.

        Raises RunError where that is the next one.
        """
        good = np.isfinite(drives).all(axis=0)
        if good.all():
            return drives
        steps = int(np.argmin(good))
        if steps == 0:
            number = int(np.argmin(np.isfinite(drives[:, 0])))
            raise RunError(
                f"at t = {self.time:.6g} s (step {self.k}): the stimulus of "
                f"{self.plan.drives[number].variable} is {drives[number, 0]}: it must be finite"
            )
        return drives[:, :steps]

    def _adapt(self, count: int, done: int, seconds: float) -> None:
        """Set the steps of the next chunk: as many as this one's time allowed, more if it left time."""
        if done < count:
            self._chunk = max(64, 2 * done)
        elif count == self._chunk and seconds < CHUNK_SECONDS / 8:
            self._chunk = min(8 * count, self._most)

    def _run(self, count: int, drives: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        """Do `count` steps, or as many as CHUNK_SECONDS allow but at least one; `k` counts those done.

        `drives` has the values of the stimuli, shape (drives, count); `rows`, shape (count, columns),
        receives those of the recorded slots. No event is due within.
        """
        raise NotImplementedError

    def rows_under_way(self) -> NDArray[np.float64]:
        """Return a copy of the rows that the last chunk has done, shape (rows, columns).

        For another thread, while a step takes long.
        """
        raise NotImplementedError

    def is_apart(self, action: Action) -> bool:
        """Return True for an action of a unit in a process of its own."""
        of_unit = action.kind in ("take", "begin", "end", "publish")
        return of_unit and self.turns[action.index].unit.apart

    def act(self, action: Action) -> Act:
        """Return the function that does an action of a message or a unit."""
        if action.kind == "note":
            return self.text_notes.note
        if (framed := self.frames.operation(action)) is not None:
            return functools.partial(self.frames.act, *framed)
        if action.kind in ("send", "deliver"):
            sender = self.senders[action.index]
            return sender.send if action.kind == "send" else sender.deliver
        turn = self.turns[action.index]
        return {"take": turn.take, "begin": turn.begin, "end": turn.end, "publish": turn.publish}[action.kind]

    # ---- events and results

    def _apply_events(self) -> None:
        """Apply the events that are due."""
        while self._events and self._events[0][0] <= self.k:
            _, event = self._events.pop(0)
            self.effect(event)
        for name, effect in self._followed.items():
            if effect.changes(self.k):
                self._show(name)

    def _steps_to_event(self) -> int:
        """Return the number of steps before the next event, or change of an input that no step sets."""
        changes = [effect.steps_to_change(self.k) for effect in self._followed.values()]
        event = self._events[0][0] - self.k if self._events else None
        return min((steps for steps in (*changes, event) if steps is not None), default=sys.maxsize)

    def follow(self, name: str, course: NDArray[np.float64]) -> None:
        """Let an input receive one value after the other, shape (n,), in each step from now on.

        The last one stays. One that no step sets is set where the value changes.
        """
        self._affect(name, Effect("follow", course=course, first=self.k))

    def effect(self, event: Event) -> None:
        """Let an event act from now on, whatever its time; `plan.events.check_event` has accepted it."""
        match event:
            case Override():
                self._affect(event.variable, Effect("replace", float(event.value)))
            case Bias():
                self._affect(event.variable, Effect("add", event.value))
            case Reset():
                self._affect(event.variable, None)
            case Set():
                self._set(event)
            case _:
                assert_never(event)

    def _affect(self, name: str, effect: Effect | None) -> None:
        slot = self.plan.inputs[name].slot
        effects = self._turn_of_input[slot].effects
        if effect is None:
            effects.pop(slot, None)
        else:
            effects[slot] = effect
        self._followed.pop(name, None)
        if effect is not None and effect.kind == "follow" and self._set_by_no_step(name):
            self._followed[name] = effect
        self._show(name)

    def _set_by_no_step(self, name: str) -> bool:
        received = self.plan.inputs[name]
        of_unit = name.partition(".")[2]
        return of_unit in self._turn_of_input[received.slot].plan.free and received.mailbox is not None

    def _set(self, event: Set) -> None:
        """Set an input that nothing drives, or a tunable parameter."""
        received = self.plan.inputs.get(event.variable)
        if received is not None and received.mailbox is not None:
            self.memory[received.mailbox] = event.value
            self._show(event.variable)
        else:
            self._set_now(event.variable, event.value)

    def _show(self, name: str) -> None:
        """Set an input to what its unit receives from now on, if no step does."""
        received = self.plan.inputs[name]
        turn = self._turn_of_input[received.slot]
        of_unit = name.partition(".")[2]
        if received.mailbox is not None and self._set_by_no_step(name):
            value = turn.affected(received.slot, float(self.memory[received.mailbox]), self.k)
            self._set_now(name, typed(turn.plan.interface.variables[of_unit], value, self.plan.texts))

    def _set_now(self, name: str, value: Value) -> None:
        """Set a variable between two steps. Raises RunError if the unit refuses: the run is over."""
        unit, _, variable = name.partition(".")
        self.whole = False
        try:
            self._units[unit].set(variable, value)
        except RunError as error:
            raise type(error)(f"at t = {self.time:.6g} s (step {self.k}): {error}") from error
        self.whole = True

    def recorded(self) -> Table:
        """Return the rows so far, shape (k, columns), and unless the last step failed one more for now.

        In that one the inputs and the sampled outputs are those of the last step.
        """
        return self.store.table(self.memory[None, self.columns] if self.whole else None)
