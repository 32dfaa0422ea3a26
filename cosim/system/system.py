"""The system file: units, buses and what is connected to what (TOML; docs/system-file.md)."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, ConfigDict, Field, model_validator

from ..can.bus_settings import BusSettings
from ..clock import LATEST
from ..errors import ConfigError
from ..interface import InterfaceType
from .figure_spec import FigureSpec
from .kinds import other_file
from .metric_spec import MetricSpec
from .scaling import Scaling
from .toml import (
    DATA,
    FileModel,
    FileValue,
    FiniteModel,
    GivenValue,
    OrText,
    find,
    names_in,
    read_toml,
    text_as,
    text_type,
)

Algorithm = Literal["gauss_seidel", "jacobi"]
Isolation = Literal["process", "none"]
EngineName = Literal["compiled", "python"]
UnitsName = Literal["python", "native", "auto"]


SHORTEST = 1e-12
"""The shortest communication step [s]: with the greatest time, the steps of a run can be counted."""
_LONGEST_WAIT = 1e6  # s


def _identifier(name: str) -> str:
    if not name.isidentifier():
        raise ValueError("a name is made of letters, digits and '_'")
    return name


def _variable(name: str) -> str:
    if len(name.split(".", 1)) != 2 or not all(name.split(".", 1)):
        raise ValueError("a variable is written unit.variable")
    return name


def _signal(name: str) -> str:
    if name.count(".") < 2:
        raise ValueError("a signal is written bus.message.signal")
    return name


# letters outside ASCII are let through: every dialect of patterns has its own idea of them
_NAME = r"^[A-Za-z_\u0080-\uffff][A-Za-z0-9_\u0080-\uffff]*$"

Identifier = Annotated[str, AfterValidator(_identifier), text_type("name", _NAME)]
VariableName = Annotated[str, AfterValidator(_variable), text_type("unit.variable", r"^[^.]+\.[^\n]+$")]
SignalName = Annotated[
    str, AfterValidator(_signal), text_type("bus.message.signal", r"^[^.]*\.[^.]*\.[^\n]*$")
]


class Experiment(FiniteModel):
    """The communication points of a run, and the order in which units step."""

    start_time: float = Field(default=0.0, ge=-LATEST, le=LATEST)
    """Time of the first communication point in s."""

    stop_time: float = Field(default=10.0, ge=-LATEST, le=LATEST)
    """Time at which the run ends, in s: a whole number of steps after `start_time`."""

    step_size: float = Field(default=0.01, ge=SHORTEST, le=LATEST)
    """Communication step in s: how often values go from unit to unit."""

    algorithm: Algorithm = "gauss_seidel"
    """The order of a step: units one after the other, as written (gauss_seidel), or all at once (jacobi)."""

    engine: EngineName | None = None
    """The engine; results are equal bit for bit. Without it compiled, or python where numba is missing."""

    algebraic_loops: Literal["refuse", "iterate"] = "refuse"
    """A loop of outputs that depend on each other at once is refused, or its initial values are iterated."""

    loop_tolerance: float = Field(default=1e-9, gt=0.0)
    """Relative tolerance at which that iteration ends."""


class _MapNames(FileModel):
    """The keys of a mapped variable that are no scaling; a base of its own, so that they come first."""

    variable: str
    """The FMU's own name of the variable."""

    unit: str | None = None
    """Unit of measure, where the FMU declares none or a wrong one; without it as the FMU declares. With
    `factor`, `offset` or `convert`, that of the system's value."""

    invert: bool = False
    """Take the value with the other sign."""


class MapEntry(Scaling, _MapNames):
    """The FMU's variable behind a name of the system. The variable's name alone stands for a table."""

    @model_validator(mode="after")
    def _one_sign(self) -> MapEntry:
        if self.invert and self.written:
            raise ValueError("'invert' beside a factor: write a negative factor")
        return self


Mapped = Annotated[MapEntry, text_as("variable"), OrText()]


class MapTables(FileModel):
    """The variables of an FMU behind the names that the system uses; the rest keep the FMU's own names."""

    inputs: dict[str, Mapped] = {}
    """Inputs: names of the system, each with the FMU's variable."""

    outputs: dict[str, Mapped] = {}
    """Outputs, to which a local variable or a parameter of the FMU may be given too."""

    parameters: dict[str, Mapped] = {}
    """Parameters, as `--set` and `parameters` name them."""

    @property
    def by_causality(self) -> dict[str, dict[str, MapEntry]]:
        """The tables by the causality that their names have in the system."""
        return {"input": self.inputs, "output": self.outputs, "parameter": self.parameters}


