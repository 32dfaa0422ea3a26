"""What FMI costs a model of this project: python -m benchmarks.slaves, from the project's folder.

For every built-in FMU, in turn and several rounds over, the least time of a communication step:

    model   the Python model in a loop: a record of inputs, `step`, `outputs`
    floor   the FMI calls alone: a slave of pythonfmu with the same numbers of values, which computes nothing
    FMU     set all inputs, do the step, get all outputs

The calls come from a loop in C that holds Python's lock, as those of the compiled engine do. `over` is what
is neither floor nor model, `ratio` = FMU / (model + floor). Needs a C compiler.
"""

from __future__ import annotations

import argparse
import ctypes
import dataclasses
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi2 import FMU2Slave

from evcosim.fmus.build import built, names
from evcosim.fmus.catalog import CATALOG
from evcosim.fmus.interface import Exposed, exposed
from evcosim.models.base import Model

from . import machine, page
from .case import STEP_SIZE
from .fmus import c_library

DRIVEN = {"throttle": 40.0, "throttle_request": 40.0, "steering_angle": 0.02, "speed_bound": 30.0}
"""Inputs that make a model work; any other one has a third of its nominal value."""

_COUNTED = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int}

_EMPTY = '''\
"""A slave that computes nothing."""

import ctypes

from {identity}.evcosim.fmus.repairs import settle_at_exit
from {identity}.pythonfmu.fmi2slave import Fmi2Slave

ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))


class Empty(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        settle_at_exit(self.resources, "{name}")

    def do_step(self, time, step_size):
        return True

    def set_real(self, references, values):
        pass

    def set_integer(self, references, values):
        pass

    def set_boolean(self, references, values):
        pass

    def get_real(self, references, values=[0.0] * 100):
        return values

    def get_integer(self, references, values=[0] * 100):
        return values

    def get_boolean(self, references, values=[False] * 100):
        return values
'''


class Call(ctypes.Structure):
    """One call of fmi2Set or fmi2Get; `struct call` of sources/slave.c."""

    _fields_ = [
        ("function", ctypes.c_void_p),
        ("references", ctypes.POINTER(ctypes.c_uint)),
        ("count", ctypes.c_size_t),
        ("values", ctypes.c_void_p),
        ("stride", ctypes.c_size_t),
    ]


@dataclasses.dataclass
class Times:
    """Seconds a step, the least so far; how many values a step sets and gets."""

    values: int
    model: float = float("inf")
    floor: float = float("inf")
    fmu: float = float("inf")

    @property
    def over(self) -> float:
        """Seconds of the FMU that are neither its model's nor FMI's."""
        return self.fmu - self.floor - self.model

    @property
    def ratio(self) -> float:
        """How much longer the FMU takes than its model and the calls of FMI."""
        return self.fmu / (self.model + self.floor)


def main() -> None:
    """Measure and print, and keep what was measured in the docs if asked."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.slaves", description=(__doc__ or "").split("\n\n")[0]
    )
    parser.add_argument("names", nargs="*", help="FMUs to measure (default: all that are built in)")
    parser.add_argument("--rounds", type=int, default=40, help="how often each is measured (default: 40)")
    parser.add_argument("--steps", type=int, default=200, help="steps of a round (default: 200)")
    parser.add_argument(
        "--write", type=Path, metavar="PAGE", help="put the table into it: docs/performance.md"
    )
    arguments = parser.parse_args()
    found = {}
    for name in arguments.names or names():
        found[name] = measured(name, arguments.rounds, arguments.steps)
        print(f"{name}: {found[name]}", file=sys.stderr, flush=True)
    text = report(found)
    print(text)
    if arguments.write is not None:
        page.put(arguments.write, "slaves", text)


def report(found: Mapping[str, Times]) -> str:
    """The table."""
    header = ["µs a step", "values", "model", "floor", "FMU", "over", "ratio"]
    rows = [
        [
            name,
            str(t.values),
            *(f"{1e6 * s:.2f}" for s in (t.model, t.floor, t.fmu, t.over)),
            f"{t.ratio:.2f}",
        ]
        for name, t in found.items()
    ]
    return f"Measured on: {machine.about()}.\n\n{page.table(header, rows)}"


def measured(name: str, rounds: int, steps: int) -> Times:
    """The times of a built-in FMU; every round starts from the same state."""
    model: type[Model] = getattr(import_module(f"evcosim.models.{CATALOG[name].module}"), name)
    variables = exposed(model)
    inputs = [e for e in variables if e.causality == "input"]
    outputs = [e for e in variables if e.causality == "output"]
    with tempfile.TemporaryDirectory() as scratch:
        unit, floor = Path(scratch) / name, Path(scratch) / f"{name}-floor"
        for folder in (unit, floor):
            with zipfile.ZipFile(built(name)) as archive:
                archive.extractall(folder)
        _empty(floor / "resources", name)
        loop = Loop(Path(scratch))
        work = [
            ("model", _model_loop(model, inputs)),
            ("floor", loop.of(started(floor), inputs, outputs)),
            ("fmu", loop.of(started(unit), inputs, outputs)),
        ]
        times = Times(len(inputs) + len(outputs))
        for _ in range(rounds):
            for which, run in work:
                setattr(times, which, min(getattr(times, which), run(steps) / steps))
    return times


def measured_files(name: str, files: Mapping[str, Path], rounds: int, steps: int) -> dict[str, float]:
    """Seconds of a step of each of some FMUs of a built-in model, by the names of the files."""
    variables = exposed(getattr(import_module(f"evcosim.models.{CATALOG[name].module}"), name))
    inputs = [e for e in variables if e.causality == "input"]
    outputs = [e for e in variables if e.causality == "output"]
    found = dict.fromkeys(files, float("inf"))
    with tempfile.TemporaryDirectory() as scratch:
        loop, runs = Loop(Path(scratch)), {}
        for kind, file in files.items():
            with zipfile.ZipFile(file) as archive:
                archive.extractall(Path(scratch) / kind)
            runs[kind] = loop.of(started(Path(scratch) / kind), inputs, outputs)
        for _ in range(rounds):
            for kind, run in runs.items():
                found[kind] = min(found[kind], run(steps) / steps)
    return found


Value = float | int | bool
Run = Callable[[int], float]
"""Does so many steps and returns the seconds that they took."""


def _value(e: Exposed) -> float:
    v = e.variable
    return DRIVEN.get(v.name, v.start if v.type != "Real" else 0.3 * (v.nominal or 1.0))


def _model_loop(model: type[Model], inputs: list[Exposed]) -> Run:
    p = model.Parameters()
    values = {e.variable.name: _value(e) for e in inputs}
    timed = next((e.variable.name for e in exposed(model) if e.causality == "independent"), None)
    start = model.initial(p, model.Inputs(**{e.variable.name: e.variable.start for e in inputs}))
    record, step, outputs, through = model.Inputs, model.step, model.outputs, model.feeds_through()
    given = list(values.values())
    if timed is not None:  # the time is the first input of those that have it
        assert next(iter(record.__dataclass_fields__)) == timed

    def run(steps: int) -> float:
        x, begin = start, time.perf_counter()
        for k in range(steps):
            u = record(*given) if timed is None else record(k * STEP_SIZE, *given)
            x = step(p, x, u, STEP_SIZE)
            outputs(p, x, u) if through else outputs(p, x)
        return time.perf_counter() - begin

    return run


def _empty(resources: Path, name: str) -> None:
    """Put the empty slave in the place of an FMU's own."""
    own = resources / "slavemodule.txt"
    identity = own.read_text().strip().removesuffix("_slave")
    (resources / f"{identity}_floor.py").write_text(_EMPTY.format(identity=identity, name=name))
    own.write_text(f"{identity}_floor\n")


