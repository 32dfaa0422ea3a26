"""The calls of a unit as straight-line code: `machine.calling` without loops over rows.

Each function is the one of that name there, for a row that is known: in the same order, with the same
comparisons and the same arithmetic.
"""

from __future__ import annotations

import ctypes

from ...fmi.types import BOOLEAN, BUFFERS, REAL, FmiType
from ...machine import tables as L
from .llvm_text import DOUBLE, INT, WORD, Function, number
from .straight_values import Memory
from .structure import CCall, Move, Stepping


class Calls:
    """Writes calls. `bases` are the names of the tables' addresses, `at` is the operation under way."""

    def __init__(self, f: Function, bases: dict[int, str], memory: Memory) -> None:
        self._f, self._bases, self._memory = f, bases, memory

    def stop(self, at: int, code: int, detail: str | int | None = None, row: int | None = None) -> None:
        """End the function at operation `at` with an error: of a row of CALLS, unless that is None."""
        f, state = self._f, self._bases[L.STATE]
        f.store(WORD, at, state, L.AT)
        if row is not None:
            f.store(WORD, row, state, L.CALLED)
        if detail is not None:
            f.store(WORD, detail, state, L.DETAIL)
        f.give(code)

    def call(self, at: int, call: CCall) -> None:
        """Do a C call, with its values converted before or after it."""
        f, base = self._f, self._bases[L.CALLS]
        first = L.CALL_WIDTH * call.row
        if L.IN_PLACE < call.format < L.GETS:
            self._fill(at, call)
        function, *given = (
            f.load(WORD, base, first + column, fixed=True)
            for column in (L.FUNCTION, L.COMPONENT, L.REFERENCES, L.VALUES)
        )
        arguments: list[tuple[str, str | int]] = [(WORD, value) for value in given]
        arguments.insert(2, (WORD, call.count))
        if call.twice:
            arguments.append((WORD, call.count))
        status = f.call(INT, function, arguments)
        self._judge(at, status, base, first, row=call.row)
        if call.format > L.GETS:
            self._take(call)

    def _judge(self, at: int, status: str, base: str, first: int, row: int | None) -> None:
        """Stop after a status that is neither OK nor Warning, and count the latter."""
        f, state = self._f, self._bases[L.STATE]
        with f.seldom(f.let(f"icmp ne {INT} {status}, 0")) as behind:
            warned, wrong = f.label(), f.label()
            f.split(f.let(f"icmp eq {INT} {status}, 1"), warned, wrong)
            f.place(wrong)
            self.stop(at, L.BAD_STATUS, f.let(f"sext {INT} {status} to {WORD}"), row)
            f.place(warned)
            count = f.load(WORD, base, first + L.WARNINGS)
            f.store(WORD, f.let(f"add {WORD} {count}, 1"), base, first + L.WARNINGS)
            f.store(WORD, 1, state, L.NOTED)
            f.do(f"br label %{behind}")

    # ---- values of other types than double, or mapped

    def _fill(self, at: int, call: CCall) -> None:
        f, items, kind = self._f, self._bases[L.ITEMS], BUFFERS[call.format]
        buffer = f.load(WORD, self._bases[L.CALLS], L.CALL_WIDTH * call.row + L.VALUES, fixed=True)
        for j, item in enumerate(call.items):
            value = self._memory.get(item.source)
            value = self._mapped(item, value)
            low, high = (
                f.load(DOUBLE, items, L.ITEM * item.row + column, fixed=True) for column in (L.LOW, L.HIGH)
            )
            good = _both(f, f"fcmp ole double {low}, {value}", f"fcmp ole double {value}, {high}")
            if kind.kind is not REAL:
                floor = f.known(DOUBLE, "llvm.floor.f64", [(DOUBLE, value)])
                good = f.let(f"and i1 {good}, {f.let(f'fcmp oeq double {value}, {floor}')}")
            with f.seldom(f.let(f"xor i1 {good}, true")):
                self.stop(at, L.NO_FIT, j, call.row)
            size = ctypes.sizeof(kind.c_type)
            place = f.let(f"add {WORD} {buffer}, {j * size}")
            f.store(_in_memory(kind), _from_double(f, kind, value), place, 0, align=size)

    def _take(self, call: CCall) -> None:
        f, kind = self._f, BUFFERS[call.format - L.GETS]
        buffer = f.load(WORD, self._bases[L.CALLS], L.CALL_WIDTH * call.row + L.VALUES, fixed=True)
        size = ctypes.sizeof(kind.c_type)
        for j, item in enumerate(call.items):
            place = f.let(f"add {WORD} {buffer}, {j * size}")
            value = _to_double(f, kind, f.load(_in_memory(kind), place, 0, align=size))
            self._memory.put(item.sink, self._mapped(item, value))

    def _mapped(self, item: Move, value: str) -> str:
        return self._memory.mapped(value, item, self._bases[L.ITEMS], L.ITEM, (L.FACTOR, L.ADDEND))

    # ---- steps

    def steps(self, at: int, unit: Stepping, k: str, now: str, time: str) -> None:
        """Do the FMU steps of the turn at step k; `time` is t_k, `now` its numerator."""
        f, first = self._f, L.UNIT * unit.row
        last = f.let(f"icmp eq {WORD} {k}, {self._of_unit(unit, L.LAST_TURN, WORD)}")
        landing = self._chosen(unit, last, L.LANDING_SIZE, L.STEP_SIZE)
        if unit.count == 1:
            self._step(at, unit, time, landing)
            return
        begin = f.let(f"fmul double {now}, {self._of_unit(unit, L.TIME_FACTOR)}")
        divisor = self._of_unit(unit, L.DIVISOR)
        advance = self._chosen(unit, last, L.LAST_ADVANCE, L.ADVANCE)
        size = self._chosen(unit, last, L.LAST_SIZE, L.STEP_SIZE)
        before, loop, after = f.block, f.label(), f.label()
        f.place(loop)
        j = f.let(f"phi {WORD} [ 0, %{before} ], [ %next{first}, %turn{first} ]")
        passed = f.let(f"fmul double {f.let(f'sitofp {WORD} {j} to double')}, {advance}")
        later = f.let(f"fdiv double {f.let(f'fadd double {begin}, {passed}')}, {divisor}")
        moment = f.let(f"select i1 {f.let(f'icmp eq {WORD} {j}, 0')}, double {time}, double {later}")
        is_last = f.let(f"icmp eq {WORD} {j}, {unit.count - 1}")
        length = f.let(f"select i1 {is_last}, double {landing}, double {size}")
        self._step(at, unit, moment, length)
        f.place(f"turn{first}")
        f.do(f"%next{first} = add {WORD} {j}, 1")
        f.split(is_last, after, loop)
        f.place(after)

    def _chosen(self, unit: Stepping, last: str, then: int, other: int) -> str:
        values = [self._of_unit(unit, column) for column in (then, other)]
        return self._f.let(f"select i1 {last}, double {values[0]}, double {values[1]}")

    def _of_unit(self, unit: Stepping, column: int, kind: str = DOUBLE) -> str:
        return self._f.load(kind, self._bases[L.UNITS], L.UNIT * unit.row + column, fixed=True)

    def _step(self, at: int, unit: Stepping, time: str, size: str) -> None:
        """Do one FMU step."""
        f = self._f
        arguments: list[tuple[str, str | int]] = [
            (WORD, self._of_unit(unit, L.COMPONENT, WORD)), (DOUBLE, time), (DOUBLE, size), (INT, 1),
        ]  # fmt: skip # as C has it
        answers = [
            self._of_unit(unit, column, WORD)
            for column in (L.EVENT, L.ENDING, L.EARLY, L.REACHED) if unit.answers
        ]  # fmt: skip # one sentence
        arguments += [(WORD, answer) for answer in answers]
        status = f.call(INT, self._of_unit(unit, L.FUNCTION, WORD), arguments)
        self._judge(at, status, self._bases[L.UNITS], L.UNIT * unit.row, row=None)
        if answers:
            asked = [f.load("i8", answer, 0, align=1) for answer in answers[1:3]]
            either = f.let(f"or i8 {asked[0]}, {asked[1]}")
            with f.seldom(f.let(f"icmp ne i8 {either}, 0")):
                self.stop(at, L.BAD_END)