class UnitEntry(FileModel):
    """One unit: its FMU, the values that it starts with, and how it is stepped."""

    fmu: str = Field(examples=["Scooter", "my/Vehicle.fmu"])
    """A built-in FMU by name, or the path of any FMU, beside this file or from the working folder."""

    parameters: dict[str, FileValue] = {}
    """Values of parameters by name, in the units of measure that the FMU declares."""

    start: dict[str, FileValue] = {}
    """Start values by name: of inputs, of which one that nothing drives keeps its own, and of local variables
    and outputs whose initial value the FMU lets be given (initial = "exact" or "approx"), as states."""

    period: float | None = Field(default=None, gt=0.0, le=LATEST)
    """Time in s from one step of the unit to the next, a multiple of `step_size`; without it that itself."""

    offset: float | None = Field(default=None, ge=0.0, le=LATEST)
    """Task phase in s: the unit starts so much later than the run, its FMU too, and until then its initial
    outputs stand; a multiple of `step_size`, less than the unit's period."""

    substeps: int = Field(default=1, ge=1, le=1_000_000)
    """FMU steps into which a period is divided, with the inputs held."""

    sampled: bool | list[str] | None = None
    """Outputs that the unit computes from the inputs of the same time and that hold from then on, as those of
    a sampled controller do; true: all that the FMU declares discrete. Without it as the FMU tells (those that
    evcosim built do), or as in the unit whose place it takes."""

    nodes: list[str] = Field(default=[], examples=[["CAM", "IMU"]])
    """The nodes of the CAN databases whose messages it sends, where it stands for several or their names are
    others; a message of another node is a warning."""

    isolation: Isolation | None = None
    """Run it in a process of its own (process) or in the master's (none); without it FMUs that evcosim did
    not build have a process of their own, and "none" for one of them needs --trust."""

    step_timeout: float = Field(default=30.0, ge=1e-3, le=_LONGEST_WAIT)
    """Longest time in s that its process may take for an answer in the run."""

    load_timeout: float = Field(default=60.0, ge=1e-3, le=_LONGEST_WAIT)
    """Longest time in s for an answer before the run: loading, instantiating, initializing."""

    memory_limit: float = Field(default=8e9, ge=256e6)
    """Address space of its process in bytes; inf for no limit."""

    file_limit: float = Field(default=256e6, ge=1.0)
    """Size in bytes of each file that its process writes; inf for no limit."""

    interface: InterfaceType | None = None
    """The interface that is used of an FMU that has both; without it Co-Simulation."""

    tolerance: float | None = Field(default=None, gt=0.0, lt=1.0)
    """Relative tolerance of the solver, ours in Model Exchange and the FMU's in Co-Simulation; without it the
    one that the FMU declares, else 1e-6 in Model Exchange and none in Co-Simulation."""

    strict: bool = False
    """Refuse the FMU when its description has defects, also such that could be mended."""

    map: MapTables = MapTables()
    """Names of the system for variables of an FMU of another tool."""

    absent: list[str] = []
    """Names of the system that the FMU does not have; what needs them is left out."""

    open: list[str] = []
    """Names of the system for which no variable of the FMU is chosen yet; a run needs `--allow-open`, and
    leaves out what needs them. A name that is mapped is no longer open."""


class _BusFile(FileModel):
    """The key of a bus that is no setting; a base of its own, so that it comes first."""

    dbc: str
    """The bus' CAN database (DBC, KCD, SYM or ARXML), beside the system file or built in."""


class BusEntry(BusSettings, _BusFile):
    """A CAN bus: its database and its settings."""

    units: dict[str, str] = Field(default={}, examples=[{"Unit_Volt": "V"}])
    """Units of measure for texts of the DBC that are not known, or that say something else there."""


