"""`evcosim build`: the built-in FMUs as files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import completion


def build(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME]...",
            help="Built-in FMUs; default: all of them.",
            autocompletion=completion.fmus,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Where to; default: the cache that `run` uses."),
    ] = None,
) -> None:
    """Build the built-in FMUs and print where they are; compile the engine for later runs."""
    from ...cosim.errors import ConfigError, nearest
    from ..builtin import build_fmu, builtin_names
    from ..engine.selection import compile_engine
    from .failures import complain

    known = builtin_names()
    for name in names or ():
        if name not in known:
            raise ConfigError(
                f"there is no built-in FMU '{name}'{nearest(name, known)}; there are {', '.join(known)}"
            )
    for name in dict.fromkeys(names or known):
        print(build_fmu(name, output))
    if notice := compile_engine():
        complain(f"warning: {notice}")
