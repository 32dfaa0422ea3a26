"""Rows of ITEMS: the range of a value, and the numbers of an enumeration that leaves some out."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.interface import VariableInfo
from evcosim.master.fmi.transfer import Item, Transfer
from evcosim.master.fmi.types import BOOLEAN, TYPES
from evcosim.master.machine import tables as L
from evcosim.master.machine.items import format_of, item_row

ENUMERATION = next(t for t in TYPES if t.name == "Enumeration")


@pytest.mark.parametrize(
    ("numbers", "low", "high", "gaps"),
    [
        ((), float(ENUMERATION.low), float(ENUMERATION.high), False),
        ((1, 2, 3), 1.0, 3.0, False),
        ((4, -1), -1.0, 4.0, True),
    ],
)
def test_an_enumeration_has_the_range_and_the_gaps_of_its_items(
    numbers: tuple[int, ...], low: float, high: float, gaps: bool
) -> None:
    variable = VariableInfo("e", "Enumeration", items=tuple((n, str(n)) for n in numbers))
    kept: list[np.ndarray] = []
    transfer = Transfer("fmi2SetInteger", None, None, None, ENUMERATION, False, ())
    row = item_row(transfer, Item(0, 7, -1.0, -0.0, variable), kept)
    assert (row[L.SLOT], row[L.FACTOR], row[L.LOW], row[L.HIGH]) == (7, -1.0, low, high)
    assert (L.CHOICES in row) == gaps == bool(kept)
    if gaps:
        assert row[L.CHOICES] == len(numbers) and row[L.NUMBERS_OF] == kept[0].ctypes.data
        assert kept[0].tolist() == sorted(numbers)


@pytest.mark.parametrize("gets", [True, False])
def test_the_format_says_the_type_and_the_direction(gets: bool) -> None:
    kind = next(t for t in TYPES if t.kind is BOOLEAN)
    items = (Item(0, 0, 1.0, -0.0, VariableInfo("b", "Boolean")),)
    assert format_of(Transfer("", None, None, None, kind, gets, items)) == kind.code + gets * L.GETS
    assert format_of(Transfer("", None, None, None, kind, gets, ())) == L.IN_PLACE
