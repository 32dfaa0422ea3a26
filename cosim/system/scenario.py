"""The scenario file: what drives a system, and what happens to it (TOML; docs/system-file.md)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Annotated, Literal

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


class _EventRecord(FiniteModel):
    """Base of all events: each takes effect at the first communication point at or after `time` [s]."""

    time: float = Field(ge=0.0)

    @property
    def needs(self) -> tuple[str, ...]:
        """The variables without which the event has nothing to act on."""
        return ()


class _InputEvent(_EventRecord):
    """An event that acts on what the input `variable` receives."""

    variable: VariableName

    @property
    def needs(self) -> tuple[str, ...]:
        """The input."""
        return (self.variable,)


class Override(_InputEvent):
    """From then on the input receives `value`, in its own unit, whatever drives it."""

    action: Literal["override"]
    value: float


class Bias(_InputEvent):
    """From then on the input receives `value`, in its own unit, more than what drives it."""

    action: Literal["bias"]
    value: float


class Reset(_InputEvent):
    """From then on the input receives what drives it: the end of an override or a bias."""

    action: Literal["reset"]


Event = Annotated[Override | Bias | Reset, Field(discriminator="action")]
"""An event, by its `action`. Code that acts on one ends its `match` with `assert_never`: mypy then names each
place that a new action must be added to."""


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
    events: list[Event] = Field(default=[], alias="event")
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
