"""`evcosim info`: the interface of an FMU, or the connections of a system."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import completion
from .options import StrictOption


def info(
    what: Annotated[
        str,
        typer.Argument(
            metavar="FILE|NAME",
            help="An FMU or a system: a file, or a built-in name.",
            autocompletion=completion.systems_and_fmus,
        ),
    ],
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
    strict: StrictOption = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Show what an FMU offers or how a system is connected."""
    from ...cosim.errors import ConfigError
    from ...cosim.system.system import system_names
    from . import info_fmu, info_system
    from .console import print_json

    if what.endswith(".toml") or what in system_names():
        if causality or search or strict:
            raise ConfigError(f"--causality, --search and --strict are for an FMU; {what} is a system")
        if diagram is not None and as_json:
            raise ConfigError("--diagram draws and --json prints: give one of them")
        about = info_system.described(what)
        show = info_system.show
        if diagram is not None:
            _draw(what, diagram)
            return
    else:
        if diagram is not None:
            raise ConfigError(f"--diagram draws a system; {what} is none")
        about = info_fmu.described(fmu_path(what), causality or [], search, strict)
        show = info_fmu.show
    if as_json:
        print_json(about)
    else:
        show(about)


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
