"""The loop over the steps for one structure, as a function in LLVM's language: `kernel.run` without a table.

Each operation of the program is written out, in order, where the kernel looks up in OPS what is next. What
seldom happens (an override, a value out of range, a turn in another process) is left to the kernel's own
function for one operation, so that it is written once. On an error the function returns the code and leaves
operation and row as the kernel does.
"""

from __future__ import annotations

from ...machine import tables as L
from .llvm_text import DOUBLE, INT, WORD, Function, number
from .straight_calls import Calls
from .straight_frames import FramePath, is_written_out
from .straight_numbers import Arithmetic, Number, UnknownForm
from .straight_values import Memory
from .structure import ALWAYS, Sent, Step, Structure

ENTRY = "evcosim_entry"
LOOK = 32  # steps at most between two readings of the clock, as in the kernel
_OF_CHUNK = (L.OPS, L.ROWS_OF_RUN, L.DRIVES)
_OF_RUN = (L.STATE, L.NUMBERS, L.MEMORY, L.ROUTES, L.CALLS, L.ITEMS, L.UNITS, L.SIGNALS, L.SINKS, L.TICKS)


def straight_code(structure: Structure, opaque: bool) -> str:
    """Return a module whose function ENTRY takes the address of the tables and does a chunk of steps.

    `opaque`: pointers have no types in this version of LLVM.
    """
    return _Loop(structure, Function(ENTRY, ["t"], opaque)).text()