def started(folder: Path, values: Mapping[Exposed, Value] = {}) -> FMU2Slave:
    """An instance of an unpacked FMU in step mode, with these parameters and start values."""
    description = fmpy.read_model_description(folder)
    unit = FMU2Slave(
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="it",
    )
    unit.instantiate()
    unit.setupExperiment()
    for e, value in values.items():
        getattr(unit, f"set{_kind(e)}")([e.reference], [value])
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    return unit


class Loop:
    """The loop of sources/slave.c."""

    def __init__(self, folder: Path) -> None:
        # a PyDLL keeps Python's lock
        self._drive = ctypes.PyDLL(str(c_library("slave.c", folder / "slave.so"))).drive

    def of(
        self,
        unit: FMU2Slave,
        inputs: list[Exposed],
        outputs: list[Exposed],
        step_size: float = STEP_SIZE,
        columns: Mapping[str, Sequence[Value]] | None = None,
    ) -> Run:
        """Run a unit, each time from the state in which it is now.

        `columns` are the values of all inputs by name, one for each step; else each has one value.
        """
        given = columns or {e.variable.name: [_value(e)] for e in inputs}
        sets, gets = _calls(unit, "Set", inputs, given), _calls(unit, "Get", outputs, {})
        state, component = unit.getFMUstate(), ctypes.c_void_p(unit.component)
        step = ctypes.cast(unit.dll.fmi2DoStep, ctypes.c_void_p)

        def run(steps: int) -> float:
            unit.setFMUstate(state)
            unit.doStep(0.0, step_size)  # what is computed once for all steps
            begin = time.perf_counter()
            status = self._drive(
                component, sets, ctypes.c_size_t(len(sets)), step, gets, ctypes.c_size_t(len(gets)),
                ctypes.c_size_t(steps), ctypes.c_double(step_size),
            )  # fmt: skip # as the parameters of `drive` stand
            seconds = time.perf_counter() - begin
            if status:
                raise RuntimeError(f"{unit.modelIdentifier}: a call returned status {status}")
            return seconds

        return run


def _calls(
    unit: FMU2Slave, direction: str, variables: list[Exposed], columns: Mapping[str, Sequence[Value]]
) -> Any:
    """The calls that set or get these variables, one for each FMI type, as an array of `Call`."""
    calls = []
    for kind, c_type in _COUNTED.items():
        of_kind = [e for e in variables if _kind(e) == kind]
        if of_kind:
            n = len(of_kind)
            rows = list(zip(*(columns[e.variable.name] for e in of_kind), strict=True)) if columns else []
            references = (ctypes.c_uint * n)(*(e.reference for e in of_kind))
            values = (c_type * (n * max(1, len(rows))))(*(c_type(x).value for row in rows for x in row))
            function = ctypes.cast(getattr(unit.dll, f"fmi2{direction}{kind}"), ctypes.c_void_p)
            stride = n * ctypes.sizeof(c_type) if len(rows) > 1 else 0
            calls.append(Call(function, references, n, ctypes.cast(values, ctypes.c_void_p), stride))
    return (Call * len(calls))(*calls)


def _kind(e: Exposed) -> str:
    return e.variable.type.replace("Enumeration", "Integer")


if __name__ == "__main__":
    main()
