"""The numbers in the tables of the frame path that a structure knows: layouts, protection, receivers."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from ....cosim.can.wire import tables as T
from ..fault_tables import Arrays

_COLUMNS: dict[str, tuple[int, ...]] = {
    "messages": (
        T.BUS, T.LENGTH, T.FIRST_SIGNAL, T.SIGNALS, T.RING, T.LOGGED, T.NODE, T.JITTER, T.PAGE, T.PAGES,
        T.PROFILE, T.CRC_AT, T.COUNTER_START, T.COUNTER_BITS, T.COUNTER_LITTLE, T.NIBBLE_START,
        T.NIBBLE_LITTLE, T.FIRST_LISTENER, T.LISTENERS, T.FIRST_VERDICT, T.TIMEOUT, T.FIRST_STATUS,
        T.STATUSES, T.CHECK_START, T.CHECK_BITS, T.CHECK_LITTLE, T.BABBLES, T.OWNED, T.SEND_TYPE,
        T.FIRST_USE, T.USES, T.COVERED, T.CYCLE,
    ),
    "signals": (
        T.SOURCE, T.KIND, T.SATURATES, T.FIRST_SINK, T.SINKS, T.START, T.BITS, T.LITTLE, T.SIGNED,
    ),
    "sinks": (T.SLOT, T.LISTENER),
    "listeners": (T.OWNER,),
    "uses": (T.TURN_EVERY, T.FIRST_TURN, T.LATER, T.USER),
    "buses": (T.DELAY, T.TIMED),
    "statuses": (),
    "state": (T.FAULTS,),
}  # fmt: skip # a table's columns
"""The columns that are known; those of a table in one dimension are its places, () for all of them."""
_FIXED = ("reals", "maps", "fallback", "base", "ids")
"""Tables that do not change while the machine code runs."""
_PLAIN = (0.0, -0.0, 1.0)
_MOST = 64  # messages, beyond which writing them out takes LLVM long


@dataclasses.dataclass(frozen=True)
class Frames:
    """The known numbers by table and place, and the shapes of tables. `text` says all of it."""

    numbers: dict[str, dict[int, int | float]]
    shapes: dict[str, tuple[int, ...]]
    text: str

    def known(self, table: str, place: int) -> int | float | None:
        """Return the number at a place of a table, in words from its begin; None: it is not known."""
        return self.numbers.get(table, {}).get(place)

    def is_fixed(self, table: str, place: object) -> bool:
        """Return True for a place, known or not, whose number does not change in a chunk of steps."""
        return table in _FIXED or (table == "state" and place == T.STEP_TIME)


def frames_of(arrays: Arrays) -> Frames | None:
    """Return what is known of tables; None: there are faults, or more messages than are written out."""
    if arrays["state"][T.FAULTS] or len(arrays["messages"]) > _MOST:
        return None
    numbers = {name: _known(arrays[name], columns) for name, columns in _COLUMNS.items()}
    numbers["buses"] |= {
        row * T.BUS_WIDTH + T.STRIKES: 0
        for row in range(len(arrays["buses"]))  # there are no faults
    }
    for name in ("reals", "maps"):
        numbers[name] = {i: v for i, v in enumerate(arrays[name].ravel().tolist()) if _is_plain(v)}
    shapes = {name: tuple(int(n) for n in array.shape) for name, array in arrays.items()}
    used = {name: shape for name, shape in shapes.items() if len(shape) == 2}
    return Frames(numbers, shapes, repr((numbers, {name: shape[1] for name, shape in used.items()})))


def _known(array: Any, columns: tuple[int, ...]) -> dict[int, int | float]:
    values = array.ravel().tolist()
    if array.ndim == 1:
        return {place: values[place] for place in columns or range(len(values))}
    width = array.shape[1]
    return {
        row * width + column: values[row * width + column] for row in range(len(array)) for column in columns
    }


def _is_plain(value: float) -> bool:
    return value in _PLAIN and not math.isnan(value)
