"""The values of a turn between the run's memory, which holds doubles, and a unit, which has FMI types.

Real values in the order of the memory are given and taken in place. All others pass through a buffer of
their C type: a number that the type does not hold is refused there, since C would make another one of it.
"""

from __future__ import annotations

import ctypes
import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, NoReturn

from ...cosim.interface import VariableInfo

LARGEST_WHOLE = 2**53
"""Beyond it a double does not hold every whole number."""

Call = Callable[[], None]
Refusal = Callable[[int, Any], NoReturn]
"""Raises the error for a value that does not fit: its place in the buffer, and the value."""


class Item(NamedTuple):
    """A variable's place in the buffer, its slot in the memory, and the sign between the two."""

    place: int
    slot: int
    sign: float
    variable: VariableInfo


@dataclasses.dataclass(frozen=True)
class Transfer:
    """A C call that moves values between the memory and a unit: all that an engine needs to make it.

    `pointer` is the C function `function`; `references` and `values` are its arrays, `values` a part of the
    memory itself where there are no `items`.
    """

    function: str
    pointer: Any
    references: Any
    values: Any
    c_type: Any
    gets: bool
    boolean: bool
    items: tuple[Item, ...]


@dataclasses.dataclass(frozen=True)
class StepCall:
    """The C function that does a step; FMI 3.0's is given where to answer `answers`: whether there was an
    event, whether the simulation shall end, whether the step ended early, and the time reached."""

    pointer: Any
    answers: tuple[Any, ...] = ()


@dataclasses.dataclass(frozen=True)
class Copy:
    """`count` slots of the memory are copied."""

    source: int
    target: int
    count: int


def range_of(c_type: Any) -> tuple[float, float]:
    """The least and the largest number of a ctypes type."""
    if c_type is ctypes.c_double:
        return -math.inf, math.inf
    if c_type is ctypes.c_float:
        largest = (2.0 - 2.0**-23) * 2.0**127
        return -largest, largest
    bits = 8 * ctypes.sizeof(c_type)
    signed = c_type(-1).value < 0
    return (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)


def setting(
    call: Call,
    memory: memoryview[float],
    values: Any,
    items: Sequence[Item],
    c_type: Any,
    refuse: Refusal,
) -> Call:
    """Fill the buffer `values` from the memory, then call. A fraction is cut off from what shall be whole."""
    low, high = range_of(c_type)
    kind = float if c_type in (ctypes.c_double, ctypes.c_float) else int

    def set_values() -> None:
        for place, slot, sign, _ in items:
            value = sign * memory[slot]
            if not low <= value <= high:
                refuse(place, value)
            values[place] = kind(value)
        call()

    return set_values


def setting_booleans(call: Call, memory: memoryview[float], values: Any, items: Sequence[Item]) -> Call:
    """The same for Booleans: all but 0 is true."""

    def set_values() -> None:
        for place, slot, *_ in items:
            values[place] = memory[slot] != 0.0
        call()

    return set_values


def getting(
    call: Call, memory: memoryview[float], values: Any, items: Sequence[Item], c_type: Any, refuse: Refusal
) -> Call:
    """Call, then write the buffer into the memory; a 64-bit integer that no double holds is refused."""
    wide = c_type in (ctypes.c_int64, ctypes.c_uint64)

    def get_values() -> None:
        call()
        for place, slot, sign, _ in items:
            memory[slot] = sign * values[place]

    def get_wide_values() -> None:
        call()
        for place, slot, sign, _ in items:
            value = values[place]
            if not -LARGEST_WHOLE <= value <= LARGEST_WHOLE:
                refuse(place, value)
            memory[slot] = sign * value

    return get_wide_values if wide else get_values


def getting_booleans(call: Call, memory: memoryview[float], values: Any, items: Sequence[Item]) -> Call:
    """The same for Booleans: 0.0 or 1.0, whatever number an FMU takes for true."""

    def get_values() -> None:
        call()
        for place, slot, *_ in items:
            memory[slot] = 1.0 if values[place] else 0.0

    return get_values


def copying(memory: memoryview[float], copy: Copy) -> Call:
    """What copies slots."""
    values = memory[copy.source : copy.source + copy.count]
    place = slice(copy.target, copy.target + copy.count)

    def copy_values() -> None:
        memory[place] = values

    return copy_values


def one_after_the_other(*calls: Call) -> Call:
    """One call of several."""
    if len(calls) == 1:
        return calls[0]

    def all_of_them() -> None:
        for call in calls:
            call()

    return all_of_them
