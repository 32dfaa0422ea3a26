"""How much memory a run holds: python -m benchmarks.memory, from the project's folder.

`evcosim run scooter` for a minute to 8 hours at 100 Hz with all that it leaves (results, metrics, figure),
and the same with --can-log, each in a process of its own. What counts is the most memory that the process has
had, beside the size of what it recorded. Needs a system that tells the former: Linux or macOS.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from . import machine, page

LENGTHS = (60.0, 600.0, 3600.0, 28800.0)
_MB = 1e6


@dataclasses.dataclass(frozen=True)
class Peak:
    """A run of `length` [s]: the most memory [bytes], the size of its rows and its CSV file, and seconds."""

    length: float
    memory: int
    rows: int
    csv: int
    seconds: float


def main() -> None:
    """Measure and print, and keep what was measured in the docs if asked."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.memory", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument(
        "lengths", nargs="*", type=float, help="lengths of the runs [s] (default: 1 min, 10 min, 1 h, 8 h)"
    )
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put table and figure into it: docs/performance.md"
    )
    arguments = parser.parse_args()
    peaks = []
    for length in arguments.lengths or LENGTHS:
        alone, with_frames = peak(length), peak(length, ["--can-log", "can.blf"])
        peaks.append((alone, with_frames))
        print(f"{shown(length)}: {alone}, {with_frames}", file=sys.stderr, flush=True)
    text = report(peaks)
    print(text)
    if arguments.write is not None:
        from . import figures  # after the runs: a process may count the memory of the one that started it

        page.put(arguments.write, "memory", text)
        figures.memory(peaks, shown, arguments.write.parent / "img" / "performance-memory.png")


def peak(length: float, more: Sequence[str] = ()) -> Peak:
    """Run the scooter for `length` [s], with `more` options of `evcosim run`."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "evcosim", "run", "scooter", "--quiet"]
        command += ["--stop-time", f"{length}", "--output", folder, *more]
        begin = time.perf_counter()
        _, status, usage = os.wait4(os.posix_spawn(sys.executable, command, os.environ), 0)
        seconds = time.perf_counter() - begin
        if status:
            raise RuntimeError(f"{' '.join(command)} failed")
        about = json.loads((Path(folder) / "run.json").read_text(encoding="utf-8"))
        rows = 8 * (about["steps"] + 1) * (len(about["variables"]) + 1)
        csv = (Path(folder) / "results.csv").stat().st_size
    return Peak(length, usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024), rows, csv, seconds)


def shown(length: float) -> str:
    """A length as a person says it: 10 min, 8 h."""
    for size, unit in ((3600.0, "h"), (60.0, "min")):
        if length >= size:
            return f"{length / size:.3g} {unit}"
    return f"{length:.3g} s"


def report(peaks: Sequence[tuple[Peak, Peak]]) -> str:
    """The table of runs without and with a CAN log."""
    header = ["run", "most memory, MB", "with --can-log, MB", "recorded rows, MB", "results.csv, MB"]
    header += ["whole command, s", "with --can-log, s"]
    rows = [
        [
            shown(p.length),
            *(page.short(size / _MB) for size in (p.memory, logged.memory, p.rows, p.csv)),
            *(f"{seconds:.1f}" for seconds in (p.seconds, logged.seconds)),
        ]
        for p, logged in peaks
    ]
    return f"Measured on: {machine.about()}.\n\n{page.table(header, rows)}"


if __name__ == "__main__":
    main()
