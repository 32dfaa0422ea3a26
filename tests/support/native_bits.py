"""Native FMUs beside Python, bit for bit, in many random steps, and the time of a step of both.

    .venv/bin/python tests/support/native_bits.py                    # 100,000 steps of each built-in model
    .venv/bin/python tests/support/native_bits.py --steps 1000 Rider
    .venv/bin/python tests/support/native_bits.py --seconds 60       # of each model, no more than so long
    .venv/bin/python tests/support/native_bits.py --write  # put the table into docs/how-to/native.md

Parameters, inputs, start times and step sizes are random (evcosim.fmus.native.check). A step is set, step and
get, called by a loop in C (python -m benchmarks.slaves). The exit code is 1 where a bit differs.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT)]  # for benchmarks

from benchmarks import machine, page  # noqa: E402 - they are found from here on
from benchmarks.slaves import measured_files  # noqa: E402 - the same
from evcosim.fmus.build import built, names  # noqa: E402 - the same
from evcosim.fmus.catalog import CATALOG  # noqa: E402 - the same
from evcosim.fmus.native.build import extracted_library, native_built  # noqa: E402 - the same
from evcosim.fmus.native.check import Counts, first_difference  # noqa: E402 - the same

PAGE = ROOT / "docs" / "how-to" / "native.md"
PART = 500  # steps with one seed
HEADER = ("model", "steps", "values", "different bits", "refusals", "native [us]", "Python [us]")


class Compared(NamedTuple):
    """What the comparison of a model found; `said` is its first difference or ""."""

    counts: Counts
    said: str


def compared(name: str, steps: int, seconds: float) -> Compared:
    """Compare a built-in model in so many steps, each part with a seed of its own."""
    import fmpy

    path, counts = native_built(name), Counts()
    token = fmpy.read_model_description(path).guid
    model = getattr(import_module(f"evcosim.models.{CATALOG[name].module}"), name)
    end = time.monotonic() + seconds
    with tempfile.TemporaryDirectory() as folder:
        library = extracted_library(path, Path(folder))
        seed = 0
        while counts.steps < steps and time.monotonic() < end:
            said = first_difference(model, library, token, min(PART, steps - counts.steps), seed, counts)
            if said:
                return Compared(counts, f"seed {seed}: {said}")
            seed += 1
    return Compared(counts, "")


def row(name: str, found: Compared, rounds: int) -> list[str]:
    """Return a line of the table."""
    seconds = measured_files(name, {"native": native_built(name), "python": built(name)}, rounds, 200)
    c = found.counts
    different = "0" if not found.said else found.said
    times = (f"{1e6 * seconds[kind]:.3g}" for kind in ("native", "python"))
    return [name, f"{c.steps:,}", f"{c.values:,}", different, f"{c.refusals:,}", *times]


def main() -> int:
    """Compare, print the table, and return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="built-in models; default: all")
    parser.add_argument("--steps", type=int, default=100_000, help="random steps of each (default: 100000)")
    parser.add_argument(
        "--seconds", type=float, default=float("inf"), help="of each model at most (default: all steps)"
    )
    parser.add_argument("--rounds", type=int, default=20, help="of the measurement of a step (default: 20)")
    parser.add_argument("--write", action="store_true", help="put the table into docs/how-to/native.md")
    given = parser.parse_args()
    rows, differs = [], False
    for name in given.names or names():
        found = compared(name, given.steps, given.seconds)
        differs |= bool(found.said)
        rows.append(row(name, found, given.rounds))
        print("  ".join(rows[-1]), file=sys.stderr, flush=True)
    text = f"Measured on: {machine.about()}.\n\n{page.table(list(HEADER), rows)}"
    print(text)
    if given.write:
        page.put(PAGE, "native", text)
    return int(differs)


if __name__ == "__main__":
    raise SystemExit(main())
