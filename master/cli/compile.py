"""`evcosim compile`: a library for this machine in an FMU that brings its C sources."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def compile_(
    fmu: Annotated[Path, typer.Argument(metavar="FILE", help="An FMU with sources.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="The FMU to write; default: FILE itself."),
    ] = None,
) -> None:
    """Compile the C sources that an FMU brings, for this machine, with $CC or cc."""
    from ...cosim.errors import ConfigError, nearest
    from ...cosim.file_names import near_file
    from ...cosim.system.kinds import kind_of
    from ..builtin import builtin_names
    from ..fmi.compilation import compile_fmu

    if not fmu.is_dir() and fmu.suffix.lower() not in (".fmu", ".zip") and (said := kind_of(fmu, "FMU")):
        raise ConfigError(said)
    if not fmu.exists():
        raise ConfigError(
            f"{fmu}: there is no such file{near_file(fmu) or nearest(str(fmu), builtin_names())}"
        )
    print(compile_fmu(fmu, output))
