"""The compiled engine: the schedule as tables, a chunk of steps in one call of machine code."""

from __future__ import annotations

import contextlib
import ctypes
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....cosim.can.quantization import ChannelError
from ...fmi import crash
from ...machine import tables as L
from ...machine.hands import HandedOver
from ...machine.rows import KernelTable, collect_warnings
from ...machine.surroundings import Surroundings, address
from ..engine import CHUNK_SECONDS, Engine
from .addresses import wire_table
from .cache import compiled, operation, served, wire
from .placement import Placement
from .program import Program
from .straight import Straight

_Python = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_int64)
_Helper = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)
_RELEASING = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)  # gives up Python's lock while it runs
_HOLDING = ctypes.PYFUNCTYPE(ctypes.c_int64, ctypes.c_int64)


class CompiledEngine(Engine):
    """The engine whose steps are done by a kernel of machine code, a chunk in each call.

    For an action that the kernel has no primitive for it calls back, and Python does the python engine's act.
    """

    name = "compiled"
    _program: Program | None = None
    _straight: Straight | None = None

    def _run(self, count: int, drives: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        program = self._program
        assert program is not None  # it was made at the start
        state, first, addresses = self._state, self.k, self._addresses
        kernel, ops = self._kernel_for(program, first, count)
        state[L.WANTED], state[L.STEPS_DONE], state[L.START_STEP], state[L.ROOM] = count, 0, first, count
        state[L.OPERATIONS], state[L.CALLED] = len(ops), -1
        self._under_way = first, rows
        # the arrays that are the chunk's own
        log, starts = self._log_buffer(count)
        courses = [effect.over(first, count) for effect in program.followed]
        drives = np.vstack((drives, *courses)) if courses else np.ascontiguousarray(drives)
        addresses[L.OPS], addresses[L.DRIVES] = ops.ctypes.data, drives.ctypes.data
        addresses[L.ROWS_OF_RUN], addresses[L.LOG] = rows.ctypes.data, log.ctypes.data
        # the steps, in machine code
        self._raised: BaseException | None = None
        try:
            with self._crash_report(program):
                result = kernel(addresses.ctypes.data)
        finally:  # also when Ctrl-C comes within
            self.k = first + int(state[L.STEPS_DONE])
            self._collect(log, starts)
        if self._raised is not None:
            raise self._raised
        if result != L.DONE:
            if result != L.RAISED:
                self._recheck(program, result)
            self._finish_step(program, rows, first)

    def _kernel_for(
        self, program: Program, first: int, count: int
    ) -> tuple[Callable[[int], int], KernelTable]:
        """Return the function that does the next `count` steps, and its operations."""
        if self._straight is None or not self._straight.address:
            # the operations that are due in this chunk
            ops, self._places = program.chunk(first, count)
            return self._kernel, ops
        program.begin(first)
        self._places = self._all_places
        return self._kind(self._straight.address), program.ops

    def advance(self, steps: int, progress: Callable[[int], None] | None = None) -> None:
        if self._straight is not None:
            self._straight.expect(steps)
        super().advance(steps, progress)

    def rows_under_way(self) -> NDArray[np.float64]:
        if (under_way := self._under_way) is None:
            return np.empty((0, len(self.columns)))
        return under_way[1][: int(self._state[L.STEPS_DONE])].copy()

    def _recheck(self, program: Program, result: int) -> None:
        """Repeat the check at which the kernel stopped with the code `result`, and raise its exception.

        Return for a step whose unit asked to end the simulation.
        """
        called = int(self._state[L.CALLED])
        at = self._places[int(self._state[L.AT])]
        recheck = program.rechecks[at] if called < 0 else program.call_rechecks[called]
        recheck(result, int(self._state[L.DETAIL]))
        if self.turns[self.schedule[program.actions[at]].index].unit.asked_end is None:
            raise AssertionError(f"operation {at} ended with {result}, and nothing is wrong with it")

    def _finish_step(self, program: Program, rows: NDArray[np.float64], first: int) -> None:
        """Do the actions of a step behind the one at which the kernel stopped since a unit asks for the end.

        It was the last operation of its action, and the stimuli, which the kernel has alone, stand before all
        units. `rows` are those of the chunk, which began at step `first`.
        """
        k, at = self.k, program.actions[self._places[int(self._state[L.AT])]]
        for place, action in enumerate(self.schedule[at + 1 :], at + 1):
            act = program.acts[place]
            if action.kind == "record":
                rows[k - first] = self.memory[self.columns]
            elif act is not None and action.due(k):
                act(k)
        self._state[L.STEPS_DONE] += 1
        self.k = k + 1

    @contextlib.contextmanager
    def _crash_report(self, program: Program) -> Iterator[None]:
        """While the kernel runs, the report of a crash, if one is asked for, names the operation's unit."""
        report = crash.report()
        if report is None:
            yield
            return
        texts = np.array([report.row(unit) for unit in program.units_of(self._places)], dtype=np.int64)
        place = self._state[L.AT : L.AT + 1]
        report.follow(texts.ctypes.data, place.ctypes.data)
        try:
            yield
        finally:
            report.rest()

    # ---- made once

    def start(self) -> None:
        """Read all outputs at the start time, then make the tables and load the kernel."""
        super().start()
        program = self._program = Program(self)
        self._python = _Python(self._act_for_kernel)
        self._state = np.zeros(L.STATE_SIZE, dtype=np.int64)
        self._numbers = np.zeros(L.NUMBERS_SIZE)
        self._raws = np.zeros(max(1, len(program.signals)))
        self._logs = np.zeros(max(1, len(program.logged)), dtype=np.int64)
        self._times = np.zeros(len(program.ops))
        clock = self.plan.clock
        self._numbers[[L.CLOCK_FIRST, L.CLOCK_ADVANCE, L.CLOCK_STOP, L.CLOCK_DIVISOR, L.SECONDS]] = (
            clock.first, clock.advance, clock.numerator(clock.steps), clock.divisor, CHUNK_SECONDS,
        )  # fmt: skip # beside their places
        self._state[L.STOP_STEP] = clock.steps
        self._state[L.PYTHON] = address(self._python)
        self._surroundings = Surroundings(self._state, self._numbers)
        tables: dict[int, NDArray[Any]] = {
            L.STATE: self._state, L.NUMBERS: self._numbers, L.MEMORY: self.memory, L.ROUTES: program.routes,
            L.EFFECTS: program.effect_table, L.CALLS: program.calls, L.ITEMS: program.items,
            L.UNITS: program.units, L.SIGNALS: program.signal_table, L.SINKS: program.sinks,
            L.RAWS: self._raws, L.WAITS: program.waits, L.ARRIVALS: program.arrivals,
            L.COLUMNS: program.columns, L.LOGS: self._logs, L.TIMES_OF_OPS: self._times,
            L.HANDS: program.hands, L.SPANS: program.spans,
        }  # fmt: skip # the others are a chunk's own
        self._addresses = np.zeros(L.TABLES, dtype=np.int64)
        notice = self._load_wire()
        for place, array in (tables | self._surroundings.tables).items():
            self._addresses[place] = array.ctypes.data
        self._kind = _HOLDING if program.holds_python else _RELEASING
        function, self.notice = compiled(timed=self.profile is not None)
        self.notice = self.notice or notice
        self._kernel = self._kind(function)
        self._state[L.OPERATE] = operation()
        self._all_places = list(range(len(program.ops)))
        if self.profile is None:
            self._straight = Straight(program)
        self._quicken()

    def _load_wire(self) -> str:
        """Load the frame path, where the run has frames; return a notice, or ""."""
        if not self.frames.senders:
            return ""
        self._helper = _Helper(self._help_wire)
        self._wire_addresses = wire_table(self.frames.arrays, address(self._helper))
        self._addresses[L.WIRE] = self._wire_addresses.ctypes.data
        self._state[L.WIRE_CODE], notice = wire()
        return notice

    def _adapt(self, count: int, done: int, seconds: float) -> None:
        super()._adapt(count, done, seconds)
        self._placement.judge(seconds, done * len(self._placement.units))

    def _quicken(self) -> None:
        """Let the processes of isolated units do their turns in machine code, where it can hand them over."""
        units = [turn.unit for turn in self.turns]
        handed = [unit for unit in units if isinstance(unit, HandedOver) and unit.hand is not None]
        code = served() if handed else None
        self._placement = Placement(handed if code is not None else [])
        if code is not None:
            for unit in handed:
                unit.quicken(code)

    # ---- calls from the kernel, and its outcome

    def _act_for_kernel(self, what: int, k: int) -> int:
        """Do action `what` in step k, or (negative) find the raw value of a value out of range.

        Return 1 to stop the kernel: an error was raised, or a unit asked for the end of the run; else 0.
        """
        assert self._program is not None  # the kernel follows it
        try:
            if what >= 0:
                act = self._program.acts[what]
                assert act is not None  # the kernel drives and records by itself
                end = self.ending.step
                act(k)
                return int(self.ending.step != end)
            self._raw_value(-1 - what, k)
            return 0
        except BaseException as error:  # no exception can pass through the kernel
            self._raised = error
            return 1

    def _help_wire(self, what: int, i: int, k: int) -> int:
        """Do what no table of the frame path holds; return 1 to stop the kernel, else 0."""
        try:
            return self.frames.help(what, i, k)
        except BaseException as error:  # no exception can pass through the kernel
            self._raised = error
            return 1

    def _raw_value(self, row: int, k: int) -> None:
        """Replace VALUE, which is out of range for the signal in a row, by its raw value. Raises RunError."""
        assert self._program is not None  # the kernel follows it
        sender, i = self._program.signals[row]
        try:
            raw = sender.channel.out_of_range(i, float(self._numbers[L.VALUE]), k)
        except ChannelError as error:
            raise sender.failed(error) from error
        self._numbers[L.VALUE] = raw

    def _log_buffer(self, count: int) -> tuple[NDArray[np.float64], list[int]]:
        """Return an array for the frames of `count` steps, and the place at which each message's begin."""
        assert self._program is not None
        starts = [0]
        for sender in self._program.logged:
            sent = count // sender.plan.every + 1
            starts.append(starts[-1] + sent * (1 + len(sender.channel.routes)))
        self._logs[: len(starts) - 1] = starts[:-1]
        return np.empty(max(1, starts[-1])), starts

    def _collect(self, log: NDArray[np.float64], starts: list[int]) -> None:
        """Hand warnings, saturations, times and frames of a chunk to units, channels and profile."""
        program = self._program
        assert program is not None
        if self._state[L.NOTED]:
            self._collect_noted(program)
        if self.profile is not None:
            parts = program.parts()
            for place, seconds in zip(self._places, self._times.tolist(), strict=False):
                self.profile.add(parts[place], seconds)
            self._times[:] = 0.0
        for i, sender in enumerate(program.logged):
            found = log[starts[i] : self._logs[i]].reshape(-1, 1 + len(sender.channel.routes))
            sender.channel.keep(found[:, 0].astype(np.int64), found[:, 1:])

    def _collect_noted(self, program: Program) -> None:
        """Add warnings and saturations to those of units and channels."""
        self._state[L.NOTED] = 0
        collect_warnings(program.calls, program.called)
        collect_warnings(program.units, program.stepped)
        signals = program.signal_table
        for i in np.flatnonzero(signals[:, L.TIMES]).tolist():
            sender, place = program.signals[i]
            sender.channel.count(place, int(signals[i, L.TIMES]), int(signals[i, L.FIRST_TIME]))
        signals[:, [L.TIMES, L.FIRST_TIME]] = 0
