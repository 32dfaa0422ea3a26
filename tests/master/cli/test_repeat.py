"""The command that repeats a run: what was typed, without where results go."""

from __future__ import annotations

import json
import shlex

import pytest


@pytest.mark.parametrize(
    "options",
    [
        [],
        ["--scenario", "fig9"],
        ["--set", "vehicle.mass=180", "--set", "ecu.use_observer=false", "--ideal", "--algorithm", "jacobi"],
    ],
)
def test_it_makes_the_same_rows(evcosim, tmp_path, options):
    command = ["run", "scooter", "--stop-time", "0.5", *options]
    assert evcosim(*command, "--no-plot", "-q", "-o", "a", "--replace").code == 0
    manifest = json.loads((tmp_path / "a" / "run.json").read_text(encoding="utf-8"))
    said = shlex.split(manifest["command"])
    assert said[:3] == ["evcosim", "run", "scooter"] and "a" not in said and "-q" not in said
    assert "--no-plot" in said
    assert evcosim(*said[1:], "-o", "b", "-q").code == 0
    assert (tmp_path / "b" / "results.csv").read_bytes() == (tmp_path / "a" / "results.csv").read_bytes()
    assert (tmp_path / "b" / "report.html").read_bytes() == (tmp_path / "a" / "report.html").read_bytes()


def test_words_with_spaces_are_quoted(evcosim, tmp_path):
    (tmp_path / "my file.toml").write_text('leave_out = ["rider"]\n')
    assert (
        evcosim(
            "run", "scooter", "-s", "my file.toml", "--stop-time", "0.1", "--no-plot", "-q", "-o", "a"
        ).code
        == 0
    )
    command = json.loads((tmp_path / "a" / "run.json").read_text(encoding="utf-8"))["command"]
    assert "--scenario 'my file.toml'" in command
