"""The Python interface: a run of a system as a whole, or step by step.

results = simulate("scooter", scenario="fig8", parameters={"vehicle.mass": 180.0})

with Simulation("scooter") as sim:
    while sim.time < 10.0:
        sim.step(100)
        if sim["vehicle.speed"] > 5.0:
            sim.set("vehicle.road_grade", 0.05)
    results = sim.results
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Unpack

from ..cosim.can.logs.frames import BusLog
from ..cosim.can.logs.writing import write_can_log
from ..cosim.errors import ConfigError, RunError, nearest
from ..cosim.interface import Value
from ..cosim.plan.events import check_event, checked_course
from ..cosim.plan.plan import Plan
from ..cosim.plan.steps import check_steps, whole_steps
from ..cosim.plan.unit_plan import UnitPlan
from ..cosim.results.results import Results
from ..cosim.row_store import Array, Grid
from ..cosim.shortage import LINEAR_ALGEBRA, require_memory
from ..cosim.system.run_options import RunOptions
from ..cosim.system.scenario import Bias, Event, Override, Reset, Scenario, Set
from ..cosim.system.selection import figure_spec, metric_specs
from ..cosim.system.system import Isolation, System
from .engine.initialization import initialize
from .engine.plausibility import Extremes, implausible
from .engine.profile import Profile
from .engine.selection import engine_class
from .fmi.doubts import defects_of
from .fmi.fmu import reading_once
from .fmi.loading import load_unit
from .isolation.decision import chosen, process_limits
from .isolation.unit import IsolatedUnit
from .keeping import KeptRun, ended
from .manifest import manifest, saturations
from .prepare import check_decodable, check_frames, prepare
from .unit import Unit, terminate
from .warned import warnings_text

_LEAST = 150e6  # bytes of address space for the libraries that models may use
RunProgress = Callable[[float, float], None]
"""Called with the simulated time reached and the stop time, both in s."""


class Simulation:
    """A system with its FMUs loaded and initialized, ready to step; use it in a `with` block.

    `system` and `scenario` are built-in names, paths of TOML files, or made in memory; `log_frames` keeps the
    frames for `write_can_log`; `profile` measures the time of each part of a step. With `to_stop` the units
    are told the stop time, and no step goes beyond it; else they are told that there is none, and the
    simulation can be stepped on. The other keyword arguments are those of RunOptions.
    Raises ConfigError before any step for every input that does not fit.
    """

    @reading_once()
    def __init__(
        self,
        system: str | Path | System,
        scenario: str | Path | Scenario | None = None,
        *,
        log_frames: bool = False,
        profile: bool = False,
        to_stop: bool = False,
        **options: Unpack[RunOptions],
    ) -> None:
        require_memory(_LEAST, "a run", LINEAR_ALGEBRA)
        prepared = prepare(system, scenario, **options)
        engine = options.get("engine") or prepared.plan.experiment.engine
        made, self._notice = engine_class(engine, profile, bool(prepared.plan.framed_bus))
        self.system: System = prepared.system
        self.scenario: Scenario = prepared.scenario
        self.plan: Plan = prepared.plan if to_stop else prepared.plan.open_ended()
        self._prepared, self._fmus = prepared, prepared.fmus
        self._interfaces = {unit.name: unit.interface for unit in self.plan.units}
        if log_frames:
            check_frames(self.system)
        self.log_frames = log_frames
        self.loop_seconds = 0.0
        self._units: dict[str, Unit] = {}
        self._last_warnings: dict[str, tuple[int, dict[str, int]]] = {}
        self.isolation: dict[str, Isolation] = {}
        self._kept: KeptRun | None = None
        try:
            for unit in self.plan.units:
                self._units[unit.name] = self._load(unit, options.get("isolation"))
            self._engine = made(self.plan, self._units, log_raw=log_frames)
            self._engine.profile = Profile() if profile else None
            self._extremes = Extremes(len(self.plan.columns))
            self._notices = initialize(self._units, self.plan)
            self._engine.start()
        except BaseException:
            self._free()
            raise

    def _load(self, plan: UnitPlan, wanted: Isolation | None) -> Unit:
        fmu, entry = self._fmus[plan.name], self.system.file.units[plan.name]
        self.isolation[plan.name] = chosen(plan.name, fmu, entry, wanted)
        if self.isolation[plan.name] == "none":
            return load_unit(fmu, plan.name, plan.interface, entry.tolerance)
        return IsolatedUnit(fmu, plan.name, plan.interface, process_limits(entry), entry.tolerance)

    def keep_in(self, folder: str | os.PathLike[str]) -> None:
        """Let the run have a folder: from now on a row is on the disk within a second, in results.rows.

        `Results.read` reads that, even if the process is killed; `close` writes results.csv and run.json in
        its place. An earlier run of the same files, FMUs and settings is replaced. Raises ConfigError for a
        folder with other files of these names, that another run has, or that cannot be written; RunError
        where the rows of a long run up to now do not find room there.
        """
        if self._kept is not None:
            raise ConfigError(f"{folder}: the run has a folder already: {self._kept.folder.path}")
        self._kept = KeptRun(self._engine, self.plan, folder, self.manifest())

    # ---- a loop of one's own

    @property
    def units(self) -> Mapping[str, Unit]:
        """The loaded units by name; empty after the end."""
        return self._units

    @property
    def time(self) -> float:
        """The current communication point [s]."""
        return self._engine.time

    @property
    def finished(self) -> bool:
        """True once the stop time is reached, or a unit has ended the run.

        Without `to_stop`, stepping on beyond the stop time is allowed.
        """
        return not self.steps_left

    @property
    def ended(self) -> str:
        """A sentence on the unit that asked to end the simulation, and when; "" while none has."""
        return self._engine.ending.text

    @property
    def steps_left(self) -> int:
        """The number of communication steps left to the stop time, or to the end that a unit asked for."""
        return max(0, min(self.plan.steps, self._engine.ending.step) - self._engine.k)

    def step(self, steps: int = 1) -> None:
        """Do `steps` communication steps.

        They are fewer where a unit asks to end the simulation; after that a step is a RunError. Raises
        RunError naming unit, time and reason; the results up to then are kept. ConfigError for a number that
        is none of steps, for more than a run keeps rows of, and with `to_stop` for more than are left.
        """
        count = whole_steps(steps)
        if count and self._engine.k >= self._engine.ending.step:
            raise RunError(f"the run is over: {self.ended}")
        plan, columns = self.plan, len(self.plan.columns)
        check_steps(count, self._engine.k, self.steps_left, plan.clock, columns, plan.framed_bus)
        self._advance(count, None)

    def run(self, progress: RunProgress | None = None) -> None:
        """Step to the stop time. Raises as `step` does."""
        stop = self.plan.experiment.stop_time
        report = None if progress is None else lambda k: progress(self._engine.time_at(k), stop)
        self._advance(self.steps_left, report)

    def _advance(self, steps: int, progress: Callable[[int], None] | None) -> None:
        self._require_units()
        if not self._engine.whole:
            raise RunError("the run has failed or was interrupted and cannot go on")
        begin = time.perf_counter()
        try:
            self._engine.advance(steps, progress)
        finally:
            self.loop_seconds += time.perf_counter() - begin

    def _require_units(self) -> None:
        if not self._units:  # they were released: their machine code must not be called any more
            raise RunError("the simulation is closed and its units are released; its results stay")

    def __getitem__(self, name: str) -> float:
        """Return the value of a variable "unit.variable" at the current communication point, in its own unit.

        Raises ConfigError for an unknown name and for a String; RunError for a variable that is not recorded
        after the simulation was closed.
        """
        slot = self.plan.slots.get(name)
        if slot is not None:
            return float(self._engine.memory[slot])
        unit, variable = self._split(name)
        self._require_units()
        value = self._units[unit].get(variable)
        if isinstance(value, str):
            raise ConfigError(f"{name} is a String: text() returns it")
        return float(value)

    def text(self, name: str) -> str:
        """Return the value of a String "unit.variable". Raises as `[]` does; ConfigError for another type."""
        if name in self.plan.text_names:
            return self.plan.texts.text(self._engine.memory[self.plan.text_names[name]])
        unit, variable = self._split(name)
        self._require_units()
        value = self._units[unit].get(variable)
        if not isinstance(value, str):
            raise ConfigError(f"{name} is of type {self._interfaces[unit].variables[variable].type}")
        return value

    def set(self, name: str, value: Value) -> None:
        """Set an input that nothing drives, or a parameter that its FMU declares tunable, from now on.

        Raises ConfigError for any other variable, and for a value of the wrong type or out of range; RunError
        if the FMU refuses it, after which the run is over, and after the simulation was closed.
        """
        self._do(Set.model_construct(time=self.time, action="set", variable=name, value=value))

    def override(self, name: str, value: Value) -> None:
        """Let the input `name` receive `value` from now on, whatever drives it. Raises ConfigError."""
        self._do(Override.model_construct(time=self.time, action="override", variable=name, value=value))

    def follow(self, name: str, values: Sequence[float] | Array) -> None:
        """Let the Real input `name` receive `values`, one in each step from now on, as if by `override`.

        The last one stays. Raises ConfigError for another input, and unless `values` has the shape (n,).
        """
        self._require_units()
        self._engine.follow(name, checked_course(name, values, self._interfaces, self.plan.inputs))

    def bias(self, name: str, value: float) -> None:
        """Let the input `name` receive `value` more than what drives it, from now on. Raises ConfigError."""
        self._do(Bias.model_construct(time=self.time, action="bias", variable=name, value=value))

    def reset(self, name: str) -> None:
        """End the override or bias of the input `name`. Raises ConfigError if there is no such input."""
        self._do(Reset.model_construct(time=self.time, action="reset", variable=name))

    def _do(self, event: Event) -> None:
        """Check and do an event that no file has: the messages name the call instead of the keys."""
        self._require_units()
        plan = self.plan
        self._engine.effect(check_event(event, self._interfaces, plan.inputs, plan.texts, event.action))

    def _split(self, name: str) -> tuple[str, str]:
        unit, _, variable = name.partition(".")
        if unit not in self._fmus:
            raise ConfigError(f"{name}: there is no unit '{unit}'{nearest(unit, self._fmus)}")
        known = self._interfaces[unit].variables
        if variable not in known:
            raise ConfigError(f"{name}: unit '{unit}' has no variable '{variable}'{nearest(variable, known)}")
        return unit, variable

    @property
    def profile(self) -> list[dict[str, Any]]:
        """The parts of the steps so far, each with name, what, seconds, microseconds_per_step and share.

        [] unless the simulation was made with `profile`. Reading the clock takes time itself, some 0.03 us
        for each part and step.
        """
        if self._engine.profile is None:
            return []
        keys = ("name", "what", "seconds", "microseconds_per_step", "share")
        rows = self._engine.profile.rows(self.loop_seconds, self._engine.k)
        return [dict(zip(keys, row, strict=True)) for row in rows]

    @property
    def warnings(self) -> list[str]:
        """A sentence for everything suspicious: notices of the engine, defects of FMUs, missing units of
        measure, warnings of units, outputs beyond their limits."""
        from_units = [
            f"unit '{name}' gave {warnings_text(n, kinds)}"
            for name, (n, kinds) in self._unit_warnings().items()
            if n
        ]
        defects = [f"unit '{unit}': {text}" for unit, fmu in self._fmus.items() for text in defects_of(fmu)]
        kept = self._kept.notice if self._kept is not None else ""
        notices = [notice for notice in (self._notice, self._engine.notice, kept) if notice]
        beyond = implausible(self._extremes.of(self._engine.recorded()), self.plan)
        planned = (*self.plan.warnings, *self.plan.unreached)
        return [*notices, *defects, *planned, *self._notices, *from_units, *beyond]

    def _unit_warnings(self) -> dict[str, tuple[int, dict[str, int]]]:
        return self._last_warnings | {n: (u.warnings, dict(u.warned)) for n, u in self._units.items()}

    # ---- results

    @property
    def results(self) -> Results:
        """The rows recorded up to now, with the manifest of the run."""
        table = self._engine.recorded()
        return Results(
            time=Grid(self.plan.clock, table.shape[0]),
            variables=self.plan.columns,
            data=table,
            manifest=self.manifest(),
            figure=figure_spec(self.system, self.scenario),
            metrics=metric_specs(self.system, self.scenario),
            texts=self._engine.text_notes.table(self._engine.k, self._engine.whole),
        )

    def write_can_log(self, path: str | Path, start: datetime | None = None) -> int:
        """Write the frames that crossed the buses as .log (candump), .asc, .blf, .mf4 or .pcapng.

        `start` is the moment of 0 s, with a time zone (default: 2000 begins in UTC). Return their number.
        Raises ConfigError if the run did not keep them (`log_frames`), for a bus with a `resolution`, or if
        the file cannot be written.
        """
        check_decodable(self.system)
        return write_can_log(path, frame_logs(self), self.plan.clock, start)

    def manifest(self) -> dict[str, Any]:
        """Return what made these results: versions, FMU digests, parameters, settings, counts (JSON-able)."""
        return manifest(self._prepared, self._engine, self.isolation, self.warnings, self.loop_seconds)

    def saturations(self) -> dict[str, dict[str, float]]:
        """Return `count` and `first_time` [s] of each bus signal that was saturated."""
        return saturations(self._engine)

    # ---- the end

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end(error is None and self._engine.whole, error)

    def close(self, orderly: bool = True) -> None:
        """Terminate the units (not after an error) and release them. The results stay.

        Raises the error of the first unit that cannot be terminated, after the others were; RunError where
        the folder that the run has takes no results, which says where they are.
        """
        self._end(orderly, None)

    def _end(self, orderly: bool, error: BaseException | None) -> None:
        try:
            if orderly:
                terminate(self._units.values())
        except RunError as failure:
            error = failure
            raise
        finally:
            if self._kept is not None:
                self._kept.stop()
            self._free()
            if self._kept is not None:
                self._kept.end(ended(self.results, self.finished, error), error)

    def _free(self) -> None:
        for unit in self._units.values():
            unit.free()
        self._last_warnings = self._unit_warnings()  # an isolated unit reports the last ones when it is freed
        self._units = {}


def simulate(
    system: str | Path | System,
    scenario: str | Path | Scenario | None = None,
    *,
    progress: RunProgress | None = None,
    folder: str | os.PathLike[str] | None = None,
    **options: Unpack[RunOptions],
) -> Results:
    """Run a system to its stop time; the arguments are those of `Simulation`.

    With a `folder`, rows reach it while the run goes on, as `Simulation.keep_in` says.
    The options, as `parameters` and `stop_time`, are the keys of `evcosim.RunOptions`. Raises
    ConfigError before any step, RunError when a step fails or the folder takes no results; what the run has
    recorded is in the error's `results` (None where it failed before the first step).
    """
    simulation = Simulation(system, scenario, to_stop=True, **options)
    try:
        with simulation:
            if folder is not None:
                simulation.keep_in(folder)
            simulation.run(progress)
    except RunError as error:
        error.results = simulation.results
        raise
    return simulation.results


def frame_logs(simulation: Simulation) -> list[BusLog]:
    """Return the frames of each bus. Raises ConfigError if the run did not keep them (`log_frames`)."""
    if not simulation.log_frames:
        raise ConfigError("the frames of this run were not kept: simulate with log_frames=True")
    return [simulation._engine.frames.log_of(bus) for bus in simulation.system.file.buses]
