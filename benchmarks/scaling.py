"""How the time of a step grows with the system: python -m benchmarks.scaling, from the project's folder.

The ring of C units of `python -m benchmarks`, with 1 to 1000 units of one signal, and with 2 units of 1 to 64
signals on each connection, directly and over a CAN bus; every output is recorded. Needs a C compiler.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from . import figures, machine, page
from .asking import Figure, measured
from .case import Case

UNITS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
SIGNALS = (1, 2, 4, 8, 16, 32, 64)
ENGINES = ("evcosim", "evcosim_python")
_UNIT_STEPS = 100_000


def main() -> None:
    """Measure and print, and keep what was measured in the docs if asked."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.scaling", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("--rounds", type=int, default=3, help="how often each is measured (default: 3)")
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put tables and figure into it: docs/performance.md"
    )
    arguments = parser.parse_args()
    units = [_measured(Case("c", n, _UNIT_STEPS // max(n, 10)), arguments.rounds) for n in UNITS]
    signals = [
        _measured(Case("c", 2, _UNIT_STEPS // (10 + n), signals=n, channel=channel), arguments.rounds)
        for channel in (False, True)
        for n in SIGNALS
    ]
    text = report(units, signals)
    print(text)
    if arguments.write is not None:
        page.put(arguments.write, "scaling", text)
        figures.scaling(units, signals, arguments.write.parent / "img" / "performance-scaling.png")


def _measured(case: Case, rounds: int) -> list[Figure]:
    found = measured(ENGINES, case, rounds)
    told = ", ".join(f"{f.master} {f.microseconds} {f.reason}" for f in found)
    print(f"{case.name}: {told}", file=sys.stderr, flush=True)
    return found


def report(units: Sequence[Sequence[Figure]], signals: Sequence[Sequence[Figure]]) -> str:
    """Both tables."""
    header = [
        "units",
        *(f"{name}, µs {what}" for name in ("compiled", "python") for what in ("a step", "a unit")),
    ]
    rows = [[str(row[0].case.units), *(c for f in row for c in _per(f, f.case.units))] for row in units]
    parts = [f"Measured on: {machine.about()}.\n", page.table(header, rows), ""]
    header = ["signals a connection", "direct, compiled", "direct, python", "CAN, compiled", "CAN, python"]
    half = len(signals) // 2
    rows = [
        [str(a[0].case.signals), *(_per(f, 1)[0] for f in (*a, *b))]
        for a, b in zip(signals[:half], signals[half:], strict=True)
    ]
    return "\n".join([*parts, "Two units, µs a step of the whole loop:\n", page.table(header, rows)])


def _per(figure: Figure, units: int) -> tuple[str, str]:
    """A step's time, and that time for each unit."""
    if figure.microseconds is None:
        return figure.reason, figure.reason
    return page.short(figure.microseconds), page.short(figure.microseconds / units)


if __name__ == "__main__":
    main()
