"""`evcosim info`: the interface of an FMU, the connections of a system, or the messages of a CAN database."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from . import completion
from .options import StrictOption


def info(
    what: Annotated[
        str,
        typer.Argument(
            metavar="FILE|NAME",
            help="An FMU or a system: a file, or a built-in name. Or a CAN database (.dbc .kcd .sym .arxml).",
            autocompletion=completion.systems_and_fmus,
        ),
    ],
    message: Annotated[
        str | None,
        typer.Argument(
            metavar="MESSAGE|SCENARIO",
            help="Database: the message whose signals are shown. System: the scenario whose CAN logs are.",
        ),
    ] = None,
    causality: Annotated[
        list[str] | None,
        typer.Option(metavar="C", help="FMU: only variables of it, as in 'input'; can be given again."),
    ] = None,
    search: Annotated[
        str | None, typer.Option(metavar="TEXT", help="FMU: only variables with it in name or description.")
    ] = None,
    diagram: Annotated[
        Path | None, typer.Option(metavar="FILE", help="System: draw its units and connections (.png, .svg).")
    ] = None,
    bitrate: Annotated[
        int | None, typer.Option(metavar="N", min=1, max=10**9, help="Database: show the load at N bit/s.")
    ] = None,
    data_bitrate: Annotated[
        int | None, typer.Option(metavar="N", min=1, max=10**9, help="Database: CAN FD payloads at N bit/s.")
    ] = None,
    strict: StrictOption = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Show what an FMU offers, how a system is connected, or what a CAN database has."""
    from ...cosim.errors import ConfigError
    from .console import print_json

    if diagram is not None and as_json:
        raise ConfigError("--diagram draws and --json prints: give one of them")
    about, show = _report(what, (causality or [], search, strict), diagram, (message, bitrate, data_bitrate))
    if diagram is not None:
        _draw(what, diagram)
    elif as_json:
        print_json(about)
    else:
        show(about)


def _report(
    what: str,
    of_fmu: tuple[list[str], str | None, bool],
    diagram: Path | None,
    of_database: tuple[str | None, int | None, int | None],
) -> tuple[dict[str, Any], Callable[[dict[str, Any]], None]]:
    """Return the report and what prints it. Raises ConfigError for options of another kind of file."""
    from ...cosim.can.formats import REFUSED, SUFFIXES
    from ...cosim.errors import ConfigError
    from ...cosim.system.system import system_names
    from . import info_database, info_fmu, info_system

    if what.lower().endswith((*SUFFIXES, *REFUSED)):
        if any(of_fmu) or diagram:
            options = "--causality, --search, --strict and --diagram"
            raise ConfigError(f"{options} are not for a CAN database, as {what}")
        return info_database.described(Path(what), *of_database), info_database.show
    is_system = what.endswith(".toml") or what in system_names()
    if any(of_database[1:] if is_system else of_database):
        options = "--bitrate and --data-bitrate" if is_system else "MESSAGE, --bitrate and --data-bitrate"
        raise ConfigError(f"{options} are for a CAN database ({' '.join(SUFFIXES)}); {what} is none")
    if is_system:
        if any(of_fmu):
            raise ConfigError(f"--causality, --search and --strict are for an FMU; {what} is a system")
        return info_system.described(what, of_database[0]), info_system.show
    if diagram is not None:
        raise ConfigError(f"--diagram draws a system; {what} is none")
    return info_fmu.described(fmu_path(what), *of_fmu), info_fmu.show


def _draw(system: str, path: Path) -> None:
    from ...cosim.figures import draw as figures
    from ...cosim.figures.system_diagram import draw_diagram
    from ...cosim.system.system import load_system

    figures.write(draw_diagram(load_system(system).file), path)
    print(path)


def fmu_path(name: str) -> Path:
    """Return the file of an FMU, by path or built-in name. Raises ConfigError with the nearest name."""
    from ...cosim.errors import ConfigError, nearest, short
    from ...cosim.file_names import check_name
    from ...cosim.system.kinds import kind_of
    from ...cosim.system.system import system_names
    from ..builtin import builtin_names, fmu_file

    known = (*system_names(), *builtin_names())
    check_name(name)
    if name not in known and not name.lower().endswith(".fmu") and (said := kind_of(Path(name), "FMU")):
        raise ConfigError(said)
    if name in known or Path(name).exists() or any(c in name for c in "/\\."):
        return Path(name) if Path(name).exists() else fmu_file(name)
    raise ConfigError(
        f"there is no system or FMU {short(name)}{nearest(name, known)}; built in: {', '.join(known)}"
    )
