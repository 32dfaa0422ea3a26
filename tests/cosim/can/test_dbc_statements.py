"""The statements of a DBC file: where each begins, whatever the others are like."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.dbc_statements import Statement, statements

PIECES = [
    'VERSION ""',
    "BS_:",
    "BU_: A B",
    "BO_ 1 M: 8 A",
    'SG_ S : 0|8@1+ (1,0) [0|0] "" B',
    'CM_ BO_ 1 "a\nSG_";',
    'VAL_ 1 S 0 "x" ;',
    'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10;',
    'BA_ "GenMsgCycleTime" BO_ 1 10;',
]


def found(text: str) -> list[tuple[str, int]]:
    return [(s.keyword, s.line) for s in statements(text)]


@given(st.lists(st.sampled_from(PIECES)), st.sampled_from(["\n", " ", "\r\n\r\n\t"]))
def test_each_is_found_where_it_begins(pieces: list[str], between: str) -> None:
    made = list(statements(between.join(pieces)))
    assert [s.text for s in made] == [piece.rstrip(" ;") for piece in pieces]
    line = 1
    for statement, piece in zip(made, pieces, strict=True):
        assert statement.line == line
        line += (piece + between).count("\n")


@pytest.mark.parametrize(
    ("text", "keywords"),
    [
        ("", []),
        ("nothing of it", [("", 1)]),
        ("NS_ :\n\tNS_DESC_\n\tCM_\n\tBU_SG_REL_\n\tBO_\nBS_:", [("NS_", 1), ("BS_", 6)]),
        ('NS_ :\n CM_\nCM_ "text";', [("NS_", 1), ("CM_", 3)]),
        ("NS_ : BS_: BU_: A", [("NS_", 1), ("BS_", 1), ("BU_", 1)]),
        ('CM_ BO_ 1 "open"\nBO_ 2 N: 8 A', [("CM_", 1), ("BO_", 2)]),
        ('CM_\n SG_ 1 S "below";', [("CM_", 1)]),
        ('// BO_ 1 M: 8 A\nVAL_ 1 S 0 "//" ;', [("VAL_", 2)]),
        ('CM_ "no end\nBO_ 1 M: 8 A', [("CM_", 1), ("BO_", 2)]),
    ],
)
def test_the_edges(text: str, keywords: list[tuple[str, int]]) -> None:
    assert found(text) == keywords


def test_a_long_one_is_shown_short() -> None:
    assert Statement("CM_", "CM_ " + "x\n" * 99, 1).shown == "CM_ " + "x " * 38 + "..."
