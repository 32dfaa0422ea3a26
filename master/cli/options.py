"""The options that several verbs share, each declared once."""

from __future__ import annotations

import enum
from typing import Annotated

import typer

from . import completion


class Algorithm(enum.StrEnum):
    """The master algorithms."""

    gauss_seidel = "gauss_seidel"
    jacobi = "jacobi"


SystemArgument = Annotated[
    str,
    typer.Argument(
        metavar="SYSTEM",
        help="A built-in system, or a TOML file.",
        autocompletion=completion.systems,
    ),
]
ScenarioOption = Annotated[
    str | None,
    typer.Option(
        "--scenario",
        "-s",
        metavar="S",
        help="Name or TOML file; default: the system's own.",
        autocompletion=completion.scenarios,
    ),
]


class Engine(enum.StrEnum):
    """What does the steps."""

    compiled = "compiled"
    python = "python"


class Isolation(enum.StrEnum):
    """Where units run."""

    process = "process"
    none = "none"


IsolationOption = Annotated[
    Isolation | None,
    typer.Option(
        help="Each unit in a process of its own, or none; default: other tools' FMUs.", show_default=False
    ),
]
SettingsOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="UNIT.PARAMETER=VALUE", help="Set a parameter; can be given again."),
]
FmusOption = Annotated[
    list[str] | None,
    typer.Option("--fmu", metavar="UNIT=PATH", help="Put another FMU in; can be given again."),
]
SwapsOption = Annotated[
    list[str] | None,
    typer.Option("--swap", metavar="UNIT=FILE", help="Put an FMU in by its swap file; can be given again."),
]
IdealOption = Annotated[bool, typer.Option("--ideal", help="Leave the buses out: unit conversion only.")]
AlgorithmOption = Annotated[
    Algorithm | None, typer.Option(help="The order of steps; default: the system's own.", show_default=False)
]
EngineOption = Annotated[
    Engine | None,
    typer.Option(help="What does the steps; default: compiled, python without numba.", show_default=False),
]
StopTimeOption = Annotated[float | None, typer.Option(metavar="T", help="When to stop [s].")]
WorkersOption = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="Processes at a time; default: one for each core.")
]
StrictOption = Annotated[
    bool, typer.Option("--strict", help="Refuse an FMU whose description has defects that could be mended.")
]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors and warnings only.")]
