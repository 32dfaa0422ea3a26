"""SHA-256 of results.csv of every built-in system x scenario x engine: compare with, or write, the list.

    .venv/bin/python tests/support/digests.py          # exit code 1 and the names of what differs
    .venv/bin/python tests/support/digests.py --units native   # the same digests, of native units
    .venv/bin/python tests/support/digests.py --write  # the list anew, after a change that is meant

A digest holds on one kind of machine only: another libm or BLAS may round the last bit of exp(), sin() or a
solved equation differently, so that tests compare thinned tables (`golden.py`), and this list shows what a
change of the code did on one and the same machine.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from evcosim import simulate
from evcosim.cosim.system.scenario import scenario_names
from evcosim.cosim.system.system import UnitsName, load_system, system_names

FILE = Path(__file__).parent.parent / "systems" / "golden" / "digests.txt"
ENGINES = ("compiled", "python")


def cases() -> Iterator[tuple[str, str]]:
    """Yield every built-in system with every scenario that it has."""
    for system in system_names():
        for scenario in scenario_names(load_system(system)):
            yield system, scenario


def listed() -> dict[str, str]:
    """Return the committed digests: "system scenario engine" to SHA-256."""
    lines = FILE.read_text(encoding="utf-8").splitlines()
    return {name: digest for digest, name in (line.split(maxsplit=1) for line in lines if line)}


def measured(units: UnitsName) -> Iterator[tuple[str, str]]:
    """Run every case with both engines and units of this kind; yield its name and SHA-256 of results.csv."""
    with tempfile.TemporaryDirectory() as folder:
        for system, scenario in cases():
            for engine in ENGINES:
                results = simulate(system, scenario, engine=engine, units=units)
                path = results.to_csv(Path(folder) / "results.csv")
                yield f"{system} {scenario} {engine}", hashlib.sha256(path.read_bytes()).hexdigest()


def main() -> int:
    """Compare or write; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the list anew")
    parser.add_argument("--units", choices=("python", "native"), default="python", help="the kind of units")
    asked = parser.parse_args()
    write = asked.write
    before = listed() if FILE.exists() else {}
    after = {}
    for name, digest in measured(asked.units):
        after[name] = digest
        print(f"{'same' if before.get(name) == digest else 'DIFFERS'}  {digest}  {name}", flush=True)
    if write:
        FILE.write_text("".join(f"{digest}  {name}\n" for name, digest in after.items()), encoding="utf-8")
    gone = sorted(set(before) - set(after))
    print(*(f"gone  {name}" for name in gone), sep="\n", end="\n" if gone else "")
    return 0 if write or after == before else 1


if __name__ == "__main__":
    sys.exit(main())
