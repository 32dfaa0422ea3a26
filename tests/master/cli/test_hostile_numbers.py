"""A hostile number at any option of any verb makes a result or a message, never a crash or no end."""

from __future__ import annotations

import contextlib
import io
import os
from pathlib import Path
from typing import Any

import pytest

from evcosim.master.cli import main
from evcosim.master.cli.app import command
from support import small_bench
from support.forked import forked

NUMBERS = [
    "",
    "-1",
    "1e-320",
    "1e308",
    "nan",
    LARGE := "9223372036854775808",
    TWELVE := "\N{ARABIC-INDIC DIGIT ONE}\N{ARABIC-INDIC DIGIT TWO}",
    "9" * 5000,
]
BASES = [
    "run s.toml --engine python --no-plot -q -o out --replace",
    "run Battery --engine python --stop-time 0.03 --no-plot -q -o out --replace",
    "check Battery --as scooter.battery",
    "compare a.csv a.csv",
    "identify Scooter --engine python --input throttle --output speed --amplitude 1 --sweep 0.5,2 "
    "--duration 4 --no-plot -q -o out",
    "budget s.toml --engine python --workers 1 -o out",
    "bus s.toml --engine python -o out",
    "info one.dbc",
    "build Rider --native -o out",
    "reproduce nothing",
]
"""Good command lines of all verbs that take a number; `reproduce` refuses its paper, after its options."""

NAMED = {"--set": ("vehicle.mass=", "capacity=", "mass="), "--input": ("power=", "throttle=")}
IN_WORDS = ("nothing", "the sweep of", "band 0.75 to 1.0 Hz holds")
"""What messages say that name no option: the paper, the working point, and the band of so short a sweep."""

PAIRS = ("--sweep", "--band")
LENGTHS = ("", "ms")
FILES = {
    "--output",
    "-o",
    "--output-folder",
    "--scenario",
    "--fmu",
    "--swap",
    "--diagram",
    "--write",
    "--plot",
}
NAMES = {"--as", "--from", "--json-of", "--signals", "--causality", "--search", "--unit"}


def valued(verb: str) -> list[Any]:
    """Return the options of a verb that take a value, which may be a number."""
    options = [o for o in command().commands[verb].params if getattr(o, "is_flag", True) is False]
    chosen = [o for o in options if not (FILES | NAMES) & set(o.opts)]
    return [o for o in chosen if not _is_choice(o)]


def of_its_own(base: str) -> list[str]:
    """Return the options with a value that no other verb has in an earlier line of BASES."""
    earlier = [base.split()[0] for base in BASES[: BASES.index(base)]]
    verb = base.split()[0]
    seen = {(o.opts[0], o.metavar) for other in earlier if other != verb for o in valued(other)}
    return [o.opts[0] for o in valued(verb) if (o.opts[0], o.metavar) not in seen]


def _is_choice(option: Any) -> bool:
    """Return True for an option of a few words, which are listed when another one is given."""
    return "Choice" in str(option.type_descriptor.annotation)


LONG = {("--workers", LARGE), ("--try", TWELVE)}
"""Good values that take their time: a process for each run, which `run_all.workers` in
tests/test_hostile_arguments.py does with one task, and a trial of 12 s beside that of 12 ms."""


def written(option: str, value: str) -> list[str]:
    """Return the ways in which a number is written for an option."""
    if option in NAMED:
        return [name + value for name in NAMED[option]]
    if option in PAIRS:
        return [f"1,{value}", f"{value},2"]
    if option == "--try":
        return [value + unit for unit in LENGTHS]
    return [value]


def outcome(arguments: list[str]) -> tuple[int, str]:
    """Return the exit code of a command line and what it printed."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        code = main(arguments)
    return code, said.getvalue()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    small_bench.write(tmp_path)
    (tmp_path / "one.dbc").write_text('BU_: A\nBO_ 1 M: 8 A\n SG_ S : 0|8@1+ (1,0) [0|0] "" A\n')
    (tmp_path / "a.csv").write_text("time,x\n0.0,1.0\n0.01,2.0\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_verb_with_a_number_is_tried():
    verbs = {verb for verb in command().commands if verb != "results" and valued(verb)}
    assert verbs == {base.split()[0] for base in BASES}
    assert len([option for verb in verbs for option in valued(verb)]) > 20


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each verb is tried in a child of this process")
@pytest.mark.parametrize("base", BASES, ids=lambda base: " ".join(base.split()[:2]))
def test_a_hostile_number_is_used_or_refused(base, folder: Path):
    words = base.split()
    cases = [(o, text) for o in of_its_own(base) for value in NUMBERS for text in written(o, value)]
    cases = [case for case in cases if case not in LONG]
    found = forked(lambda: [outcome([*words, option, text]) for option, text in cases], limit=300.0)
    assert not found.crash, found.crash
    for (option, text), (code, said) in zip(cases, found.value, strict=True):
        shown = f"{base} {option} {text[:40]}: exit code {code}: {said[:1000]}"
        assert code in (0, 1, 2), shown
        assert "unexpected error" not in said and "Traceback" not in said, shown
        assert code == 0 or said.strip(), shown
        name = option.lstrip("-").replace("-", "_")
        assert code != 2 or any(part in said for part in (option, name, text[:20], *IN_WORDS)), shown
        assert len(said) < 8000, shown
