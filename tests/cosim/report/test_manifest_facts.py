"""The facts of a manifest that may say anything."""

from __future__ import annotations

import pytest

from evcosim.cosim.report.manifest_facts import items_of, records_of, shown, texts_of


@pytest.mark.parametrize("value", [None, 3, "text", True, 1.5])
def test_there_are_none_in_anything_else(value):
    assert (items_of(value), records_of(value), texts_of(value)) == ([], [], [])


def test_what_is_there_is_found():
    assert items_of({"a": 1}) == [("a", 1)]
    assert records_of([{"a": 1}, 2]) == [{"a": 1}]
    assert texts_of(["a", 2]) == ["a"]


def test_values_as_cells():
    values = [True, False, None, 0.1, 3, "text", [1, "a"], 1e300]
    assert [shown(value) for value in values] == ["true", "false", "", "0.1", "3", "text", "1, a", "1e+300"]
