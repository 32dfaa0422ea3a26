"""Warnings are told by kinds: texts that differ by their numbers alone are one."""

from __future__ import annotations

import pytest

from evcosim.master.warned import KINDS, WarningKinds, first_kinds, warnings_text


@pytest.mark.parametrize(
    ("texts", "kinds"),
    [
        (["too hot at 3 s", "too hot at 4.5e-3 s", "too hot at -.5 s", "too hot at +7. s"], 1),
        (["step 1: x[12] = 1e10", "step 2: x[13] = -2E+5"], 1),
        (["pointer 0x7fff12ab", "pointer 0X12"], 1),
        (["at 3s", "at 4s"], 1),
        (["x1 is late", "x2 is late"], 2),  # a name is no number
        (["wheel_1", "wheel_2"], 2),
        (["too hot at 3 s", "too cold at 3 s"], 2),
    ],
)
def test_texts_of_one_kind_differ_by_numbers_alone(texts: list[str], kinds: int) -> None:
    found, others = first_kinds(texts, len(texts))
    assert len(found) == kinds
    assert (sum(found.values()), others) == (len(texts), 0)
    assert next(iter(found)) == texts[0]


def test_the_first_kinds_are_kept_and_the_others_counted() -> None:
    made = WarningKinds()
    numbers = [made.add(word and f"{word} {i}") for i in range(5) for word in ("a", "b", "", "c", "d")]
    assert numbers[:5] == [0, 1, None, 2, None]
    assert KINDS == len(made.counts) == 3


def test_a_warning_without_text_is_of_no_kind() -> None:
    made = WarningKinds()
    assert (made.add(""), made.add("late", 4), made.add("late")) == (None, 0, 0)
    assert (made.counts, made.others) == ({"late": 5}, 1)


def test_the_sentence_on_warnings() -> None:
    assert warnings_text(1, {}) == "1 warning"
    assert warnings_text(2, {"late": 1}) == "2 warnings: late"
    assert warnings_text(18646, {"at 1 s": 18645, "b": 1}) == ("18646 warnings: at 1 s (and 18644 alike); b")
