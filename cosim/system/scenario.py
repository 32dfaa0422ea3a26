"""The scenario file: what drives a system, and what happens to it (TOML; docs/system-file.md)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from ..interface import Value
from .figure_spec import FigureSpec
from .identification_spec import IdentificationSpec
from .metric_spec import MetricSpec
from .system import Algorithm, System, VariableName
from .toml import FileModel, FiniteModel, find, names_in, read_toml

Interpolation = Literal["linear", "hold"]


class Sine(FiniteModel):
    """mean + amplitude sin(2 pi (t - delay)/period + phase); mean before `delay`. Time in s, phase in rad."""

    amplitude: float
    period: float = Field(gt=0.0)
    mean: float = 0.0
    phase: float = 0.0
    delay: float = 0.0


class Ramp(FiniteModel):
    """`start` until `delay`, then `slope` per second until `end` is reached (no end: for ever)."""

    slope: float
    start: float = 0.0
    end: float | None = None
    delay: float = 0.0


class StimulusEntry(FiniteModel):
    """A signal for a free input: exactly one of table, csv, sine, ramp or constant.

    Values are in `unit` (default: the input's own). Before its first point a table holds its first value,
    after its last point the last one. `csv` names a file with a header; `column` defaults to the second
    column, the first is time in s.
    """

    to: VariableName
    unit: str | None = None
    constant: float | None = None
    table: list[tuple[float, float]] | None = None
    csv: str | None = None
    column: str | None = None
    interpolation: Interpolation = "linear"
    sine: Sine | None = None
    ramp: Ramp | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> StimulusEntry:
        kinds = ("constant", "table", "csv", "sine", "ramp")
        given = [kind for kind in kinds if getattr(self, kind) is not None]
        if len(given) != 1:
            raise ValueError(
                f"a stimulus has exactly one of {', '.join(kinds)}; this one has {given or 'none'}"
            )
        if self.column is not None and self.csv is None:
            raise ValueError("'column' belongs to a csv stimulus")
        return self


class EventEntry(FiniteModel):
    """At `time` [s]: `override` what an input receives, add a `bias` to it, or `reset` both.

    It takes effect at the first communication point at or after `time`. `value` is in the input's unit.
    """

    time: float = Field(ge=0.0)
    action: Literal["override", "bias", "reset"]
    variable: VariableName
    value: float | None = None

    @model_validator(mode="after")
    def _value_where_needed(self) -> EventEntry:
        if (self.value is None) != (self.action == "reset"):
            raise ValueError("override and bias need a value, reset has none")
        return self


class ScenarioExperiment(FiniteModel):
    """What a scenario may change of the system's experiment."""

    stop_time: float | None = None
    step_size: float | None = Field(default=None, gt=0.0)
    algorithm: Algorithm | None = None


class ScenarioFile(FileModel):
    """What stands in a scenario file. `leave_out` names units that do not take part."""

    title: str = ""
    source: str = ""
    experiment: ScenarioExperiment = ScenarioExperiment()
    leave_out: list[str] = []
    parameters: dict[str, dict[str, Value]] = {}
    start: dict[str, dict[str, Value]] = {}
    stimuli: list[StimulusEntry] = Field(default=[], alias="stimulus")
    events: list[EventEntry] = Field(default=[], alias="event")
    record: list[str] | None = None
    figure: FigureSpec | None = None
    metrics: list[MetricSpec] = []
    identification: IdentificationSpec | None = None


@dataclasses.dataclass(frozen=True)
class Scenario:
    """A scenario file that was read; `path` is None for the empty scenario."""

    name: str
    path: Path | None
    file: ScenarioFile


def scenario_names(system: System) -> list[str]:
    """The names of the scenarios that there are for a system."""
    return sorted({name for folder in system.scenario_folders for name in names_in(folder)})


def load_scenario(system: System, name: str | None = None) -> Scenario:
    """Read a scenario by name or path; None: the system's default, which may be none at all.

    Raises ConfigError naming file, key, rule and value.
    """
    name = name or system.file.scenario
    if name is None:
        return Scenario("", None, ScenarioFile())
    path = find(name, system.scenario_folders, f"scenario of system '{system.file.name}'")
    return Scenario(path.stem, path, read_toml(path, ScenarioFile))
