"""The scenario file: a system's stimuli and events, and the values it takes (TOML; docs/system-file.md)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from ..clock import LATEST
from .can_log_spec import CanLogEntry, is_log
from .fault_spec import Fault
from .figure_spec import FigureSpec
from .identification_spec import IdentificationSpec
from .metric_spec import MetricSpec
from .system import SHORTEST, Algorithm, System, VariableName
from .toml import FORBIDDEN_KEY, FileModel, FileValue, FiniteModel, GivenValue, find, names_in, read_toml

Interpolation = Literal["linear", "hold"]


_KINDS = ("constant", "table", "csv", "sine", "ramp")


class Sine(FiniteModel):
    """mean + amplitude sin(2 pi (t - delay)/period + phase); before `delay` it is `mean`."""

    amplitude: float
    """Amplitude, in the stimulus' unit."""

    period: float = Field(gt=0.0)
    """Period in s."""

    mean: float = 0.0
    """Mean value, in the stimulus' unit."""

    phase: float = 0.0
    """Phase at `delay` in rad."""

    delay: float = 0.0
    """Time in s at which the oscillation begins."""


class Ramp(FiniteModel):
    """start + slope (t - delay), until `end` is reached; before `delay` it is `start`."""

    slope: float
    """Change in the stimulus' unit per second."""

    start: float = 0.0
    """First value, in the stimulus' unit."""

    end: float | None = None
    """Value at which the ramp stays; without it the ramp never ends."""

    delay: float = 0.0
    """Time in s at which the ramp begins."""


def _one_kind_rules() -> list[Any]:
    """Return the JSON schemas by which a stimulus has one kind: an error is at a key, unlike with `oneOf`."""
    none = {"not": {"anyOf": [{"required": [kind]} for kind in _KINDS]}}
    rules: list[Any] = [{"if": none, "then": {"required": [_KINDS[0]]}}]
    for kind in _KINDS:
        others = {other: FORBIDDEN_KEY for other in _KINDS if other != kind}
        rules.append({"if": {"required": [kind]}, "then": {"properties": others}})
    return rules


class StimulusEntry(FiniteModel):
    """A signal for a free input: exactly one of `constant`, `table`, `csv`, `sine` and `ramp`."""

    to: VariableName
    """The input that is driven."""

    unit: str | None = None
    """Unit of measure of the values; without it the input's own."""

    constant: GivenValue | None = None
    """One value for the whole run: a number, true or false for a Boolean, a text for a String, and for an
    enumeration a number or the name of an item."""

    table: list[Annotated[tuple[float, GivenValue], Field(strict=False)]] | None = None
    """Pairs of time in s and value, in rising time; two pairs of one time are a jump. Before the first pair
    its value holds, after the last that of the last."""

    csv: str | None = None
    """A CSV file with a header, beside this file or built in, with rows as in `table`: UTF-8, UTF-16 or
    Windows-1252, separated by commas, or by semicolons or tabs with decimal points or commas; a line that
    begins with # is a comment, and one without a value counts for nothing."""

    column: str | None = None
    """The column of `csv` that holds the values; without it the first one with a name beside the time."""

    time_column: str | None = None
    """The column of `csv` that holds the time in s; without it the one of a name like time, t, Time [s] or
    timestamps. Where several have such a name it is that named time, else the first column; a file where none
    of these is the time, or two columns have its name, is refused."""

    interpolation: Interpolation = "linear"
    """Between the rows of `table` or `csv`: a straight line, or the earlier value held. An input that is not
    Real always holds."""

    sine: Sine | None = None
    """A sine around a mean."""

    ramp: Ramp | None = None
    """A steady rise or fall."""

    model_config = ConfigDict(
        json_schema_extra={
            "allOf": _one_kind_rules(),
            "dependentRequired": {"column": ["csv"], "time_column": ["csv"]},
        }
    )

    @model_validator(mode="after")
    def _one_kind(self) -> StimulusEntry:
        given = [kind for kind in _KINDS if getattr(self, kind) is not None]
        if len(given) != 1:
            has = " and ".join(given) or "none"
            raise ValueError(f"a stimulus has exactly one of {', '.join(_KINDS)}; this one has {has}")
        for key in ("column", "time_column"):
            if getattr(self, key) is not None and self.csv is None:
                raise ValueError(f"'{key}' belongs to a csv stimulus")
        return self


# tags that are no keys of a file
_Stimulus = Annotated[
    Annotated[StimulusEntry, Tag("a signal")] | Annotated[CanLogEntry, Tag("a log")],
    Discriminator(lambda entry: "a log" if is_log(entry) else "a signal"),
]


class _EventRecord(FiniteModel):
    """Keys of all events."""

    time: float = Field(ge=-LATEST, le=LATEST)
    """Time in s; it happens at the first communication point at or after it."""

    @property
    def needs(self) -> tuple[str, ...]:
        """The variables without which the event has nothing to act on."""
        return ()