class _Loop:
    """Writes the function: the loop, and in it the operations."""

    def __init__(self, structure: Structure, f: Function) -> None:
        self._structure, self._f = structure, f
        self._bases = {table: f.load(WORD, "%t", table) for table in (*_OF_CHUNK, *_OF_RUN)}
        self._memory = Memory(f, self._bases[L.MEMORY])
        self._calls = Calls(f, self._bases, self._memory)

    def text(self) -> str:
        """Return the module."""
        f, state = self._f, self._bases[L.STATE]
        # what does not change within a chunk
        wanted = f.load(WORD, state, L.WANTED)
        begin_step = f.load(WORD, state, L.START_STEP)
        limit = self._number(L.SECONDS)
        begin = self._clock()
        head, look_block, body, end = (f.label() for _ in range(4))
        f.do(f"br label %{head}")
        # the clock, at most every LOOK steps: a chunk ends when its time is over
        f.place(head)
        s = f.let(f"phi {WORD} [ 0, %entry ], [ %next, %latch ]")
        looks = [("look", WORD, "1"), ("interval", WORD, "1"), ("last", DOUBLE, begin)]
        phis = [f.let(f"phi {kind} [ {first}, %entry ], [ %{name}, %latch ]") for name, kind, first in looks]
        f.split(f.let(f"icmp eq {WORD} {s}, {phis[0]}"), look_block, body, seldom=True)
        f.place(look_block)
        new, looked = self._look(s, begin, limit, phis, end)
        f.place(body)
        for (name, kind, _), before, after in zip(looks, phis, new, strict=True):
            f.do(f"%{name} = phi {kind} [ {before}, %{head} ], [ {after}, %{looked} ]")
        # the communication point t_k and its numerator, from its count
        k = f.let(f"add {WORD} {begin_step}, {s}")
        now, time = self._times(k)
        self._operations(s, k, now, time)
        # the step is done: an error in a later one leaves its row
        f.place("latch")
        f.do(f"%next = add {WORD} {s}, 1")
        f.store(WORD, "%next", state, L.STEPS_DONE)
        f.split(f.let(f"icmp slt {WORD} %next, {wanted}"), head, end)
        f.place(end)
        f.give(L.DONE)
        return f.text()

    # ---- time

    def _number(self, place: int) -> str:
        return self._f.load(DOUBLE, self._bases[L.NUMBERS], place, fixed=True)

    def _clock(self) -> str:
        """Return the reading of the clock [s]."""
        f, state, ticks = self._f, self._bases[L.STATE], self._bases[L.TICKS]
        given = [(WORD, f.load(WORD, state, place)) for place in (L.CLOCK_A, L.CLOCK_B)]
        f.call(INT, f.load(WORD, state, L.CLOCK), given)
        parts = [
            f.let(f"fmul double {f.let(f'sitofp i64 {f.load(WORD, ticks, i)} to double')}, {self._number(n)}")
            for i, n in enumerate((L.TICK_0, L.TICK_1))
        ]
        return f.let(f"fadd double {parts[0]}, {parts[1]}")

    def _look(
        self, s: str, begin: str, limit: str, before: list[str], end: str
    ) -> tuple[tuple[str, str, str], str]:
        """Look at the clock; return step and interval of the next look, the time of this, and the block."""
        f = self._f
        _, interval, last = before
        now = self._clock()
        over = f.let(f"fcmp ogt double {f.let(f'fsub double {now}, {begin}')}, {limit}")
        going = f.label()
        f.split(over, end, going, seldom=True)
        f.place(going)
        soon = f.let(f"fcmp olt double {f.let(f'fsub double {now}, {last}')}, {number(0.001)}")
        twice = f.let(f"shl {WORD} {interval}, 1")
        longer = f.let(f"select i1 {f.let(f'icmp slt i64 {twice}, {LOOK}')}, {WORD} {twice}, {WORD} {LOOK}")
        half = f.let(f"ashr {WORD} {interval}, 1")
        shorter = f.let(f"select i1 {f.let(f'icmp sgt i64 {half}, 1')}, {WORD} {half}, {WORD} 1")
        chosen = f.let(f"select i1 {soon}, {WORD} {longer}, {WORD} {shorter}")
        return (f.let(f"add {WORD} {s}, {chosen}"), chosen, now), going

    def _times(self, k: str) -> tuple[str, str]:
        """Return the numerator of t_k, and t_k."""
        f = self._f
        passed = f.let(f"fmul double {f.let(f'sitofp i64 {k} to double')}, {self._number(L.CLOCK_ADVANCE)}")
        regular = f.let(f"fadd double {self._number(L.CLOCK_FIRST)}, {passed}")
        stop = f.load(WORD, self._bases[L.STATE], L.STOP_STEP, fixed=True)
        at_stop = f.let(f"icmp eq {WORD} {k}, {stop}")
        now = f.let(f"select i1 {at_stop}, double {self._number(L.CLOCK_STOP)}, double {regular}")
        return now, f.let(f"fdiv double {now}, {self._number(L.CLOCK_DIVISOR)}")

    # ---- operations

    def _operations(self, s: str, k: str, now: str, time: str) -> None:
        """Do those of a step; those that are due together are looked up once."""
        f, ops = self._f, self._bases[L.OPS]
        group, behind = ALWAYS, ""
        for at, step in enumerate(self._structure.steps):
            if step.group != group:
                if behind:
                    f.place(behind)
                    behind = ""
                if step.group != ALWAYS:
                    row = L.OPERATION * at
                    due, every = (f.load(WORD, ops, row + column) for column in (L.DUE, L.EVERY))
                    is_due, behind = f.label(), f.label()
                    f.split(f.let(f"icmp eq {WORD} {k}, {due}"), is_due, behind)
                    f.place(is_due)
                    f.store(WORD, f.let(f"add {WORD} {k}, {every}"), ops, row + L.DUE)
                group = step.group
            self._operation(at, step, s, k, now, time)
        if behind:
            f.place(behind)

    def _operation(self, at: int, step: Step, s: str, k: str, now: str, time: str) -> None:
        f, memory, bases = self._f, self._memory, self._bases
        kind, a, b, c = step.kind, step.a, step.b, step.c
        if kind == L.TAKE:
            for move in step.moves:
                value = memory.mapped(memory.get(move.source), move, bases[L.ROUTES], L.ROUTE)
                memory.put(move.sink, value)
        elif kind in (L.CALL, L.STEP) and not _needs_kernel(step):
            self._note(at)
            for call in step.calls:
                self._calls.call(at, call)
            if step.stepping is not None:
                self._calls.steps(at, step.stepping, k, now, time)
            elif c:
                self._check(at, b, c)
        elif kind == L.CHECK:
            self._check(at, b, c)
        elif kind == L.COPY and (a + c <= b or b + c <= a):
            memory.copy(range(a, a + c), bases[L.MEMORY], b)
        elif kind == L.SEND and c < 0:
            self._send(at, step.sent, s, k)
        elif kind == L.RECORD:
            row = f.let(f"mul {WORD} {s}, {8 * b}")
            memory.copy(self._structure.columns, f.let(f"add {WORD} {bases[L.ROWS_OF_RUN]}, {row}"))
        elif kind == L.DRIVE:
            room = f.load(WORD, bases[L.STATE], L.ROOM)
            place = f.let(f"add {WORD} {f.let(f'mul {WORD} {room}, {b}')}, {s}")
            memory.put(a, f.load(DOUBLE, bases[L.DRIVES], place))
        elif kind == L.EFFECT:
            count = f.load(WORD, bases[L.OPS], L.OPERATION * at + L.B)
            with f.seldom(f.let(f"icmp ne {WORD} {count}, 0")):
                self._by_kernel(at, s, k)
        elif kind == L.WIRE_ACT:
            self._frame(at, a, b, k)
        elif kind == L.PYTHON_ACT:
            self._act(at, INT, f.load(WORD, bases[L.STATE], L.PYTHON, fixed=True), [(WORD, c), (WORD, k)])
        else:
            self._by_kernel(at, s, k)

    def _note(self, at: int) -> None:
        """Note the operation, for the report of a crash within it."""
        self._f.store(WORD, at, self._bases[L.STATE], L.AT)

    def _check(self, at: int, first: int, count: int) -> None:
        if count:
            good = self._memory.are_finite(first, count)
            with self._f.seldom(self._f.let(f"xor i1 {good}, true")):
                self._calls.stop(at, L.NOT_FINITE)

    def _act(self, at: int, answer: str, address: str, given: list[tuple[str, str | int]]) -> None:
        """Call a function that has raised an error if it does not return 0."""
        f = self._f
        self._note(at)
        result = f.call(answer, address, given)
        with f.seldom(f.let(f"icmp ne {answer} {result}, 0")):
            f.give(L.RAISED)

    def _frame(self, at: int, what: int, i: int, k: str) -> None:
        """Do an action of the frame path: written out if it can be, else by its own function."""
        f, wire = self._f, self._f.load(WORD, "%t", L.WIRE, fixed=True)
        frames = self._structure.frames
        if frames is not None and is_written_out(frames, what, i):
            self._note(at)
            before = f.mark()
            numbers = Arithmetic(f)
            try:
                result = FramePath(numbers, frames, wire).act(what, i, k)
            except UnknownForm:
                f.undo(before)
            else:
                if isinstance(result, Number) or result:
                    wrong = f.let(f"icmp ne {WORD} {numbers.text(result, WORD)}, {L.DONE}")
                    with f.seldom(wrong):
                        f.give(L.RAISED)
                return
        code = f.load(WORD, self._bases[L.STATE], L.WIRE_CODE, fixed=True)
        self._act(at, INT, code, [(WORD, wire), (WORD, what), (WORD, i), (WORD, k)])

    def _by_kernel(self, at: int, s: str, k: str) -> None:
        """Let the kernel's function for one operation do it."""
        f, state = self._f, self._bases[L.STATE]
        self._note(at)
        op = f.let(f"add {WORD} {self._bases[L.OPS]}, {8 * L.OPERATION * at}")
        function = f.load(WORD, state, L.OPERATE, fixed=True)
        result = f.call(WORD, function, [(WORD, "%t"), (WORD, op), (WORD, s), (WORD, k)])
        with f.seldom(f.let(f"icmp ne {WORD} {result}, {L.DONE}")):
            f.give(result)

    # ---- the channel

    def _send(self, at: int, signals: tuple[Sent, ...], s: str, k: str) -> None:
        """Sample the signals, then write what is received; the kernel does it where one is out of range."""
        f, table = self._f, self._bases[L.SIGNALS]
        values, good = [], "true"
        for signal in signals:
            first = L.SIGNAL * signal.row
            x = self._memory.get(signal.source)
            if not signal.plain_in:
                x = self._memory.affine(x, table, first, (L.IN_SCALE, L.IN_ADD))
            values.append(x)
            least, greatest = (
                f.load(DOUBLE, table, first + column, fixed=True) for column in (L.LEAST, L.GREATEST)
            )
            above = f.let(f"fcmp ole double {least}, {x}")
            below = f.let(f"fcmp ole double {x}, {greatest}")
            good = f.let(f"and i1 {good}, {f.let(f'and i1 {above}, {below}')}")
        others, within, behind = (f.label() for _ in range(3))
        f.split(f.let(f"xor i1 {good}, true"), others, within, seldom=True)
        f.place(others)
        self._by_kernel(at, s, k)
        f.do(f"br label %{behind}")
        f.place(within)
        raws = [self._raw(signal, x) for signal, x in zip(signals, values, strict=True)]
        for signal, raw in zip(signals, raws, strict=True):
            self._receive(signal, raw)
        f.place(behind)

    def _raw(self, signal: Sent, x: str) -> str:
        if not signal.sinks:
            return x  # nobody receives it
        f, first = self._f, L.SIGNAL * signal.row
        no_offset, whole = signal.plain_raw
        for plain, instruction, column in ((no_offset, "fsub", L.OFFSET), (whole, "fdiv", L.RESOLUTION)):
            if not plain:
                operand = f.load(DOUBLE, self._bases[L.SIGNALS], first + column, fixed=True)
                x = f.let(f"{instruction} double {x}, {operand}")
        return self._memory.rounded(x, signal.mode)

    def _receive(self, signal: Sent, value: str) -> None:
        if not signal.sinks:
            return
        f, table, first = self._f, self._bases[L.SIGNALS], L.SIGNAL * signal.row
        if not signal.plain_raw[1]:
            scale = f.load(DOUBLE, table, first + L.RESOLUTION, fixed=True)
            value = f.let(f"fmul double {value}, {scale}")
        if not signal.plain_out:
            add = f.load(DOUBLE, table, first + L.OUT_ADD, fixed=True)
            value = f.let(f"fadd double {value}, {add}")
        for move in signal.sinks:
            found = self._memory.mapped(value, move, self._bases[L.SINKS], L.ROUTE)
            self._memory.put(move.sink, found)


def _needs_kernel(step: Step) -> bool:
    """Return True for calls whose values are looked up one by one: lists of numbers, numbers beyond 2**53."""
    return any(call.listed or call.is_wide for call in step.calls)
