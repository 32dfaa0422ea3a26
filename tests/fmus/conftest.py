"""FMUs under test: every one of the catalog and a toy, and a small importer on FMPy."""

from __future__ import annotations

import dataclasses
import math
import random
import struct
import sys
from collections.abc import Callable, Iterator, Mapping
from ctypes import byref
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.logging import addLoggerProxy

from evcosim.fmus.build import build, build_model, names
from evcosim.fmus.catalog import CATALOG
from evcosim.models.base import Model, Variable, variables
from support.importing import in_an_importer as in_an_importer

TOYS = Path(__file__).parent / "toys"
STEP = 0.01
LOG: list[tuple[int, str, str]] = []  # (status, category, message) of all instances


class Subject(NamedTuple):
    """An FMU and the model that it was built from."""

    name: str
    model: type[Model]
    path: Path


class Importer:
    """One instance of an FMU: values by name, log messages kept."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.description = fmpy.read_model_description(path)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.inputs = [v.name for v in self.description.modelVariables if v.causality == "input"]
        self.outputs = [v.name for v in self.description.modelVariables if v.causality == "output"]
        self.log = LOG
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._note)
        self.callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self.callbacks.freeMemory = defaultCallbacks.freeMemory
        addLoggerProxy(byref(self.callbacks))  # formats messages as printf does; one logger a process
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="it",
        )
        self.fmu.instantiate(callbacks=self.callbacks, loggingOn=True)

    def _note(self, _: Any, instance: bytes, status: int, category: bytes | None, message: bytes) -> None:
        self.log.append((status, (category or b"").decode(), message.decode()))

    def set(self, values: Mapping[str, Any]) -> None:
        """Set each variable by the function of its type."""
        for name, value in values.items():
            v = self.variables[name]
            kind = "Integer" if v.type == "Enumeration" else v.type
            getattr(self.fmu, f"set{kind}")([v.valueReference], [value])

    def get(self, *wanted: str) -> dict[str, Any]:
        """Values by name; all outputs if none is named."""
        found = {}
        for name in wanted or self.outputs:
            v = self.variables[name]
            kind = "Integer" if v.type == "Enumeration" else v.type
            found[name] = getattr(self.fmu, f"get{kind}")([v.valueReference])[0]
        return found

    def initialize(self, values: Mapping[str, Any] | None = None, start: float = 0.0) -> None:
        """From instantiated to step mode."""
        self.fmu.setupExperiment(startTime=start)
        self.set(values or {})
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def run(self, inputs: list[dict[str, Any]], start: int = 0) -> list[dict[str, Any]]:
        """Outputs after each step; step k begins at (start + k) * STEP."""
        trace = []
        for k, values in enumerate(inputs):
            self.set(values)
            self.fmu.doStep((start + k) * STEP, STEP)
            trace.append(self.get())
        return trace


@pytest.fixture(scope="session")
def toys() -> Iterator[None]:
    """The toys can be imported by name, as a user's own modules can."""
    sys.path.insert(0, str(TOYS))
    yield
    sys.path.remove(str(TOYS))


