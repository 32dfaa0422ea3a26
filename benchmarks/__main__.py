"""Measure this project and the peers that are installed: python -m benchmarks, from the project's folder.

Every master runs the same ring of units in turn, several rounds over, each in a process of its own; its
result must be the reference solution's before its time counts. What is printed is the least time a step of
each, as a Markdown table, with the reason where there is no number. Needs a C compiler; the peers come with
pip install libcosimpy ecospy tbb fmu-manipulation-toolbox.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import platform
import subprocess
import sys
from typing import Any

from .case import Case

RUNNERS = ("direct", "evcosim", "fmpy_ssp", "fmpy_container", "toolbox_container", "ecospy", "libcosimpy")
_TIMEOUT = 300.0  # s


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("--rounds", type=int, default=3, help="how often each is measured (default: 3)")
    parser.add_argument("--steps", type=int, default=10_000, help="steps of a run (default: 10000)")
    parser.add_argument("--units", type=int, nargs="+", default=[2, 5, 20], help="units in the ring")
    arguments = parser.parse_args()
    print(f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}; us a step\n")
    print("| case | " + " | ".join(RUNNERS) + " |")
    print("|---" * (1 + len(RUNNERS)) + "|")
    reasons: dict[str, None] = {}
    for case in cases(arguments.units, arguments.steps):
        best = measured(case, arguments.rounds, reasons)
        print(f"| {case.name} | " + " | ".join(best[name] for name in RUNNERS) + " |", flush=True)
    print("\n" + "\n".join(f"- {reason}" for reason in reasons))


def cases(units: list[int], steps: int) -> list[Case]:
    """What is measured."""
    found = [
        Case(kind, n, steps, record=record)
        for kind in ("c", "python")
        for n in units
        for record in (True, False)
    ]
    return [*found, Case("c", 2, steps, channel=True)]


def measured(case: Case, rounds: int, reasons: dict[str, None]) -> dict[str, str]:
    """The least microseconds a step of each master, in turn; "-" with a reason where there is none."""
    times: dict[str, list[float]] = {name: [] for name in RUNNERS}
    for _ in range(rounds):
        for name in RUNNERS:
            answer = _ask(name, case)
            if "microseconds" in answer:
                times[name].append(answer["microseconds"])
            else:
                reasons[f"{name} {answer.get('version', '')}: {answer['error']}"] = None
    return {name: f"{min(found):.3g}" if found else "-" for name, found in times.items()}


def _ask(name: str, case: Case) -> dict[str, Any]:
    command = [sys.executable, "-m", "benchmarks.worker", name, json.dumps(dataclasses.asdict(case))]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_TIMEOUT, check=False)
        answer: dict[str, Any] = json.loads(done.stdout)
        return answer
    except subprocess.TimeoutExpired:
        return {"error": f"took more than {_TIMEOUT:g} s"}
    except ValueError:
        return {"error": f"its process ended with code {done.returncode}"}


if __name__ == "__main__":
    main()
