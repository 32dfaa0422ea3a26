"""The long comparison of native FMUs with Python: it goes on where it was ended, and ends in its time."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import pytest

from support import native_bits
from support.needs import need_c_compiler


@pytest.fixture(autouse=True)
def _compiler() -> None:
    need_c_compiler()


def asked(results: Path, steps: int, **others: float) -> argparse.Namespace:
    """Return the options of a run."""
    found = {"seconds": float("inf"), "part_seconds": 60.0, **others}
    return argparse.Namespace(steps=steps, results=results, **found)


def test_it_goes_on_where_it_was_ended(tmp_path: Path) -> None:
    results = tmp_path / "deeper" / "results.jsonl"
    first = native_bits.compared("Rider", asked(results, 700))
    lines = results.read_text().splitlines()
    assert [(part.seed, part.steps, part.said, part.ended) for part in first] == [
        (0, 500, "", False),
        (1, 200, "", False),
    ]
    assert min(part.values // part.steps for part in first) == 6
    with results.open("a") as file:  # another model or version is another basis
        print(json.dumps({**json.loads(lines[0]), "basis": "another", "seed": 7}), file=file)
    second = native_bits.compared("Rider", asked(results, 900))
    assert second[:2] == first
    assert [(part.seed, part.steps) for part in second[2:]] == [(2, 200)]
    assert native_bits.compared("Rider", asked(results, 900)) == second
    assert len(results.read_text().splitlines()) == 4


def test_a_part_that_takes_too_long_is_ended_and_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(native_bits, "ENDED", 2)
    parts = native_bits.compared("Rider", asked(tmp_path / "results", 700, part_seconds=1e-3))
    assert [(part.steps, part.ended) for part in parts] == [(0, True)] * 2
    assert native_bits.left_out({"Rider": parts, "Battery": []}, 1e-3) == (
        "\n\nLeft out, because 500 steps in Python took longer than 0.001 s: 2 of Rider."
    )
    assert native_bits.left_out({"Battery": []}, 1e-3) == ""


def test_it_ends_in_its_time_in_the_middle_of_a_part(tmp_path: Path) -> None:
    results = tmp_path / "results"
    assert native_bits.compared("Rider", asked(results, 10**6, seconds=1e-3)) == []
    assert results.read_text() == ""
