"""The bench of a trial: one unit alone, driven over some seconds."""

from __future__ import annotations

import contextlib
import dataclasses
import time
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ....cosim.errors import RunError
from ....cosim.interface import UnitInterface, Value
from ....cosim.plan.unit_maps import End, unit_map
from ....cosim.row_store import Array
from ....cosim.swap.mapping import present
from ....cosim.system.can_log_spec import CanLogEntry
from ....cosim.system.scenario import Scenario, ScenarioFile, StimulusEntry
from ....cosim.system.system import Isolation, System, SystemFile, UnitEntry
from ....cosim.units.measure import Affine
from ...builtin import fmu_file
from ...fmi.fmu import read_fmu
from ...simulation import Simulation
from ...warned import WarningKinds

InputCourses = Mapping[str, Sequence[tuple[float, float]]]
"""The points (time [s] from the start, value) of each input, in the units of measure of the system."""


class OutOfTime(RunError):
    """The time limit of a trial has passed."""


@dataclasses.dataclass(frozen=True)
class Deadline:
    """The end of a trial [s], on the monotonic clock; `answer` [s] is the longest time of a unit's call."""

    end: float
    answer: float

    def check(self) -> None:
        """Raise OutOfTime after the end."""
        if time.monotonic() > self.end:
            raise OutOfTime("the time limit of the trial has passed")


class Bench:
    """A unit's entry of a system, to be run alone.

    `outputs` are recorded, in the units of measure of `ours`, the interface of the unit that is in the system
    now; `ours` is None for that unit itself. Texts are neither moved nor looked at. A run is `duration` [s]
    long, rounded to steps. `warnings` counts those of all runs, and `kinds` has the first kinds of them.
    """

    def __init__(
        self,
        system: System,
        scenario: Scenario,
        unit: str,
        entry: UnitEntry,
        ours: UnitInterface | None,
        outputs: Sequence[str],
        duration: float,
    ) -> None:
        self.system, self.unit, self.entry = system, unit, entry
        self.fmu = read_fmu(fmu_file(entry.fmu, system.path, f"{system.keys_of(unit)}fmu"), entry.strict)
        self.interface = present(self.fmu.interface, entry, system.keys_of(unit))
        self.ours = ours or self.interface
        self.isolation: Isolation | None = None if ours is None else "process"
        numbers = {v.name for v in self.interface.variables.values() if v.type != "String"}
        self.outputs = [name for name in outputs if name in numbers]
        self.inputs = [v.name for v in self.interface.of_causality("input") if v.name in numbers]
        changes = scenario.file.experiment
        self.step_size = changes.step_size or system.file.experiment.step_size
        self.start = system.file.experiment.start_time
        self.duration = max(1, round(duration / self.step_size)) * self.step_size
        self.warnings = 0
        self.kinds = WarningKinds()
        self._scenario = scenario

    @property
    def period(self) -> float:
        """The period of the unit [s]."""
        return self.entry.period or self.step_size

    @contextlib.contextmanager
    def loaded(
        self,
        drive: InputCourses,
        deadline: Deadline,
        substeps: int | None = None,
        longer: int = 0,
    ) -> Iterator[Simulation]:
        """Yield a simulation of the unit alone, ready to step. Raises ConfigError, RunError.

        The unit is told the end of the duration as its stop time, as in a run, or that of so many periods
        more; it must not be stepped beyond it.
        """
        deadline.check()
        timeout = max(0.1, min(self.entry.step_timeout, deadline.answer, deadline.end - time.monotonic()))
        # by itself, whatever a file says: an FMU of another tool has a process of its own, and starts at once
        update: dict[str, object] = {"isolation": None, "offset": None, "step_timeout": timeout}
        entry = self.entry.model_copy(update=update | {"substeps": substeps or self.entry.substeps})
        system, scenario = self._alone(entry, longer), self._driven(drive)
        with Simulation(system, scenario, isolation=self.isolation, to_stop=True) as simulation:
            try:
                yield simulation
            finally:
                self._note_warnings(simulation)

    def run(self, drive: InputCourses, deadline: Deadline, substeps: int | None = None) -> dict[str, Array]:
        """Return the outputs over the duration, each of shape (steps + 1,). Raises ConfigError, RunError."""
        with self.loaded(drive, deadline, substeps) as simulation:
            deadline.check()
            simulation.run(lambda *_: deadline.check())
            if simulation.ended:
                raise RunError(f"{simulation.ended}, before the end of the trial")
            results = simulation.results
        columns = {}
        for name in self.outputs:
            map_ = self.to_ours(name)
            columns[name] = map_.scale * results[f"{self.unit}.{name}"] + map_.offset
        return columns

    def _note_warnings(self, simulation: Simulation) -> None:
        for unit in simulation.units.values():
            self.warnings += unit.warnings
            for text, count in unit.warned.items():
                self.kinds.add(text, count)

    def to_ours(self, name: str) -> Affine:
        """Return the map from a variable's own unit of measure to that in the present unit's interface."""
        return _between(self.interface, self.ours, name)

    def from_ours(self, name: str) -> Affine:
        """Return the inverse map, from the unit of measure in the present unit's interface."""
        return _between(self.ours, self.interface, name)

    def _alone(self, entry: UnitEntry, longer: int) -> System:
        """Return a system of this unit only, whose runs last so many periods longer than the duration."""
        stop_time = self.start + self.duration + longer * self.period
        experiment = self.system.file.experiment.model_copy(
            update={"stop_time": stop_time, "step_size": self.step_size}
        )
        file = SystemFile(
            name=self.system.file.name,
            experiment=experiment,
            units={self.unit: entry},
            record=[f"{self.unit}.{name}" for name in self.outputs],
        )
        return System(self.system.path, file)

    def _fitting(self, name: str, value: float) -> float:
        """Return the value that an input of its type can have."""
        return value if self.interface.variables[name].type == "Real" else float(round(value))

    def _driven(self, drive: InputCourses) -> Scenario:
        """Return a scenario that drives the inputs, with the unit's own parameters and starts."""
        stimuli: list[StimulusEntry | CanLogEntry] = [
            StimulusEntry(
                to=f"{self.unit}.{name}",
                unit=self.ours.variables[name].unit or None,
                table=[(self.start + t, self._fitting(name, value)) for t, value in points],
            )
            for name, points in drive.items()
            if name in self.inputs
        ]
        given, known = self._scenario.file, self.interface.variables
        return Scenario(
            "trial",
            None,
            ScenarioFile(
                stimulus=stimuli,
                parameters={self.unit: _of(given.parameters.get(self.unit, {}), known)},
                start={self.unit: _of(given.start.get(self.unit, {}), known)},
            ),
        )


def _between(source: UnitInterface, target: UnitInterface, name: str) -> Affine:
    """Return the map between the units of measure of a variable in two interfaces; 1 if either has none."""
    ends = []
    for interface in (source, target):
        v = interface.variables[name]
        ends.append(End(name, v.unit, interface.units_of_measure, v.difference))
    return unit_map(ends[0], ends[1], (), interface.place, [])


def _of(values: Mapping[str, Value], known: Mapping[str, object]) -> dict[str, Value]:
    return {name: value for name, value in values.items() if name in known}


def largest(values: Array) -> float:
    """Return the largest magnitude of an array, shape (n,); 0.0 for an empty one."""
    return float(np.max(np.abs(values))) if len(values) else 0.0
