"""What a step of a whole system costs: python -m benchmarks.systems, from the project's folder.

Each built-in system with native units, all of its variables recorded at every step, in a scenario of its own.
The least processor time of all rounds counts, of the stepping alone, with the machine code of long runs.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from evcosim import Simulation
from evcosim.cosim.system.run_options import RunOptions

from . import machine, page
from .runners.evcosim import as_in_a_long_run


class Ride(NamedTuple):
    """A scenario of a built-in system; `stop_time` [s], where it goes on longer than the scenario says."""

    system: str
    scenario: str
    stop_time: float | None = None
    parameters: Mapping[str, bool] = {}


RIDES = {
    "scooter": Ride("scooter", "fig8", 400.0),
    "lane_keeping": Ride("lane_keeping", "step", 400.0),
    "multi_drive, dq motors": Ride(
        "multi_drive", "curve_and_slope", parameters={"left_drive.ideal": False, "right_drive.ideal": False}
    ),
    "braking": Ride("braking", "known_speed"),
}


class Cost(NamedTuple):
    """Variables that are recorded, the step [s], and the least time of one [µs]."""

    recorded: int
    step: float
    microseconds: float

    @property
    def speed(self) -> float:
        """How many times as fast as real time it is."""
        return 1e6 * self.step / self.microseconds


def main() -> None:
    """Measure and print, and keep what was measured in the docs if asked."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.systems", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("names", nargs="*", help=f"systems (default: {', '.join(RIDES)})")
    parser.add_argument("--rounds", type=int, default=20, help="how often each is measured (default: 20)")
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put the table into it: docs/performance.md"
    )
    arguments = parser.parse_args()
    names: Sequence[str] = arguments.names or list(RIDES)
    found: dict[str, Cost] = {}
    for _ in range(arguments.rounds):
        for name in names:
            now = measured(RIDES[name])
            found[name] = min(found.get(name, now), now, key=lambda cost: cost.microseconds)
    text = report(found)
    print(text)
    if arguments.write is not None:
        page.put(arguments.write, "systems", text)


def measured(ride: Ride) -> Cost:
    """Return what a step costs in a run of its own, in this process."""
    options = RunOptions(units="native", engine="compiled", parameters=ride.parameters)
    if ride.stop_time is not None:
        options["stop_time"] = ride.stop_time
    with as_in_a_long_run(), Simulation(ride.system, ride.scenario, **options) as simulation:
        simulation.step(1)  # what is made in the first step is no cost of a step
        steps, begin = simulation.steps_left, time.thread_time()
        simulation.run()
        seconds = time.thread_time() - begin
        plan = simulation.plan
        return Cost(len(plan.columns), plan.experiment.step_size, 1e6 * seconds / steps)


def report(found: Mapping[str, Cost]) -> str:
    """Return the table."""
    header = ["system", "recorded", "µs a step", "times real time"]
    rows = [
        [name, str(cost.recorded), page.short(cost.microseconds), f"{cost.speed:,.0f}"]
        for name, cost in found.items()
    ]
    return f"Measured on: {machine.about()}.\n\n{page.table(header, rows)}"


if __name__ == "__main__":
    main()
