"""Hostile inputs of the command line, made from good ones by a seed; each ends cleanly, or is reported.

    python tests/support/fuzz.py --count 2000 --seed 1

Each input runs in a child of this process: exit code 0, 1, 2 or 130, no "unexpected error", no traceback, no
character that steers a terminal, and at most 10 s of a processor (60 s where others keep it busy). What does
otherwise is printed, with its files in a folder, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import importlib
import io
import os
import pkgutil
import random
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))

import evcosim
from evcosim.master.cli import main
from support.forked import Outcome, forked
from support.fuzzing import commands, dbc_files, fmus, tables, toml_files
from support.fuzzing.changes import Input

LIMIT, PATIENCE = 10.0, 60.0
"""Seconds of a processor that an input may take, and of the clock on the wall."""

_MAKERS = {
    "TOML": (toml_files.a_system, toml_files.a_scenario, toml_files.a_swap, toml_files.nested),
    "DBC": (dbc_files.a_database,),
    "CSV": (tables.a_table,),
    "XML": (fmus.an_fmu,),
    "CLI": (commands.a_command,),
}
_WEIGHTS = {"TOML": (4, 4, 3, 1)}
_CURSOR = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
KINDS = tuple(_MAKERS)
"""The kinds of inputs."""


def inputs(count: int, seed: int, only: str = "") -> Iterator[Input]:
    """Yield so many inputs, of all kinds in turn or of one; a seed gives the same ones again."""
    kinds = (only,) if only else KINDS
    for number in range(count):
        chance, kind = random.Random(f"{seed} {number}"), kinds[number % len(kinds)]
        makers = _MAKERS[kind]
        yield chance.choices(makers, _WEIGHTS.get(kind))[0](chance)


def tried(case: Input, folder: Path) -> tuple[Outcome, str]:
    """Return what became of an input in a new folder: the exit code as its value, and what was printed."""
    work = folder / "a" / "b" / "c"  # so that `../` in a name stays in the folder
    work.mkdir(parents=True)
    for name, content in case.files.items():
        (work / name).parent.mkdir(exist_ok=True)
        (work / name).write_bytes(content)
    _make_odd(work / "odd")
    said = folder / "said.txt"

    def run() -> int:
        os.chdir(work)
        os.environ.setdefault("XDG_CACHE_HOME", str(Path.home() / ".cache"))
        os.environ["HOME"] = str(folder)
        with said.open("w", errors="replace") as out, open(os.devnull) as nothing:
            os.dup2(nothing.fileno(), 0)
            for descriptor in (1, 2):
                os.dup2(out.fileno(), descriptor)
            sys.stdin, sys.stdout, sys.stderr = nothing, out, out
            return main(case.arguments)

    outcome = forked(run, PATIENCE)
    return outcome, said.read_text(errors="replace") if said.exists() else ""


def _make_odd(folder: Path) -> None:
    """Make what is no file behind the names of files: a folder, a pipe, links to a device and to itself."""
    folder.mkdir()
    (folder / "folder.toml").mkdir()
    os.mkfifo(folder / "fifo.fmu")
    (folder / "zero.csv").symlink_to("/dev/zero")
    (folder / "loop.dbc").symlink_to("loop.dbc")
    (folder / "empty.fmu").touch()


def fault(outcome: Outcome, said: str) -> str:
    """Return what is wrong with an end, or ""."""
    if outcome.crash:
        return outcome.crash.strip().splitlines()[-1]
    if outcome.busy > LIMIT:
        return f"{outcome.busy:.1f} s of a processor"
    if outcome.value not in (0, 1, 2, 130):
        return f"exit code {outcome.value}"
    if outcome.value and not said.strip():
        return f"exit code {outcome.value} without a word"
    if found := _CURSOR.search(said):
        line = next(line for line in said.split("\n") if found[0] in line)
        return f"prints {found[0]!r} in {line!r}"
    # what an FMU in a process of its own printed stands in a message, not at its beginning
    for sign in ("unexpected error", "Warning: ", "\nTraceback"):
        if sign in said and "it printed:" not in said:
            return next(line for line in said.splitlines() if sign.strip() in line)
    return ""


def warm() -> None:
    """Import and compile what the inputs need, which their children then have."""
    for module in pkgutil.walk_packages(evcosim.__path__, "evcosim."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        quiet = io.StringIO()
        with contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
            assert main(["run", "scooter", "--stop-time", "0.05", "-o", "out"]) == 0
            assert main(["info", "Battery"]) == 0


def campaign(count: int, seed: int, first: int = 0, only: str = "") -> int:
    """Try so many inputs, print a table and each fault, and return the number of faults."""
    warm()
    root = Path(tempfile.mkdtemp(prefix="evcosim-fuzz-"))
    codes: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    faults, slowest = 0, 0.0
    for number, case in enumerate(inputs(count, seed, only)):
        if number < first:
            continue
        folder = root / str(number)
        outcome, said = tried(case, folder)
        slowest = max(slowest, outcome.busy)
        if wrong := fault(outcome, said):
            faults += 1
            shown = " ".join(word[:40] for word in case.arguments)
            print(f"{folder}: {case.kind}: {shown!r}: {wrong[:200]!r}", flush=True)
        else:
            shutil.rmtree(folder, ignore_errors=True)
        codes[case.kind][str(outcome.value)] += 1
    for kind, counted in sorted(codes.items()):
        print(f"{kind}: " + ", ".join(f"{n} with exit code {code}" for code, n in sorted(counted.items())))
    print(f"{count - first} inputs of seed {seed}: {faults} faults, the slowest was busy for {slowest:.1f} s")
    if not faults:
        shutil.rmtree(root, ignore_errors=True)
    return faults


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="the number of the first input that is tried")
    parser.add_argument("--only", choices=KINDS, default="", help="one kind of input")
    given = parser.parse_args()
    sys.exit(1 if campaign(given.count, given.seed, given.first, given.only) else 0)