@pytest.fixture(scope="session")
def fmu_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where FMUs are built."""
    return tmp_path_factory.mktemp("fmus")


@pytest.fixture(scope="session", params=[*names(), "Mixed"])
def subject(request: pytest.FixtureRequest, toys: None, fmu_folder: Path) -> Subject:
    """Every FMU of the catalog, and the toy with all types."""
    name = request.param
    if name == "Mixed":
        model = import_module("mixed").Mixed
        return Subject(name, model, build_model(model, fmu_folder))
    module = import_module(f"evcosim.models.{CATALOG[name].module}")
    return Subject(name, getattr(module, name), build(name, fmu_folder))


@pytest.fixture(scope="session")
def toy(toys: None, fmu_folder: Path) -> Callable[[str], Subject]:
    """Build a toy by the name of its class."""

    def make(name: str) -> Subject:
        model = getattr(import_module(name.lower()), name)
        return Subject(name, model, build_model(model, fmu_folder))

    return make


@pytest.fixture
def load(tmp_path: Path) -> Iterator[Callable[[Path], Importer]]:
    """Instantiate FMUs; they are freed at the end."""
    loaded: list[Importer] = []

    def one(path: Path) -> Importer:
        folder = tmp_path / f"unpacked{len(loaded)}"
        fmpy.extract(path, folder)
        loaded.append(Importer(path, folder))
        return loaded[-1]

    yield one
    for unit in loaded:
        unit.fmu.freeInstance()


def _random_value(v: Variable, generator: random.Random) -> Any:
    if v.enumeration is not None:
        return generator.choice(list(v.enumeration))
    if v.type == "Boolean":
        return generator.random() < 0.5
    if v.type == "Integer":
        return generator.randint(int(v.min or 0), int(v.max or 5))
    if v.min is not None and v.max is not None:
        return generator.uniform(v.min, v.max)
    scale = max(abs(v.start), v.nominal or 10.0)
    value = v.start + scale * generator.gauss(0.0, 1.0)
    return max(value, v.min) if v.min is not None else value


@pytest.fixture
def random_inputs() -> Callable[..., list[dict[str, Any]]]:
    """Some steps' inputs of a model, from a seed; not all inputs change in every step."""

    def make(model: type[Model], steps: int, seed: int) -> list[dict[str, Any]]:
        generator = random.Random(seed)
        declared = [v for v in variables(model.Inputs) if not v.independent]
        return [
            {v.name: _random_value(v, generator) for v in declared if generator.random() < 0.7}
            for _ in range(steps)
        ]

    return make


@pytest.fixture
def random_parameters() -> Callable[[type[Model], int], dict[str, Any]]:
    """Parameters of a model near their defaults, within their ranges."""

    def make(model: type[Model], seed: int) -> dict[str, Any]:
        generator = random.Random(seed)
        chosen = {}
        for v in variables(model.Parameters):
            if v.type == "Real":
                value = v.start * generator.uniform(0.95, 1.05)
                value = max(v.min if v.min is not None else -math.inf, value)
                chosen[v.name] = min(v.max if v.max is not None else math.inf, value)
            else:
                chosen[v.name] = _random_value(v, generator)
        return chosen

    return make


class Plain:
    """The same model stepped in Python: what an FMU must equal bit for bit."""

    def __init__(self, model: type[Model], values: Mapping[str, Any], start: float = 0.0) -> None:
        self.model = model
        self.p = model.Parameters(
            **{v.name: values.get(v.name, v.start) for v in variables(model.Parameters)}
        )
        self.held = {v.name: values.get(v.name, v.start) for v in variables(model.Inputs)}
        self.time = next((v.name for v in variables(model.Inputs) if v.independent), None)
        self.x = model.initial(self.p, self.inputs(start))
        self.now = start

    def inputs(self, time: float) -> Any:
        """The record of the held inputs at a time."""
        return self.model.Inputs(**(self.held | ({self.time: time} if self.time else {})))

    def outputs(self) -> dict[str, Any]:
        """The outputs now."""
        args = (self.inputs(self.now),) if self.model.feeds_through() else ()
        return dataclasses.asdict(self.model.outputs(self.p, self.x, *args))

    def run(self, inputs: list[dict[str, Any]], start: int = 0) -> list[dict[str, Any]]:
        """Outputs after each step."""
        trace = []
        for k, values in enumerate(inputs):
            self.held |= values
            t = (start + k) * STEP
            self.x = self.model.step(self.p, self.x, self.inputs(t), STEP)
            self.now = t if self.model.sampled else t + STEP
            trace.append(self.outputs())
        return trace


@pytest.fixture
def plain() -> type[Plain]:
    """Stepping a model without FMI."""
    return Plain


@pytest.fixture
def bits() -> Callable[[Any], Any]:
    """Traces as comparable bits: equal only if no bit differs."""

    def one(value: Any) -> Any:
        if isinstance(value, list):
            return [one(item) for item in value]
        if isinstance(value, dict):
            return {name: one(item) for name, item in value.items()}
        return struct.pack("<d", float(value))

    return one
