"""What a step of a native FMU costs: python -m benchmarks.native, from the project's folder.

For every built-in model, in turn and several rounds over, the least time of setting all inputs, a step, and
getting all outputs, called by a loop in C:

    rest     the start values are held
    motion   what a unit of it receives in a run of a built-in system, step by step
    calls    how often a step in motion calls the C library's mathematics: exp, sin, pow, floor ...
    library  these calls alone, with the same arguments, one function after the other: a bound from below
    Python   the FMU in Python, in motion

`share` is that of the library in the time of a step. Needs a C compiler.
"""

from __future__ import annotations

import argparse
import ctypes
import dataclasses
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from evcosim import Simulation
from evcosim.fmus.build import built, names
from evcosim.fmus.catalog import CATALOG
from evcosim.fmus.interface import Exposed, exposed
from evcosim.fmus.native.build import native_built
from evcosim.fmus.native.toolchain import EXACT

from . import machine, page
from .fmus import SOURCES, compile_c
from .slaves import Loop, Value, started


class Ride(NamedTuple):
    """A unit in a run of a built-in system: `steps` of its own, beginning at the start of the run."""

    system: str
    scenario: str
    unit: str
    steps: int = 2000
    fmus: Mapping[str, str] = {}
    parameters: Mapping[str, Value] = {}


_DQ = {"left_drive.ideal": False, "right_drive.ideal": False}
RIDES = {
    "Scooter": Ride("scooter", "ece15", "vehicle", 8000),
    "BoundController": Ride("scooter", "fig8", "ecu", 4000),
    "BoundPlanner": Ride("scooter", "fig9", "planner", 4000),
    "Rider": Ride("scooter", "ece15", "rider", 8000),
    "Battery": Ride("scooter", "ece15", "battery", 8000),
    "LateralVehicle": Ride("lane_keeping", "step", "vehicle", 500),
    "LaneKeepingController": Ride("lane_keeping", "step", "controller", 500),
    "TwoMotorVehicle": Ride("multi_drive", "curve_and_slope", "vehicle", 500),
    "InductionMotorDrive": Ride("multi_drive", "curve_and_slope", "left_drive", 500, parameters=_DQ),
    "Inverter": Ride("multi_drive", "battery", "inverter", 500),
    "ElectronicDifferential": Ride("multi_drive", "curve_and_slope", "differential", 500),
    "WheelSpeedController": Ride("multi_drive", "curve_and_slope", "controller", 500),
    "TwoWheelerBraking": Ride("braking", "known_speed", "vehicle", 400),
    "DetailedTwoWheeler": Ride(
        "braking", "known_speed", "vehicle", 400, fmus={"vehicle": "DetailedTwoWheeler"}
    ),
    "SlipController": Ride("braking", "known_speed", "controller", 400),
    "WheelSpeedEstimator": Ride("braking", "estimated_speed", "estimator", 400),
    "BrakeActuator": Ride("braking", "known_speed", "front_brake", 400),
}
"""A ride for each built-in model."""


class Received(NamedTuple):
    """What a unit received: its step [s], its parameters and start values, and each input at each step."""

    step_size: float
    values: Mapping[str, Value]
    inputs: Mapping[str, list[Value]]

    @property
    def steps(self) -> int:
        """The number of its steps."""
        return min(map(len, self.inputs.values()))


@dataclasses.dataclass
class Costs:
    """Seconds a step, the least so far, and the number of calls of the mathematical library a step."""

    rest: float = float("inf")
    motion: float = float("inf")
    library: float = float("inf")
    python: float = float("inf")
    calls: float = 0.0


