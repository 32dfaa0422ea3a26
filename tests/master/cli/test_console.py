"""Tables that fit any terminal, and JSON without NaN."""

from __future__ import annotations

import json

import numpy as np
import pytest

from evcosim.master.cli import console


@pytest.mark.parametrize("columns", ["20", "40", "80", "200"])
def test_tables_lose_nothing_however_narrow(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    text = "a long description of the thing that has to be wrapped somewhere"
    console.print_table(
        ("name", "unit", "about"), [("speed", "m/s", text), ("mass", "kg", "")], right=("unit",)
    )
    said = capsys.readouterr().out
    assert "speed   m/s" in said
    assert " ".join(said.split()).endswith("mass kg")
    assert all(word in said.split() for word in text.split())
    assert not any(line != line.rstrip() for line in said.splitlines())


def test_a_wrapped_table_is_no_wider_than_the_terminal(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    console.print_wrapped(("what", "obtained"), [("a long name of a quantity", "a long text\nof two lines")])
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 40
    assert "a long name of a     a long text of two" in said


def test_json_has_no_nan(capsys):
    console.print_json({"a": [float("nan"), np.float64(1.0)], "b": float("inf")})
    assert json.loads(capsys.readouterr().out) == {"a": [None, 1.0], "b": None}