def _both(f: Function, first: str, second: str) -> str:
    return f.let(f"and i1 {f.let(first)}, {f.let(second)}")


# ---- values of FMI types, as in `machine.access`


def _in_memory(kind: FmiType) -> str:
    if kind.kind is REAL:
        return DOUBLE if ctypes.sizeof(kind.c_type) == 8 else "float"
    return f"i{8 * ctypes.sizeof(kind.c_type)}"


def _from_double(f: Function, kind: FmiType, value: str) -> str:
    target = _in_memory(kind)
    if kind.kind is BOOLEAN:
        true = f.let(f"fcmp une double {value}, {number(0.0)}")
        return f.let(f"zext i1 {true} to {target}")
    if kind.kind is REAL:
        return value if target == DOUBLE else f.let(f"fptrunc double {value} to float")
    return f.let(f"{'fptosi' if kind.low < 0 else 'fptoui'} double {value} to {target}")


def _to_double(f: Function, kind: FmiType, value: str) -> str:
    source = _in_memory(kind)
    if kind.kind is BOOLEAN:
        true = f.let(f"icmp ne {source} {value}, 0")
        return f.let(f"uitofp i1 {true} to double")
    if kind.kind is REAL:
        return value if source == DOUBLE else f.let(f"fpext float {value} to double")
    return f.let(f"{'sitofp' if kind.low < 0 else 'uitofp'} {source} {value} to double")
