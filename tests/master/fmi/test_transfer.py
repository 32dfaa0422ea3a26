"""Values between the run's memory and a unit: the value that is set is the value that is got."""

from __future__ import annotations

import ctypes
import math
from typing import Any, NoReturn

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.interface import VariableInfo
from evcosim.master.fmi.transfer import Copy, Item, Transfer, copying, fits, moving, one_after_the_other
from evcosim.master.fmi.types import BOOLEAN, ENUMERATION, LARGEST_WHOLE, REAL, STRING, TYPES, FmiType

NUMBERS = [kind for kind in TYPES if kind.kind not in (BOOLEAN, STRING)]
BOOLEANS = [kind for kind in TYPES if kind.kind is BOOLEAN]


def named(kind: FmiType) -> str:
    """A type's name in the name of a test."""
    return f"{kind.name}-{kind.versions}"


class Refused(Exception):
    """A value does not fit: its place in the buffer, and the value."""


def refuse(place: int, value: Any) -> NoReturn:
    raise Refused(place, value)


def transfer(kind: FmiType, values: Any, gets: bool, signs: list[float]) -> Transfer:
    """Of as many values as signs, which stand in the memory in reverse order."""
    n = len(signs)
    items = tuple(Item(i, n - 1 - i, sign, -0.0, VariableInfo(f"v{i}")) for i, sign in enumerate(signs))
    return Transfer("fmi2Get" if gets else "fmi2Set", None, None, values, kind, gets, items)


def through(kind: FmiType, memory: memoryview, signs: list[float]) -> tuple[Any, memoryview]:
    """Set values of the memory and get them back; the buffer between, and the new memory."""
    values = (kind.c_type * len(signs))()
    moving(transfer(kind, values, False, signs), lambda: None, memory, refuse)()
    found = memoryview(bytearray(8 * len(signs))).cast("d")
    moving(transfer(kind, values, True, signs), lambda: None, found, refuse)()
    return values, found


def memory_of(*numbers: float) -> memoryview:
    memory = memoryview(bytearray(8 * len(numbers))).cast("d")
    for i, number in enumerate(numbers):
        memory[i] = number
    return memory


def within(kind: FmiType) -> st.SearchStrategy[float]:
    """Doubles that a type holds as they are."""
    if kind.kind is REAL:
        return st.floats(allow_nan=False, width=32 if ctypes.sizeof(kind.c_type) == 4 else 64)
    low, high = max(int(kind.low), -LARGEST_WHOLE), min(int(kind.high), LARGEST_WHOLE)
    return st.integers(low, high).map(float)


@pytest.mark.parametrize("kind", NUMBERS, ids=named)
@given(data=st.data())
def test_what_is_set_is_what_is_got(kind: FmiType, data: st.DataObject) -> None:
    numbers = data.draw(st.lists(within(kind), min_size=1, max_size=4))
    if kind.kind is REAL and ctypes.sizeof(kind.c_type) == 4:
        numbers = [x for x in numbers if math.isfinite(x)] or [0.5]
    values, found = through(kind, memory_of(*numbers), [1.0] * len(numbers))
    assert list(found) == numbers
    assert list(values) == numbers[::-1]


@pytest.mark.parametrize("kind", NUMBERS, ids=named)
def test_a_negated_alias_has_the_other_sign_on_both_ways(kind: FmiType) -> None:
    sign = -1.0 if kind.low < 0 else 1.0
    values, found = through(kind, memory_of(3.0, 5.0), [sign, 1.0])
    assert list(found) == [3.0, 5.0]
    assert list(values) == [sign * 5.0, 3.0]


@pytest.mark.parametrize("kind", [kind for kind in NUMBERS if kind.kind is not REAL], ids=named)
def test_what_does_not_fit_is_refused_before_the_call(kind: FmiType) -> None:
    calls: list[int] = []
    low, high = kind.doubles
    for wrong in (math.nextafter(low, -math.inf), math.nextafter(high, math.inf), math.nan, math.inf):
        values = (kind.c_type * 2)()
        made = moving(
            transfer(kind, values, False, [1.0, 1.0]), lambda: calls.append(1), memory_of(wrong, 1.0), refuse
        )
        with pytest.raises(Refused) as refusal:
            made()
        assert refusal.value.args[0] == 1 and str(refusal.value.args[1]) == str(wrong)
    assert calls == []


@pytest.mark.parametrize("kind", [kind for kind in NUMBERS if kind.kind is not REAL], ids=named)
def test_a_fraction_is_refused(kind: FmiType) -> None:
    with pytest.raises(Refused, match=r"1, 0\.9"):
        through(kind, memory_of(0.9, 1.0), [1.0, 1.0])


@pytest.mark.parametrize("value", [0.0, 2.0, 3.0])
def test_an_enumeration_has_its_items_and_its_start(value: float) -> None:
    kind = next(t for t in TYPES if t.kind is ENUMERATION)
    variable = VariableInfo("v", "Enumeration", start=3, items=((0, "off"), (2, "on")))
    assert fits(value, kind, variable) and not fits(value + 5.0, kind, variable)
    assert not fits(1.0, kind, variable) and not fits(0.5, kind, variable)


@pytest.mark.parametrize("kind", [kind for kind in NUMBERS if kind.wide], ids=named)
def test_an_integer_that_no_double_holds_is_refused(kind: FmiType) -> None:
    memory = memory_of(0.0)
    for number in (LARGEST_WHOLE, LARGEST_WHOLE + 1):
        values = (kind.c_type * 1)(number)
        made = moving(transfer(kind, values, True, [1.0]), lambda: None, memory, refuse)
        if number == LARGEST_WHOLE:
            made()
            assert memory[0] == 2.0**53
        else:
            with pytest.raises(Refused):
                made()


@pytest.mark.parametrize("kind", BOOLEANS, ids=named)
def test_a_boolean_is_set_to_0_or_1_and_any_number_but_0_is_read_as_true(kind: FmiType) -> None:
    values, found = through(kind, memory_of(0.0, -0.0, 1.0), [1.0] * 3)
    assert list(found) == [0.0, 0.0, 1.0]
    assert [bool(value) for value in values] == [True, False, False]
    for wrong in (2.0, -1.0, 0.3, math.nan):
        with pytest.raises(Refused):
            through(kind, memory_of(wrong), [1.0])
    if kind.c_type is not ctypes.c_bool:
        made = moving(
            transfer(kind, (kind.c_type * 1)(2), True, [1.0]), lambda: None, memory := memory_of(5.0), refuse
        )
        made()
        assert memory[0] == 1.0


def test_values_in_place_need_no_more_than_the_call() -> None:
    kind = TYPES[0]

    def call() -> None:
        """Do nothing."""

    for gets in (True, False):
        assert moving(Transfer("", None, None, None, kind, gets, ()), call, memory_of(1.0), refuse) is call


def test_slots_are_copied_and_calls_made_in_order() -> None:
    memory, done = memory_of(1.0, 2.0, 3.0, 0.0, 0.0, 0.0), []
    calls = [lambda i=i: done.append(i) for i in range(3)]
    assert one_after_the_other(calls[0]) is calls[0]
    one_after_the_other(*calls, copying(memory, Copy(0, 3, 2)))()
    assert done == [0, 1, 2]
    assert list(memory) == [1.0, 2.0, 3.0, 1.0, 2.0, 0.0]
    one_after_the_other()()
