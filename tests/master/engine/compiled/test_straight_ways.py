"""A value where ways meet is one of them, or chosen by the way."""

from __future__ import annotations

import pytest

from evcosim.master.engine.compiled.llvm_text import DOUBLE, WORD, Function
from evcosim.master.engine.compiled.straight_numbers import BIT, Number, UnknownForm
from evcosim.master.engine.compiled.straight_ways import AllTables, Table, Value, joined

A, B = Number("%a", WORD, 0, 7), Number("%b", WORD, -3, 15)


def meet(*values: Value) -> tuple[Value, str]:
    """What values are, each on a way of its own, and what was written for it."""
    f = Function("f", [], opaque=True)
    found = joined(f, [(f"way{i}", value) for i, value in enumerate(values)])
    return found, f.text().partition("entry:\n")[2].partition("}")[0].strip()


@pytest.mark.parametrize("value", [3, -0.0, A, None, Table("frame"), (1, A), True])
def test_what_is_the_same_on_all_ways_is_written_nowhere(value: Value) -> None:
    assert meet(value, value, value) == (value, "")


def test_numbers_that_differ_are_chosen_with_their_bounds() -> None:
    found, text = meet(A, B, 20)
    assert (found, text) == (
        Number("%v1", WORD, -3, 20),
        "%v1 = phi i64 [ %a, %way0 ], [ %b, %way1 ], [ 20, %way2 ]",
    )
    assert meet(0.0, -0.0)[0] == Number("%v1", DOUBLE)
    assert meet((1, A), (1, B))[0] == (1, Number("%v1", WORD, -3, 15))


def test_what_is_no_number_on_one_way_is_not_known() -> None:
    assert meet(A, None) == meet(Table("frame"), 3) == meet((1, 2), AllTables()) == (None, "")
    with pytest.raises(UnknownForm):
        meet(A, Number("%bit", BIT))
