"""What a message on a CAN bus costs: python -m benchmarks.bus, from the project's folder.

A ring of units in C, each connection a message of its own at every step, in turn without a bus, as values, as
frames that arrive at once, as frames that take time, and with noise. The least processor time of all rounds
counts; beside it the ratio to values, which another load of the machine does not change.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from evcosim.master.simulation import Simulation

from . import machine, page
from .case import Case
from .runners.evcosim import as_in_a_long_run, write_system

WAYS = {
    "direct": "no bus",
    "values": 'values (`timing = "instant"`)',
    "frames": "frames that arrive at once (a `timeout`)",
    "timed": 'frames that take time (`timing = "frame"`)',
    "noisy": "the same with a bit error rate of 1e-5",
}
_TIMED = 'timing = "frame"\nbitrate = 1_000_000\n'
_KEYS = {"timed": _TIMED, "noisy": f"{_TIMED}bit_error_rate = 1e-5\n"}


def main() -> None:
    """Measure and print, and keep what was measured in the docs if asked."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.bus", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("--rounds", type=int, default=5, help="how often each is measured (default: 5)")
    parser.add_argument("--steps", type=int, default=20_000, help="steps of a run (default: 20000)")
    parser.add_argument("--units", type=int, default=20, help="units in the ring (default: 20)")
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put the table into it: docs/performance.md"
    )
    arguments = parser.parse_args()
    best = dict.fromkeys(WAYS, float("inf"))
    for _ in range(arguments.rounds):
        for way in WAYS:
            best[way] = min(best[way], measured(way, arguments.units, arguments.steps))
    text = report(best)
    print(text)
    if arguments.write is not None:
        page.put(arguments.write, "bus", text)


def measured(way: str, units: int, steps: int) -> float:
    """The processor time of a unit's step and its message [µs], in a run in this process."""
    case = Case("c", units, steps, channel=way != "direct", record=False)
    with tempfile.TemporaryDirectory() as folder:
        system = write_system(case, Path(folder))
        text = system.read_text()
        text = text.replace("[[connect]]", f"{_KEYS.get(way, '')}[[connect]]", 1)
        if way == "frames":
            text += "".join(f"[buses.can0.messages.M{i}_0]\ntimeout = 5\n" for i in range(units))
        system.write_text(text)
        with as_in_a_long_run(), Simulation(system, engine="compiled", trust=True) as simulation:
            simulation.step(1)  # what is made in the first step is no cost of a step
            begin = time.process_time()
            simulation.run()
            return 1e6 * (time.process_time() - begin) / (steps - 1) / units


def report(best: Mapping[str, float]) -> str:
    """The table: the time of each way, what its message costs, and that as a ratio to values."""
    rows = []
    for way, microseconds in best.items():
        cost = microseconds - best["direct"]
        ratio = "" if way == "direct" else f"{cost / (best['values'] - best['direct']):.3g}"
        cells = [WAYS[way], page.short(microseconds), "" if way == "direct" else page.short(cost), ratio]
        rows.append(cells)
    header = ["messages as", "µs a unit and message", "µs a message", "ratio to values"]
    return f"Measured on: {machine.about()}.\n\n{page.table(header, rows)}"


if __name__ == "__main__":
    main()
