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
    from ...cosim.errors import ConfigError
    from ...cosim.system.kinds import kind_of
    from ..fmi.compilation import compile_fmu

    if not fmu.is_dir() and fmu.suffix.lower() not in (".fmu", ".zip") and (said := kind_of(fmu, "FMU")):
        raise ConfigError(said)
    print(compile_fmu(fmu, output))
