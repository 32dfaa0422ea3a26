"""The values of a turn between the run's memory, which holds doubles, and a unit, which has FMI types.

Doubles that stand in the memory in order are given and taken in place. All others pass through a buffer of
their C type: a number that the type does not hold is refused there, since C would make another one of it, and
so is one that is no item of an enumeration.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple, NoReturn

from ...cosim.interface import VariableInfo
from .types import BOOLEAN, LARGEST_WHOLE, REAL, FmiType

Call = Callable[[], None]
Refusal = Callable[[int, Any], NoReturn]
"""(place in the buffer, value): raises the error for a value that does not fit."""


class Item(NamedTuple):
    """A variable's place in the buffer, its slot in the memory, and the map to where a value goes.

    `offset` is -0.0 where there is none, since adding 0.0 would turn -0.0 into 0.0.
    """

    place: int
    slot: int
    scale: float
    offset: float
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
    type: FmiType
    gets: bool
    items: tuple[Item, ...]


@dataclasses.dataclass(frozen=True)
class StepCall:
    """The C function that does a step.

    `answers` are the variables that FMI 3.0's function writes: flags for an event, for the end of the
    simulation and for an early end of the step, and the time reached.
    """

    pointer: Any
    answers: tuple[Any, ...] = ()


@dataclasses.dataclass(frozen=True)
class Copy:
    """A copy of `count` slots of the memory, from `source` on to `target` on."""

    source: int
    target: int
    count: int


def moving(transfer: Transfer, call: Call, memory: memoryview[float], refuse: Refusal) -> Call:
    """Return `call`, the C call of a transfer, with what moves its values between buffer and memory."""
    if not transfer.items:
        return call
    if transfer.type.kind is BOOLEAN and transfer.gets:
        return _getting_booleans(transfer, call, memory)
    return (_getting if transfer.gets else _setting)(transfer, call, memory, refuse)


def _setting(transfer: Transfer, call: Call, memory: memoryview[float], refuse: Refusal) -> Call:
    """Fill the buffer from the memory, then call."""
    values, items, kind = transfer.values, transfer.items, transfer.type
    low, high = kind.low, kind.high

    def set_reals() -> None:
        for place, slot, scale, offset, _ in items:
            value = scale * memory[slot] + offset
            if not low <= value <= high:
                refuse(place, value)
            values[place] = value
        call()

    def set_whole_numbers() -> None:
        for place, slot, scale, offset, variable in items:
            value = scale * memory[slot] + offset
            if not fits(value, kind, variable):
                refuse(place, value)
            values[place] = int(value)
        call()

    return set_reals if kind.kind is REAL else set_whole_numbers


def fits(value: float, kind: FmiType, variable: VariableInfo) -> bool:
    """Return True if a number is one of the variable's type, and of its items where it is an enumeration.

    A Boolean has 0 and 1.
    """
    if not kind.low <= value <= kind.high:
        return False
    return kind.kind is REAL or (value == int(value) and (not variable.items or value in variable.choices))


def rule(value: float, kind: FmiType, variable: VariableInfo) -> str:
    """Return the rule by which a number does not fit, as a clause."""
    about = f"it is of type {kind.name}, "
    if kind.kind is BOOLEAN:
        return about + "0 (false) or 1 (true)"
    if variable.choices and kind.low <= value <= kind.high:
        return about + f"one of {', '.join(map(str, variable.choices))}"
    whole = "" if kind.kind is REAL else "a whole number "
    return about + f"{whole}from {kind.low:.17g} to {kind.high:.17g}"


def _getting(transfer: Transfer, call: Call, memory: memoryview[float], refuse: Refusal) -> Call:
    """Call, then write the buffer into the memory; a 64-bit integer that no double holds is refused."""
    values, items = transfer.values, transfer.items

    def get_values() -> None:
        call()
        for place, slot, scale, offset, _ in items:
            memory[slot] = scale * values[place] + offset

    def get_wide_values() -> None:
        call()
        for place, slot, scale, offset, _ in items:
            value = values[place]
            if not -LARGEST_WHOLE <= value <= LARGEST_WHOLE:
                refuse(place, value)
            memory[slot] = scale * value + offset

    return get_wide_values if transfer.type.wide else get_values


def _getting_booleans(transfer: Transfer, call: Call, memory: memoryview[float]) -> Call:
    """Read Booleans: 0.0 or 1.0, whatever number an FMU takes for true."""
    values, items = transfer.values, transfer.items

    def get_values() -> None:
        call()
        for place, slot, *_ in items:
            memory[slot] = 1.0 if values[place] else 0.0

    return get_values


def copying(memory: memoryview[float], copy: Copy) -> Call:
    """Return a call that copies slots of the memory."""
    values = memory[copy.source : copy.source + copy.count]
    place = slice(copy.target, copy.target + copy.count)

    def copy_values() -> None:
        memory[place] = values

    return copy_values


def one_after_the_other(*calls: Call) -> Call:
    """Return one call that makes all of these in order."""
    if len(calls) == 1:
        return calls[0]

    def all_of_them() -> None:
        for call in calls:
            call()

    return all_of_them
