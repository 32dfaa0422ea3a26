"""Notes of texts: a row for each change, and no row twice."""

from __future__ import annotations

from evcosim.cosim.results.variable import ResultVariable
from evcosim.cosim.texts import Texts
from evcosim.master.engine.text_notes import TextNotes


class Plan:
    """The texts of a plan, in the slots 1 and 0."""

    text_columns = (ResultVariable("a.s", type="String"), ResultVariable("b.t", type="String"))
    text_slots = (1, 0)

    def __init__(self) -> None:
        self.texts = Texts()


def test_a_row_is_noted_where_a_text_changes() -> None:
    plan, memory = Plan(), memoryview(bytearray(24)).cast("d")
    notes = TextNotes(plan, memory)
    for k, text in enumerate(["", "", "on", "on", "", "on"]):
        memory[1] = plan.texts.number(text)
        memory[2] = float(k)  # no text stands there
        notes.note(k)
        if k == 2:
            assert notes.since(0) == [(0, ("", "")), (2, ("on", ""))]
    assert notes.since(2) == [(4, ("", "")), (5, ("on", ""))]
    assert notes.since(4) == []
    memory[0] = plan.texts.number("now")
    expected = [(0, ("", "")), (2, ("on", "")), (4, ("", ""))]
    assert list(notes.table(5, now=False).changes) == expected
    assert list(notes.table(6, now=True).changes) == [*expected, (5, ("on", "")), (6, ("on", "now"))]
    assert list(notes.table(5, now=True).changes) == [*expected, (5, ("on", "now"))]


def test_the_present_is_one_row_more_only_where_it_differs() -> None:
    plan, memory = Plan(), memoryview(bytearray(16)).cast("d")
    notes = TextNotes(plan, memory)
    assert list(notes.table(0, now=True).changes) == [(0, ("", ""))]
    notes.note(0)
    assert list(notes.table(1, now=True).changes) == [(0, ("", ""))]
    assert list(notes.table(0, now=False).changes) == []
