"""The application: help at once for every verb, the version, and nothing heavy imported for it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from evcosim.master.cli import app

LIGHT = "import sys, evcosim.master.cli.app as app; app.command(); print(*sys.modules)"


def test_help_names_every_verb(process):
    shown = process("--help").communicate()[0]
    verbs = app.command().commands
    assert {"run", "info", "schema"} <= set(verbs)
    assert not [verb for verb in verbs if f"  {verb} " not in shown]


def test_help_imports_nothing_heavy():
    loaded = subprocess.run([sys.executable, "-c", LIGHT], capture_output=True, text=True, check=True).stdout
    heavy = {
        "numpy",
        "scipy",
        "pydantic",
        "fmpy",
        "pythonfmu",
        "matplotlib",
        "cantools",
        "can",
        "pint",
    }
    assert not heavy & set(loaded.split())


@pytest.mark.parametrize("verb", ["run", "list", "info", "plot", "compare", "build", "identify"])
def test_every_verb_has_help(evcosim, verb):
    answer = evcosim(verb, "--help")
    assert (answer.code, answer.err) == (0, "")
    assert f"Usage: evcosim {verb}" in answer.out


def test_version_and_no_verb(evcosim):
    assert evcosim("--version").out.startswith("evcosim 0.")
    answer = evcosim()
    assert answer.code == 2
    assert "Usage: evcosim" in answer.out