class _Ends(FiniteModel):
    """The keys of a connection that are no scaling; a base of its own, so that they come first."""

    source: VariableName = Field(alias="from", examples=["vehicle.speed"])
    """The output (or local variable) whose value is sent."""

    to: list[VariableName] = []
    """The inputs that receive it; none where a bus signal is sent for whoever listens."""

    via: SignalName | None = Field(default=None, examples=["can0.EMD_Status.EMD_VehicleSpeed"])
    """The bus signal that carries it; without it the connection is direct."""

    initial: GivenValue | None = None
    """Value at the receivers before the first message, in their own unit; without it their start values.
    It needs `via`."""

    optional: bool = False
    """Leave it out, with a warning, where an FMU in the place of a unit does not have the variable: the
    receivers keep their start values."""

    needed_where: dict[VariableName, GivenValue] = Field(default={}, examples=[{"ecu.source": "wheels"}])
    """Values of parameters with which a run is refused where nothing drives an input that it would: one that
    is `optional`, or whose sender the scenario leaves out."""

    model_config = ConfigDict(json_schema_extra={"dependentRequired": {"initial": ["via"]}})

    @model_validator(mode="after")
    def _initial_over_a_bus(self) -> _Ends:
        if self.initial is not None and self.via is None:
            raise ValueError("'initial' is what is there before the first message: it needs a 'via'")
        return self


class Connection(Scaling, _Ends):
    """One output to one or more inputs, over a bus signal or directly; units of measure are converted."""


class BudgetEntry(FileModel):
    """The limit by which `evcosim budget` judges the system when it varies the buses."""

    metric: str
    """The name of one of the `[[metrics]]`."""

    limit: float = Field(allow_inf_nan=False)
    """The limit, in the metric's unit."""

    kind: Literal["max", "min"] = "max"
    """The limit is broken by a value above it (max) or below it (min)."""


class SystemFile(FileModel):
    """A system: its units, its buses, and what is connected to what."""

    name: Identifier
    """The system's name; its scenarios are looked up in `scenarios/NAME/` beside this file."""

    title: str = ""
    """One line that `evcosim list` and `evcosim info` show."""

    source: str = ""
    """The publication or data that the system is taken from."""

    scenario: str | None = None
    """The scenario that runs by default; without it the system runs with no scenario."""

    experiment: Experiment = Experiment()
    """Communication points and order of the units."""

    units: dict[Identifier, UnitEntry] = Field(min_length=1)
    """The units by name, in the order in which they step: a table `[units.NAME]` for each."""

    buses: dict[Identifier, BusEntry] = {}
    """The CAN buses by name: a table `[buses.NAME]` for each."""

    connect: list[Connection] = []
    """The connections: a table `[[connect]]` for each."""

    record: list[str] = ["*"]
    """Patterns of variables that are recorded, as `vehicle.*`; `*` stands for all inputs and outputs, a local
    variable is named in full. A pattern that begins with `!` leaves out what it fits. One that fits nothing
    is refused, and so are patterns that leave nothing."""

    figure: FigureSpec | None = None
    """The figure of a run; without it evcosim chooses one."""

    metrics: list[MetricSpec] = []
    """Numbers of a run that are reported: a table `[[metrics]]` for each."""

    budget: BudgetEntry | None = None
    """The limit for `evcosim budget`."""


@dataclasses.dataclass(frozen=True)
class System:
    """A system file that was read from `path`; `swaps` are the swap files that units come from, by unit."""

    path: Path
    file: SystemFile
    swaps: Mapping[str, Path] = dataclasses.field(default_factory=dict)

    @property
    def scenario_folders(self) -> list[Path]:
        """The folders of this system's scenarios: beside the system file, then built in."""
        folders = [root / "scenarios" / self.file.name for root in (self.path.parent, DATA)]
        return list(dict.fromkeys(folders))

    def keys_of(self, unit: str) -> str:
        """Return the beginning of a unit's keys in messages, as `scooter.toml: units.vehicle.`."""
        return f"{self.swaps[unit]}: " if unit in self.swaps else f"{self.path}: units.{unit}."


def system_names() -> list[str]:
    """Return the names of the built-in systems."""
    return names_in(DATA / "systems")


def load_system(name: str) -> System:
    """Return the system of a built-in name or a path. Raises ConfigError naming file, key, rule and value."""
    path = find(name, [DATA / "systems"], "system")
    try:
        return System(path, read_toml(path, SystemFile))
    except ConfigError as error:
        if said := other_file(path):
            raise ConfigError(said) from error
        raise
