"""The system file: units, buses and what is connected to what (TOML; docs/system-file.md)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from ..can.bus_settings import BusSettings
from ..interface import InterfaceType, Value
from .figure_spec import FigureSpec
from .metric_spec import MetricSpec
from .toml import DATA, FileModel, FiniteModel, find, names_in, read_toml

Algorithm = Literal["gauss_seidel", "jacobi"]
Isolation = Literal["process", "none"]
EngineName = Literal["compiled", "python"]


def _identifier(name: str) -> str:
    if not name.isidentifier():
        raise ValueError("a name is made of letters, digits and '_'")
    return name


def _variable(name: str) -> str:
    if len(name.split(".", 1)) != 2 or not all(name.split(".", 1)):
        raise ValueError("a variable is written unit.variable")
    return name


def _signal(name: str) -> str:
    if len(name.split(".")) != 3:
        raise ValueError("a signal is written bus.message.signal")
    return name


Identifier = Annotated[str, AfterValidator(_identifier)]
VariableName = Annotated[str, AfterValidator(_variable)]
SignalName = Annotated[str, AfterValidator(_signal)]


class Experiment(FiniteModel):
    """The communication points and the order of the units. Times in s.

    `engine` is what does the steps (None: the compiled one where there is numba); results are the same.
    """

    start_time: float = 0.0
    stop_time: float = 10.0
    step_size: float = Field(default=0.01, gt=0.0)
    algorithm: Algorithm = "gauss_seidel"
    engine: EngineName | None = None
    algebraic_loops: Literal["refuse", "iterate"] = "refuse"
    loop_tolerance: float = Field(default=1e-9, gt=0.0)


class MapEntry(FileModel):
    """The FMU's `variable` behind a name of the system; `unit`, if the FMU declares none or a wrong one;
    `invert`, if its sign is the other one."""

    variable: str
    unit: str | None = None
    invert: bool = False


def _mapped(value: Any) -> Any:
    return {"variable": value} if isinstance(value, str) else value


Mapped = Annotated[MapEntry, BeforeValidator(_mapped)]


class MapTables(FileModel):
    """The variables of an FMU behind the names that the system uses (see `mapping.present`)."""

    inputs: dict[str, Mapped] = {}
    outputs: dict[str, Mapped] = {}
    parameters: dict[str, Mapped] = {}

    @property
    def by_causality(self) -> dict[str, dict[str, MapEntry]]:
        """The tables by the causality that their names have in the system."""
        return {"input": self.inputs, "output": self.outputs, "parameter": self.parameters}


class UnitEntry(FileModel):
    """One unit: its FMU (a built-in name or a path), parameters and starts, and how it is stepped.

    `period` [s] is how often it steps (default: every communication point); `substeps` is into how many
    FMU steps a period is divided. `isolation`: in a process of its own, or in the master's (default: an FMU
    that evcosim built itself is in the master's). The limits of such a process: `step_timeout` [s] for an
    answer in the run, `load_timeout` [s] for one before it, `memory_limit` [bytes] of address space,
    `file_limit` [bytes] of each file that it writes. `interface` is which one is used of an FMU that has both
    (default: Co-Simulation), `tolerance` the relative one of the solver: ours under Model Exchange, else the
    FMU's own. `strict` refuses an FMU with defects that we could bear. `map` gives its variables the names
    that the system uses; `absent` are names of the system that it does not have.
    """

    fmu: str
    parameters: dict[str, Value] = {}
    start: dict[str, Value] = {}
    period: float | None = Field(default=None, gt=0.0, allow_inf_nan=False)
    substeps: int = Field(default=1, ge=1)
    isolation: Isolation | None = None
    step_timeout: float = Field(default=30.0, gt=0.0, allow_inf_nan=False)
    load_timeout: float = Field(default=60.0, gt=0.0, allow_inf_nan=False)
    memory_limit: float = Field(default=8e9, gt=0.0)
    file_limit: float = Field(default=256e6, gt=0.0)
    interface: InterfaceType | None = None
    tolerance: float | None = Field(default=None, gt=0.0, lt=1.0)
    strict: bool = False
    map: MapTables = MapTables()
    absent: list[str] = []


class _BusFile(FileModel):
    """The key of a bus that is no setting; a base of its own, so that it comes first."""

    dbc: str
    """The bus' CAN database (DBC), beside the system file or built in."""


class BusEntry(BusSettings, _BusFile):
    """A CAN bus: its database and its settings."""


class Connection(FiniteModel):
    """One output to one or more inputs, over a bus signal or directly.

    `initial` is what the receivers see before the first message, in their own unit of measure.
    """

    source: VariableName = Field(alias="from")
    to: list[VariableName] = []
    via: SignalName | None = None
    initial: float | None = None

    @model_validator(mode="after")
    def _initial_over_a_bus(self) -> Connection:
        if self.initial is not None and self.via is None:
            raise ValueError("'initial' is what is there before the first message: it needs a 'via'")
        return self


class BudgetEntry(FileModel):
    """The metric by which `evcosim budget` judges a system: broken above `limit`, or with kind "min" below.

    `metric` is the name of one of the metrics, `limit` is in its unit.
    """

    metric: str
    limit: float = Field(allow_inf_nan=False)
    kind: Literal["max", "min"] = "max"


class SystemFile(FileModel):
    """What stands in a system file."""

    name: Identifier
    title: str = ""
    source: str = ""
    scenario: str | None = None
    experiment: Experiment = Experiment()
    units: dict[Identifier, UnitEntry] = Field(min_length=1)
    buses: dict[Identifier, BusEntry] = {}
    connect: list[Connection] = []
    record: list[str] = ["*"]
    figure: FigureSpec | None = None
    metrics: list[MetricSpec] = []
    budget: BudgetEntry | None = None


@dataclasses.dataclass(frozen=True)
class System:
    """A system file that was read, and where from."""

    path: Path
    file: SystemFile

    @property
    def scenario_folders(self) -> list[Path]:
        """Where this system's scenarios are looked up: beside the system file, then built in."""
        folders = [root / "scenarios" / self.file.name for root in (self.path.parent, DATA)]
        return list(dict.fromkeys(folders))


def system_names() -> list[str]:
    """The names of the built-in systems."""
    return names_in(DATA / "systems")


def load_system(name: str) -> System:
    """Read a system by built-in name or path. Raises ConfigError naming file, key, rule and value."""
    path = find(name, [DATA / "systems"], "system")
    return System(path, read_toml(path, SystemFile))
