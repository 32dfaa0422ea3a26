"""The target of an identification: a system with its scenario, or an FMU alone as a system of one unit."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from ...cosim.clock import Clock
from ...cosim.errors import ConfigError, nearest
from ...cosim.system.held_stimuli import course
from ...cosim.system.identification_spec import IdentificationSpec
from ...cosim.system.kinds import kind_of
from ...cosim.system.problems import shown
from ...cosim.system.scenario import Scenario, StimulusEntry, load_scenario, scenario_names
from ...cosim.system.system import (
    Experiment,
    System,
    SystemFile,
    UnitEntry,
    load_system,
    system_names,
)
from ...cosim.system.toml import validate
from ..builtin import builtin_names, fmu_file
from ..fmi.fmu import declared_step, read_fmu
from ..single_fmu import UNIT, identifier

SCENARIO = "identification"
"""The scenario that a system is identified in if it has one of this name."""

_LOOKS = 10_001  # times at which a stimulus is looked at for a change
_STEP = 0.01  # s, where the FMU declares none


def is_fmu(target: str) -> bool:
    """Return True if `target` names an FMU, False if it names a system.

    Raises ConfigError with the nearest name if it names neither.
    """
    if target in builtin_names() or target.endswith(".fmu"):
        return True
    known = system_names()
    if target in known or target.endswith(".toml") or "/" in target or "\\" in target:
        return False
    if said := kind_of(Path(target), "system"):
        raise ConfigError(said)
    names = [*known, *builtin_names()]
    raise ConfigError(
        f"there is no system or FMU '{target}'{nearest(target, names)}; systems: {', '.join(known)}; "
        f"FMUs: {', '.join(builtin_names())}"
    )


def one_unit_system(target: str, step_size: float | None = None, units: str | None = None) -> System:
    """Return a system of one FMU (a built-in name or a path) as the unit `fmu`.

    `step_size` [s]: default that of the FMU's DefaultExperiment, else 0.01. Raises ConfigError for what is
    no step.
    """
    path = fmu_file(target, units=units)
    step = step_size
    if step is None:
        step = declared_step(read_fmu(path).description.defaultExperiment, "stepSize") or _STEP
    file = SystemFile(
        name=identifier(path.stem if target.endswith(".fmu") else target),
        experiment=validate({"step_size": step}, Experiment, target),
        units={UNIT: UnitEntry(fmu=str(path.resolve()))},
    )
    return System(Path(target), file)


def default_scenario(system: System, scenario: str | Path | None) -> str | Path | None:
    """Return the given scenario, else `identification` if the system has it, else None: its default."""
    return SCENARIO if scenario is None and SCENARIO in scenario_names(system) else scenario


def held(scenario: Scenario, swept: str, clock: Clock) -> tuple[Scenario, tuple[str, ...]]:
    """Return the scenario without what moves beside the swept input, and a sentence for each change.

    A stimulus of another input that changes within the time of `clock` is held at its first value;
    events are left out, those of the swept input too, which is overridden. Raises ConfigError as `stimulus`.
    """
    times = np.linspace(clock.start, clock.stop, _LOOKS)
    stimuli, said = [], []
    for number, entry in scenario.file.stimuli:
        values = course(entry, f"{scenario.path}: stimulus {number}", scenario.path, clock, times)
        if entry.to != swept and len(set(values)) > 1:
            at = values[0]
            shown_at = f"{at:.6g}" if isinstance(at, float) else shown(at)
            said.append(
                f"held at {shown_at}{f' {entry.unit}' if entry.unit else ''}: the stimulus of {entry.to}"
            )
            entry = StimulusEntry(to=entry.to, unit=entry.unit, constant=at)
        stimuli.append(entry)
    said += [
        f"left out: the event '{e.action}' of {', '.join(e.needs)} at {e.time:g} s"
        for e in scenario.file.events
    ]
    said += [f"left out: the CAN log {log.can_log}" for _, log in scenario.file.can_logs]
    if not said:
        return scenario, ()
    file = scenario.file.model_copy(update={"entries": stimuli, "events": []})
    return dataclasses.replace(scenario, file=file), tuple(said)


def spec_of(target: str, scenario: str | Path | None = None) -> IdentificationSpec | None:
    """Return the table `[identification]` of the scenario that `target` is identified in, if any."""
    if is_fmu(target):
        return None
    system = load_system(target)
    chosen = default_scenario(system, scenario)
    return load_scenario(system, None if chosen is None else str(chosen)).file.identification
