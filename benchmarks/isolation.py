"""What a process of its own costs a unit: python -m benchmarks.isolation, from the project's folder.

A ring of equal units, in C with ten signals each way and in Python (pythonfmu) with one, is stepped with all
units in the master's process and with each in its own, under both algorithms, in many short stretches that
take turns. What is printed are microseconds for a unit and step: the median stretch of each, the difference
between the two, of the medians, of the 10th percentiles and of the fastest stretches, and the ratio of the
latter two. On a machine that does other things too these say more. Then, the share of a core that the
processes take while nobody steps. Below the table: what a bare handover of a turn costs here, without an FMU
(sources/handover.c), and the processor time of a process from its start to its end, with an FMU that is
loaded and initialized and not stepped. Needs a C compiler.
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from evcosim.master.simulation import Simulation

from .case import Case, Kind
from .fmus import c_program
from .runners.evcosim import write_system

_SIGNALS = 10
_STRETCH = 25  # steps
_PAUSE = 2.0  # s
_TICKS = os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.isolation", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("--stretches", type=int, default=400, help="of 25 steps (default: 400)")
    parser.add_argument("--starts", type=int, default=20, help="of processes (default: 20)")
    parser.add_argument("--units", type=int, nargs="+", default=[1, 2, 4], help="units in a ring in C")
    parser.add_argument("--python-units", type=int, nargs="+", default=[1, 3, 6], help="in one in Python")
    arguments = parser.parse_args()
    machine = f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
    print(f"{machine}, load {os.getloadavg()[0]:.1f}; us a unit and step\n")
    heads = ("units", "algorithm", "in-process", "isolated", "cost, median", "cost, p10", "cost, min")
    print("| " + " | ".join((*heads, "ratio, p10", "ratio, min", "idle")) + " |")
    print("|---" * 10 + "|")
    cases = [Case("c", units, 1, _SIGNALS, record=False) for units in arguments.units]
    cases += [Case("python", units, 1, record=False) for units in arguments.python_units]
    for case in cases:
        for algorithm in ("gauss_seidel", "jacobi"):
            print(row(case, algorithm, arguments.stretches), flush=True)
    counts = sorted({case.units for case in cases})
    print("\na bare handover and back, fastest and median of 200 stretches:")
    for units in counts:
        asleep, looking = floor(units, looking=False), floor(units, looking=True)
        print(f"  {units} processes: {asleep} asleep until their turn, {looking} all looking")
    in_c, in_python = start_time("c", arguments.starts), start_time("python", arguments.starts)
    print(
        f"\na process from start to end, with no step: {in_c:.0f} ms of processor time with an FMU in C, "
        f"{in_python:.0f} ms with one of pythonfmu (medians of {arguments.starts})"
    )


def floor(units: int, looking: bool) -> str:
    """The time of a turn that does nothing, of which each of so many processes has one in a round."""
    with tempfile.TemporaryDirectory() as folder:
        program = c_program("handover.c", Path(folder) / "handover")
        command = [str(program), str(units), str(int(looking))]
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return " and ".join(f"{int(nanoseconds) / 1000:.1f}" for nanoseconds in said.split())


def row(case: Case, algorithm: str, stretches: int) -> str:
    """One line of the table."""
    with tempfile.TemporaryDirectory() as folder:
        system = write_system(case, Path(folder), algorithm)
        with (
            Simulation(system, isolation="none") as here,
            Simulation(system, isolation="process") as apart,
        ):
            times = np.array([[_stretch(s) for s in (here, apart)] for _ in range(stretches)])
            times /= case.units
            idle = _idle()
    medians, low = np.median(times, axis=0), np.percentile(times, 10, axis=0)
    least = np.min(times, axis=0)
    costs = [found[1] - found[0] for found in (medians, low, least)]
    cells = [f"{x:.1f}" for x in (*medians, *costs, low[1] / low[0], least[1] / least[0])]
    return f"| {case.units} {case.kind} | {algorithm} | " + " | ".join(cells) + f" | {100 * idle:.1f} % |"


def start_time(kind: Kind, starts: int) -> float:
    """The median processor time, in ms, of the process of one unit that is initialized and then freed."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        system = write_system(Case(kind, 1, 1, record=False), Path(folder))
        for _ in range(starts):
            before = _time_of_ended()
            Simulation(system, isolation="process", engine="python").close()
            found.append(1e3 * (_time_of_ended() - before))
    return float(np.median(found))


def _time_of_ended() -> float:
    """Seconds of processor time that the processes have taken that this one started and that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _stretch(simulation: Simulation) -> float:
    """Microseconds a step."""
    simulation.step(1)  # awakes the processes, which slept while the other simulation was stepped
    before = simulation.loop_seconds
    simulation.step(_STRETCH)
    return 1e6 * (simulation.loop_seconds - before) / _STRETCH


def _idle() -> float:
    """The share of a core that the children take in a pause."""
    before = _cpu_time()
    time.sleep(_PAUSE)
    return (_cpu_time() - before) / _PAUSE


def _cpu_time() -> float:
    """Seconds of processor time that this process and its children have taken."""
    found = 0
    for process in [os.getpid(), *_children()]:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        found += int(fields[11]) + int(fields[12])
    return found / _TICKS


def _children() -> list[int]:
    return [int(p) for p in Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()]


if __name__ == "__main__":
    main()
