"""The rows of the table ITEMS: how the kernel moves each value of a C call between memory and buffer."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..fmi.transfer import Item, Transfer
from . import tables as L


def item_row(transfer: Transfer, item: Item, kept: list[NDArray[np.float64]]) -> dict[int, int | float]:
    """Return the numbers of a row by column.

    An enumeration that leaves numbers out has an array of those that it has, which is added to `kept`.
    """
    (low, high), choices = transfer.type.doubles, item.variable.choices
    row: dict[int, int | float] = {
        L.SLOT: item.slot, L.FACTOR: item.scale, L.ADDEND: item.offset, L.LOW: low, L.HIGH: high
    }  # fmt: skip # a row
    if choices:
        row |= {L.LOW: float(choices[0]), L.HIGH: float(choices[-1])}
        if choices[-1] - choices[0] >= len(choices):
            numbers = np.array(choices, dtype=np.float64)
            kept.append(numbers)
            row |= {L.CHOICES: len(choices), L.NUMBERS_OF: numbers.ctypes.data}
    return row


def format_of(transfer: Transfer) -> int:
    """Return the code of a call's buffer."""
    if not transfer.items:
        return L.IN_PLACE
    return transfer.type.code + (L.GETS if transfer.gets else 0)