class _InputEvent(_EventRecord):
    """Keys of the events that act on what an input receives."""

    variable: VariableName
    """The input: the event acts on what the unit receives, not on what was sent."""

    @property
    def needs(self) -> tuple[str, ...]:
        """The input."""
        return (self.variable,)


class Override(_InputEvent):
    """Set what the input receives to `value` from then on, in place of what drives it or a bias before."""

    action: Literal["override"]
    """The kind of event."""

    value: GivenValue
    """The value, in the input's own unit of measure; true or false for a Boolean, a text for a String, for an
    enumeration a number or the name of an item."""


class Bias(_InputEvent):
    """Add `value` to what drives the input from then on, in place of an override or bias before it."""

    action: Literal["bias"]
    """The kind of event."""

    value: float
    """The value, in the input's own unit of measure."""


class Reset(_InputEvent):
    """End the override or bias of the input: it receives what drives it again."""

    action: Literal["reset"]
    """The kind of event."""


class Set(_EventRecord):
    """Set a tunable parameter, or an input that nothing drives, to `value` from then on."""

    action: Literal["set"]
    """The kind of event."""

    variable: VariableName
    """The parameter, which the FMU declares tunable, or the input."""

    value: GivenValue
    """The value within its limits, in its own unit of measure; true or false for a Boolean, a text for a
    String, for an enumeration a number or the name of an item."""

    @property
    def needs(self) -> tuple[str, ...]:
        """The parameter or input."""
        return (self.variable,)


Event = Annotated[Override | Bias | Reset | Set, Field(discriminator="action")]
"""An event, by its `action`. Code that acts on one ends its `match` with `assert_never`: mypy then names each
place that a new action must be added to."""


class ScenarioExperiment(FiniteModel):
    """Keys of the system's `[experiment]` that take another value in this scenario."""

    stop_time: float | None = Field(default=None, ge=-LATEST, le=LATEST)
    """Time at which the run ends, in s; without it the system's."""

    step_size: float | None = Field(default=None, ge=SHORTEST, le=LATEST)
    """Communication step in s; without it the system's."""

    algorithm: Algorithm | None = None
    """The order of a step; without it the system's."""


class ScenarioFile(FileModel):
    """A scenario: what drives a system, with which values, and what happens to it."""

    title: str = ""
    """One line that `evcosim list` shows."""

    source: str = ""
    """Which of the numbers are published, and which are chosen."""

    experiment: ScenarioExperiment = ScenarioExperiment()
    """Duration, step and order of the units."""

    leave_out: list[str] = []
    """Units that take no part; what they would drive are free inputs."""

    parameters: dict[str, dict[str, FileValue]] = {}
    """Values of parameters in place of the system's: a table `[parameters.UNIT]` for each unit."""

    start: dict[str, dict[str, FileValue]] = {}
    """Start values of inputs and states in place of the system's: a table `[start.UNIT]` for each unit."""

    entries: list[_Stimulus] = Field(default=[], alias="stimulus")
    """The signals that drive free inputs, and the CAN logs that are replayed: a table `[[stimulus]]` for
    each."""

    faults: list[Fault] = Field(default=[], alias="fault")
    """Faults on buses: a table `[[fault]]` for each."""

    events: list[Event] = Field(default=[], alias="event")
    """The events of the run, as faults of a sensor: a table `[[event]]` for each."""

    record: list[str] | None = None
    """Patterns of variables that are recorded; without it the system's."""

    figure: FigureSpec | None = None
    """The figure of a run; without it the system's."""

    metrics: list[MetricSpec] = []
    """Numbers that are reported beside the system's; one of the same name takes its place."""

    identification: IdentificationSpec | None = None
    """The task of `evcosim identify` in this scenario."""

    @property
    def stimuli(self) -> list[tuple[int, StimulusEntry]]:
        """The signals, each with the number of its table."""
        return [(n, entry) for n, entry in enumerate(self.entries, 1) if isinstance(entry, StimulusEntry)]

    @property
    def can_logs(self) -> list[tuple[int, CanLogEntry]]:
        """The CAN logs, each with the number of its table."""
        return [(n, entry) for n, entry in enumerate(self.entries, 1) if isinstance(entry, CanLogEntry)]


@dataclasses.dataclass(frozen=True)
class Scenario:
    """A scenario file that was read; `path` is None for the empty scenario."""

    name: str
    path: Path | None
    file: ScenarioFile


def scenario_names(system: System) -> list[str]:
    """Return the names of the scenarios that there are for a system."""
    return sorted({name for folder in system.scenario_folders for name in names_in(folder)})


def load_scenario(system: System, name: str | None = None) -> Scenario:
    """Return a scenario by name or path; None: the system's default, which may be none at all.

    Raises ConfigError naming file, key, rule and value.
    """
    name = name or system.file.scenario
    if name is None:
        return Scenario("", None, ScenarioFile())
    path = find(name, system.scenario_folders, "scenario", f"system '{system.file.name}'")
    return Scenario(path.stem, path, read_toml(path, ScenarioFile))
