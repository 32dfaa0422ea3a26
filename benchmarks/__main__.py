"""Measure this project and the peers that are installed: python -m benchmarks, from the project's folder.

Every master runs the same ring of units in turn, several rounds over, each in a process of its own, with all
processors and with one; its result must be the reference solution's before its time counts. What is printed
is the least time a step of the whole loop, beside it the ratio to this project's, and the reason where there
is no number. Needs a C compiler; the peers come with
pip install libcosimpy ecospy tbb fmu-manipulation-toolbox, and one that needs other versions of packages
from an environment of its own: --python cofmupy=PATH.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from . import figures, machine, page
from .asking import Figure, measured
from .case import Case, Kind

MASTERS = (
    "direct", "evcosim", "evcosim_python", "ecospy", "fmpy_loop", "fmpy_ssp", "cofmupy", "libcosimpy",
    "fmpy_container", "toolbox_container",
)  # fmt: skip # one list
NAMES = {
    "direct": "bare C calls (lower bound)",
    "evcosim": "evcosim, compiled engine",
    "evcosim_python": "evcosim, python engine",
    "ecospy": "ecospy {}",
    "fmpy_loop": "FMPy {}, a loop of raw calls",
    "fmpy_ssp": "FMPy {} simulate_ssp",
    "cofmupy": "CoFmuPy {}",
    "libcosimpy": "libcosimpy {}",
    "fmpy_container": "FMPy {} container FMU",
    "toolbox_container": "fmu-manipulation-toolbox {} container FMU",
}
_OWN = "evcosim"
_UNIT_STEPS = {"c": 1_000_000, "python": 20_000}
"""Steps of all units together, where a run has many units: so long that a step's time is steady."""

Group = tuple[Kind, bool, bool]
"""Kind of FMU, whether connections cross a CAN bus, whether every output is recorded."""
GROUPS: tuple[Group, ...] = (
    ("c", False, True), ("c", True, True), ("c", False, False),
    ("python", False, True), ("python", True, True), ("python", False, False),
)  # fmt: skip # one table


def main() -> None:
    """Measure and print, and keep what was measured in the docs if asked."""
    arguments = _arguments()
    print(machine.about(), file=sys.stderr)
    found = []
    for group in GROUPS:
        for units in arguments.units:
            asked = case(group, units, arguments.steps)
            found.append(measured(MASTERS, asked, arguments.rounds, dict(arguments.python)))
            print(f"{found[-1][0].case.name}: {_in_short(found[-1])}", file=sys.stderr, flush=True)
    text = report(found)
    print(text)
    if arguments.write is not None:
        page.put(arguments.write, "masters", text)
        figures.masters(found, NAMES, arguments.write.parent / "img" / "performance-masters.png")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("--rounds", type=int, default=3, help="how often each is measured (default: 3)")
    parser.add_argument("--steps", type=int, default=100_000, help="steps of a run at most (default: 100000)")
    parser.add_argument("--units", type=int, nargs="+", default=[2, 5, 20, 100], help="units in the ring")
    parser.add_argument(
        "--python", type=_interpreter, action="append", default=[], metavar="MASTER=PATH",
        help=f"Python of a master that is installed elsewhere; masters: {', '.join(MASTERS)}",
    )  # fmt: skip # as the others
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put tables and figure into it: docs/performance.md"
    )
    return parser.parse_args()


def _interpreter(text: str) -> tuple[str, str]:
    """The master and the path of MASTER=PATH."""
    master, _, path = text.partition("=")
    if master not in MASTERS or not path:
        raise argparse.ArgumentTypeError(
            f"{text!r}: MASTER=PATH, with one of the masters {', '.join(MASTERS)}"
        )
    return master, path


def case(group: Group, units: int, steps: int) -> Case:
    """A case of a group; with many units it has fewer steps."""
    kind, channel, record = group
    return Case(kind, units, min(steps, _UNIT_STEPS[kind] // units), channel=channel, record=record)


def _in_short(figures: Sequence[Figure]) -> str:
    return ", ".join(
        f"{f.master} {page.short(f.microseconds)}" for f in figures if f.microseconds is not None
    )


def report(found: Sequence[Sequence[Figure]]) -> str:
    """All tables, and below them why there are no numbers where there are none."""
    parts = [f"Measured on: {machine.about()}.\n"]
    for group in GROUPS:
        rows = [figures for figures in found if _group(figures[0].case) == group]
        if rows:
            parts += [f"{_title(group)}:\n", _table(rows), ""]
    reasons = dict.fromkeys(
        f"- {_named(f)}: {f.reason}" for row in found for f in row if f.microseconds is None
    )
    return "\n".join([*parts, "Where there is no number:\n", *reasons])


def _group(case: Case) -> Group:
    return case.kind, case.channel, case.record


def _title(group: Group) -> str:
    kind, channel, record = group
    parts = [
        "C FMUs" if kind == "c" else "pythonfmu FMUs",
        "every connection over a CAN bus" if channel else "",
    ]
    parts.append("every output recorded at every step" if record else "nothing recorded")
    return "**" + ", ".join(part for part in parts if part) + "**, µs a step of the whole loop"


def _table(rows: Sequence[Sequence[Figure]]) -> str:
    """A line for each master that has a number, a column for each number of units."""
    lines = []
    for i, figure in enumerate(rows[0]):
        column = [figures[i] for figures in rows]
        if any(f.microseconds is not None for f in column):
            lines.append(
                [_named(figure), *(_cell(f, figures) for f, figures in zip(column, rows, strict=True))]
            )
    return page.table(["master", *(f"{figures[0].case.units} units" for figures in rows)], lines)


def _cell(figure: Figure, all_of_case: Sequence[Figure]) -> str:
    """The time, and how many times that of this project's it is."""
    if figure.microseconds is None:
        return "-"
    star = "\\*" if figure.one_core else ""
    own = next((f.microseconds for f in all_of_case if f.master == _OWN), None)
    ratio = "" if own is None or figure.master == _OWN else f" ({page.short(figure.microseconds / own)} x)"
    return f"{page.short(figure.microseconds)}{star}{ratio}"


def _named(figure: Figure) -> str:
    return " ".join(NAMES[figure.master].format(figure.version).split())


if __name__ == "__main__":
    main()
