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
            metavar="NAME...",
            help="Built-in FMUs, or Python files with models of your own; default: all built-in ones.",
            autocompletion=completion.fmus,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            help="Where to; default: the cache, of a Python file beside it.",
        ),
    ] = None,
) -> None:
    """Build FMUs, built-in ones or those of your own models, and print where they are.

    Without a Python file the engine is compiled too, with the frames of buses, for later runs.
    """
    from ...cosim.errors import ConfigError, nearest
    from ...cosim.system.kinds import kind_of
    from ..builtin import build_fmu, build_models, builtin_names
    from ..engine.selection import compile_engine
    from .failures import complain

    known = builtin_names()
    own = [name for name in names or () if name.endswith(".py")]
    for name in names or ():
        if name not in known and name not in own:
            if said := kind_of(Path(name), "model"):
                raise ConfigError(f"{said}; a model is Python code (.py)")
            raise ConfigError(
                f"there is no built-in FMU '{name}'{nearest(name, known)}; there are {', '.join(known)}; a "
                "model of your own is a Python file (.py)"
            )
    for name in dict.fromkeys(names or known):
        for path in build_models(Path(name), output) if name in own else [build_fmu(name, output)]:
            print(path)
    if own:
        return
    if notice := compile_engine():
        complain(f"warning: {notice}")
