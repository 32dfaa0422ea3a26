"""The text of a function: blocks end once, and numbers keep their bits."""

from __future__ import annotations

import struct

import pytest

from evcosim.master.engine.compiled.llvm_text import WORD, Function, number


@pytest.mark.parametrize("value", [0.0, -0.0, 0.1, -1e300, 5e-324, float("inf")])
def test_a_number_has_all_its_bits(value: float) -> None:
    assert struct.pack(">d", value).hex().upper() == number(value)[2:]


def test_what_is_seldom_stands_behind_the_rest() -> None:
    f = Function("f", ["a"], opaque=True)
    with f.seldom(f.let(f"icmp eq {WORD} %a, 0")):
        f.store(WORD, 1, "%a", 2)
        with f.seldom(f.let(f"icmp eq {WORD} %a, 1")):
            f.give(7)
    f.give(8)
    text = f.text()
    assert text.index("ret i64 8") < text.index("store i64 1") and text.index("ret i64 8") < text.index(
        "ret i64 7"
    )
    for block in text.partition("{\n")[2].split(":\n")[1:]:  # each ends once, at its end
        lines = [line.strip() for line in block.splitlines() if line.startswith("  ")]
        assert [line.startswith(("br ", "ret ")) for line in lines] == [False] * (len(lines) - 1) + [True]


@pytest.mark.parametrize(
    ("opaque", "expected"), [(True, "load double, ptr"), (False, "load double, double*")]
)
def test_pointers_have_types_where_llvm_wants_them(opaque: bool, expected: str) -> None:
    f = Function("f", ["a"], opaque)
    f.load("double", "%a", 3)
    assert expected in f.text()
    assert "add i64 %a, 24" in f.text()
