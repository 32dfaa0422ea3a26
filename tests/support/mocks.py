"""Units written in Python, and systems of them: the algorithms need no FMU."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evcosim.cosim.interface import UnitInterface, Value, VariableInfo
from evcosim.cosim.plan.plan import Plan
from evcosim.cosim.plan.resolve import participating, resolve
from evcosim.cosim.plan.unit_plan import FmuSteps, SlotGroup, UnitPlan
from evcosim.cosim.system.scenario import Scenario, ScenarioFile
from evcosim.cosim.system.system import System, SystemFile
from evcosim.master.engine.initialization import initialize
from evcosim.master.engine.python_engine import PythonEngine
from evcosim.master.unit import NO_VALUES

Values = dict[str, Any]


def real(name: str, causality: str, **more: Any) -> VariableInfo:
    """A Real variable; an input starts at 0 unless it says otherwise."""
    if causality == "input":
        more.setdefault("start", 0.0)
    return VariableInfo(name, "Real", causality, **more)


def _as_ours(v: VariableInfo) -> VariableInfo:
    """The variable as an FMU of evcosim's declares it: a discrete output is a sampled one."""
    sampled = v.causality in ("output", "local") and v.variability != "continuous"
    return dataclasses.replace(v, sampled=v.sampled or sampled)


class MockUnit:
    """A unit whose behavior is functions of its values by name.

    `step(values, time, step_size)` changes values in place, and so does `through(values)`, which computes the
    outputs that feed through. `calls` counts the steps; `log` notes what was called.
    """

    def __init__(
        self,
        name: str,
        variables: list[VariableInfo],
        step: Callable[[Values, float, float], None] = lambda values, time, step_size: None,
        through: Callable[[Values], None] = lambda values: None,
        **start: float,
    ) -> None:
        self.name = name
        shown = [_as_ours(v) for v in variables]
        self.interface = UnitInterface(f"mock {name}", {v.name: v for v in shown}, tells_sampled=True)
        self.values: Values = {v.name: v.start if v.start is not None else 0.0 for v in variables} | start
        self._step, self._through = step, through
        self.steps: list[tuple[float, float]] = []
        self.log: list[str] = []
        self.apart = False
        self.asked_end: float | None = None
        self.warnings = 0
        self.warned: dict[str, int] = {}

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        self.memory, self.groups = memory, plan.groups

    def enter_initialization(
        self,
        start_time: float,
        stop_time: float | None,
        values: Mapping[str, Value] = NO_VALUES,
        inputs: Mapping[str, Value] = NO_VALUES,
    ) -> str:
        self.values |= dict(values) | dict(inputs)
        self.log.append("enter")
        return ""

    def exit_initialization(self) -> None:
        self._through(self.values)
        self.log.append("exit")

    def get(self, name: str) -> Value:
        self._through(self.values)
        return self.values[name]

    def set(self, name: str, value: Value) -> None:
        self.values[name] = value

    def set_inputs(self) -> None:
        for group, i, slot in self._slots("input"):
            self.values[group.names[i]] = self.memory[slot]

    def get_feedthrough(self) -> None:
        self._through(self.values)
        for group in self.groups:
            for i in range(group.feedthrough):
                self.memory[group.slot + i] = self.memory[group.latest + i] = self.values[group.names[i]]

    def start_step(self, steps: FmuSteps) -> None:
        for time, step_size in steps.each():
            self.steps.append((time, step_size))
            self._step(self.values, time, step_size)
            self._through(self.values)

    def finish_step(self) -> None:
        pass

    def get_outputs(self) -> None:
        for kind in ("sampled", "continuous"):
            for group, i, slot in self._slots(kind):
                self.memory[slot] = self.values[group.names[i]]

    def _slots(self, kind: str) -> list[tuple[SlotGroup, int, int]]:
        return [
            (b, i, (b.latest if kind == "continuous" else b.slot) + i)
            for b in self.groups
            if b.kind == kind
            for i in range(len(b.variables))
        ]

    def terminate(self) -> None:
        self.log.append("terminate")

    def free(self) -> None:
        self.log.append("free")


def plan_of(
    units: list[MockUnit],
    system: Mapping[str, Any],
    scenario: Mapping[str, Any] | None = None,
    **options: Any,
) -> Plan:
    """The plan of a system of mocks; `system` and `scenario` are what would stand in the files."""
    content = {"name": "mocks", "units": {u.name: {"fmu": "mock"} for u in units}}
    for key, value in system.items():
        if key == "units":
            for name, entry in value.items():
                content["units"][name] |= entry  # type: ignore[index] # a nested literal
        else:
            content[key] = value
    file = SystemFile.model_validate(content)
    described = System(Path("mocks.toml"), file)
    driven = Scenario("test", Path("test.toml"), ScenarioFile.model_validate(scenario or {}))
    taking_part = participating(described, driven)
    return resolve(described, driven, {u.name: u.interface for u in units if u.name in taking_part}, options)


def started(units: list[MockUnit], plan: Plan) -> PythonEngine:
    """An engine of mocks, initialized and ready for its first step."""
    by_name = {u.name: u for u in units}
    engine = PythonEngine(plan, by_name)
    initialize(by_name, plan)
    engine.start()
    return engine


def column(engine: PythonEngine, name: str) -> NDArray[np.float64]:
    """The recorded values of a variable, one for each step done and one for now."""
    return engine.recorded().column([c.name for c in engine.plan.columns].index(name))


def clock(name: str = "clock") -> MockUnit:
    """Shows the end of its last step: t after stepping to t."""

    def step(values: Values, time: float, step_size: float) -> None:
        values["t"] = round(time + step_size, 9)

    return MockUnit(name, [real("t", "output")], step)


def probe(name: str = "probe", **more: float) -> MockUnit:
    """Notes what it receives."""

    def step(values: Values, time: float, step_size: float) -> None:
        values["seen"] = values["t"]

    variables = [real("t", "input"), real("seen", "output", variability="discrete")]
    return MockUnit(name, variables, step, **more)


TICK = [{"from": "clock.t", "to": ["probe.t"]}]
"""The connection from the clock to the probe."""
