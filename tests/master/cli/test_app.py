"""The application: help at once for every verb, the version, and nothing heavy imported for it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from evcosim.master.builtin import fmu_file
from evcosim.master.cli import app
from evcosim.master.engine.selection import compile_engine
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.machine.hands import POSSIBLE

LIGHT = (
    "import sys, evcosim.master.cli.app as app; list(app.command().commands.values()); print(*sys.modules)"
)


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


VERBS = """
import sys
from evcosim.master.cli import app
app.command().commands[sys.argv[1]]
print(*(name.rpartition(".")[2] for name in sys.modules if name.startswith("evcosim.master.cli.")))
"""


@pytest.mark.parametrize("verb", ["run", "list", "results"])
def test_a_verb_is_made_without_the_others(verb):
    loaded = subprocess.run(
        [sys.executable, "-c", VERBS, verb], capture_output=True, text=True, check=True
    ).stdout.split()
    modules = {place[1:].partition(":")[0] for place in app._VERBS.values()}
    assert modules & set(loaded) == {"listing" if verb == "list" else verb}


USED = """
import sys
from evcosim.master.cli import main
code = main(sys.argv[1:])
print(*sys.modules, file=sys.stderr)
sys.exit(code)
"""
LARGE = {
    "PIL", "asammdf", "asyncio", "can", "cantools", "fmpy", "jinja2", "llvmlite", "lxml", "matplotlib",
    "msgpack", "multiprocessing", "numba", "numpy", "pandas", "pint", "pydantic", "pythonfmu", "rich",
    "scipy", "xarray",
}  # fmt: skip # one list


@pytest.mark.parametrize(
    ("line", "needed"),
    [
        ("list", {"pydantic"}),
        ("info scooter", {"pydantic", "numpy"}),
        ("run scooter --stop-time 2 --no-plot -q -o out", {"pydantic", "numpy"}),
    ],
)
def test_a_verb_imports_what_it_uses(line, needed, tmp_path):
    """A run finds its machine code and the descriptions of its units in the cache, and draws nothing."""
    compile_engine()
    for name in ("Rider", "BoundPlanner", "BoundController", "Scooter", "Battery"):
        read_fmu(fmu_file(name))
    command = [sys.executable, "-c", USED, *line.split()]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path)
    loaded = set(done.stderr.split()) & LARGE
    assert loaded == needed or (not POSSIBLE and loaded <= needed | {"numba", "llvmlite", "scipy"})


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