def main() -> None:
    """Measure and print, and keep what was measured in the docs if asked."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.native", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("names", nargs="*", help="models to measure (default: all that are built in)")
    parser.add_argument("--rounds", type=int, default=40, help="how often each is measured (default: 40)")
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put the table into it: docs/performance.md"
    )
    arguments = parser.parse_args()
    found = {}
    for name in arguments.names or names():
        found[name] = measured(name, RIDES[name], arguments.rounds)
        print(f"{name}: {found[name]}", file=sys.stderr, flush=True)
    text = report(found)
    print(text)
    if arguments.write is not None:
        page.put(arguments.write, "native units", text)


def report(found: Mapping[str, Costs]) -> str:
    """The table."""
    header = ["µs a step", "rest", "motion", "library", "calls", "share", "Python", "ratio"]
    rows = [
        [
            name,
            *(page.short(1e6 * s) for s in (c.rest, c.motion, c.library)),
            f"{c.calls:.3g}",
            f"{100.0 * c.library / c.motion:.0f} %",
            page.short(1e6 * c.python),
            f"{c.python / c.motion:.0f}",
        ]
        for name, c in found.items()
    ]
    return f"Measured on: {machine.about()}.\n\n{page.table(header, rows)}"


# -- what a unit receives ------------------------------------------------------------------------------------


def received(model: str, ride: Ride) -> Received:
    """Run a system, and return what a unit receives in it."""
    kinds = {e.variable.name: e.variable.type for e in _variables(model) if e.causality == "input"}
    options: dict[str, Any] = {"fmus": dict(ride.fmus), "parameters": dict(ride.parameters)}
    with Simulation(ride.system, ride.scenario, units="native", to_stop=True, **options) as sim:
        about = sim.manifest()["units"][ride.unit]
        columns: dict[str, list[Value]] = {name: [] for name in kinds}
        due = 0.0
        while not sim.finished and due < (ride.steps - 0.5) * about["period"]:
            if sim.time >= due - 1e-9:
                for name, kind in kinds.items():
                    value = sim[f"{ride.unit}.{name}"]
                    columns[name].append(value if kind == "Real" else int(value))
                due += about["period"]
            sim.step()
    return Received(about["period"], {**about["parameters"], **about["start"]}, columns)


def _variables(model: str) -> list[Exposed]:
    return exposed(getattr(import_module(f"evcosim.models.{CATALOG[model].module}"), model))


def at_rest(given: Received, model: str) -> Received:
    """Return the same steps with the start values held."""
    start = {e.variable.name: e.variable.start for e in _variables(model)}
    return given._replace(inputs={name: [start[name]] * given.steps for name in given.inputs})


# -- measurement ---------------------------------------------------------------------------------------------

Run = Callable[[], float]
"""Does the steps of a ride once, and returns the seconds of a step."""


def measured(name: str, ride: Ride, rounds: int) -> Costs:
    """The costs of a built-in model; every round starts from the same state."""
    costs, ridden = Costs(), received(name, ride)
    held = at_rest(ridden, name)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        native, python, counting = folder / "native", folder / "python", folder / "counting"
        for place, file in (
            (native, native_built(name)),
            (python, built(name)),
            (counting, native_built(name)),
        ):
            with zipfile.ZipFile(file) as archive:
                archive.extractall(place)
        loop = Loop(folder)
        library = _count_calls(counting, name)
        run = _steps_of(loop, name, counting, ridden)
        library.forget_calls()
        run()
        costs.calls = library.kept_calls() / ridden.steps
        work = [
            ("rest", _steps_of(loop, name, native, held)),
            ("motion", _steps_of(loop, name, native, ridden)),
            ("library", lambda: _timed(library.repeat_calls) / ridden.steps if costs.calls else 0.0),
            ("python", _steps_of(loop, name, python, ridden)),
        ]
        for k in range(rounds):
            for which, run in work if k % 4 == 0 else work[:-1]:  # Python takes long
                setattr(costs, which, min(getattr(costs, which), run()))
    return costs


def _timed(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def _steps_of(loop: Loop, name: str, folder: Path, given: Received) -> Run:
    """Return what runs an unpacked FMU with the inputs that its unit received."""
    variables = _variables(name)
    values = {e: given.values[e.variable.name] for e in variables if e.variable.name in given.values}
    inputs = [e for e in variables if e.causality == "input"]
    outputs = [e for e in variables if e.causality == "output"]
    run = loop.of(started(folder, values), inputs, outputs, given.step_size, given.inputs)
    return lambda: run(given.steps) / given.steps


def _count_calls(folder: Path, name: str) -> ctypes.CDLL:
    """Compile an unpacked native FMU anew, so that it keeps its calls of the library, and return it."""
    sources = folder / "sources"
    (library,) = (folder / "binaries").glob(f"*/{name}.*")
    flags = ["-O2", "-fPIC", "-shared", "-fvisibility=hidden", *EXACT, "-include", str(SOURCES / "counted.h")]
    files = [*map(str, sorted(sources.glob("*.c"))), str(SOURCES / "counted.c")]
    compile_c([*flags, *files, "-o", str(library), "-lm"])
    counting = ctypes.CDLL(str(library))
    counting.kept_calls.restype = ctypes.c_size_t
    counting.repeat_calls.restype = ctypes.c_double
    return counting


if __name__ == "__main__":
    main()
