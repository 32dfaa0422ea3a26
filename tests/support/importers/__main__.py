"""Our FMUs in the importers of others, into docs/fmus-elsewhere.md.

    PYTHONPATH=tests python -m support.importers --environment FOLDER... --program NAME=FILE... [--write]

An environment is one of `python -m venv` that has importers; programs are c_host, fmusim and fmuCheck. The
page says how both are made. `--only NAME` tries importers whose name contains NAME; with `--write` the record
and the page keep all the others.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[3]
sys.path[:0] = [str(ROOT)]  # for benchmarks

from benchmarks import machine  # noqa: E402 - it is found from here on
from evcosim.fmus.build import names  # noqa: E402 - the same
from evcosim.fmus.native.build import extracted_library  # noqa: E402 - the same
from support.importers import importers, pages, systems, trials  # noqa: E402 - the same


def libraries() -> dict[str, list[str]]:
    """Return what the native FMUs of FMI 2.0 and 3.0 need of the system, all together."""
    needed: set[str] = set()
    versions: set[tuple[int, ...]] = set()
    symbols: set[str] = set()
    for name in names():
        with tempfile.TemporaryDirectory() as folder:
            library = extracted_library(trials.fmu(name, "native 2"), Path(folder))
            dynamic = subprocess.run(
                ["objdump", "-pT", library], check=True, capture_output=True, text=True
            ).stdout
        needed |= set(re.findall(r"NEEDED +(\S+)", dynamic))
        versions |= {tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([\d.]+)", dynamic)}
        symbols |= set(re.findall(r"\*UND\*.*?\(?GLIBC_[\d.]+\)? +(\w+)", dynamic))
    highest = "GLIBC_" + ".".join(map(str, max(versions)))
    return {"libraries": sorted(needed), "highest version": [highest], "functions": sorted(symbols)}


def main() -> int:
    """Try, print what was found, and return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--environment", type=Path, action="append", default=[], help="with importers in Python"
    )
    parser.add_argument(
        "--program", action="append", default=[], metavar="NAME=FILE", help="an importer in C"
    )
    parser.add_argument("--only", default="", metavar="NAME", help="importers whose name contains this")
    parser.add_argument(
        "--write", action="store_true", help="keep the record, and write the tables of the page"
    )
    given = parser.parse_args()
    programs = {
        name: Path(file).resolve() for name, _, file in (word.partition("=") for word in given.program)
    }
    environments = [folder.absolute() for folder in given.environment]
    found: dict[str, Any] = {}
    for one in [*importers.in_c(programs), *importers.in_environments(environments)]:
        if given.only in one.name:
            kinds = {kind: trials.tried(one.run, kind, one.can) for kind in trials.KINDS}
            found[one.name] = {"version": one.version, **kinds}
            print(one.name, file=sys.stderr, flush=True)
    if given.only:
        record = pages.recorded()
        record["importers"] |= found
    else:
        record = {
            "machine": machine.about(),
            "importers": found,
            "libraries": libraries(),
            "speeds": systems.speeds(importers.homes(environments)),
        }
    for text in pages.tables(record).values():
        print(f"{text}\n")
    if given.write:
        pages.write(record)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
