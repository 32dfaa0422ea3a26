"""`evcosim new`: a folder with a system of one's own that runs as it is."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from . import completion


def new(
    name: Annotated[
        Path, typer.Argument(metavar="NAME", help="The folder to make; the system has its name.")
    ],
    base: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="SYSTEM",
            help="Copy a built-in system, to be changed; default: a small example.",
            autocompletion=completion.systems,
        ),
    ] = None,
) -> None:
    """Make a folder with a system of your own: models, a DBC, a scenario, and a README."""
    from ..new_system import new_system
    from .console import print_next, print_paragraph

    files = new_system(name, base)
    print_paragraph(f"made {name}: {', '.join(files)}")
    system = shlex.quote(str(name / f"{name.resolve().name}.toml"))
    models = [str(name / file) for file in files if file.startswith("models/") and file.endswith(".py")]
    commands = [f"evcosim run {system}", f"evcosim info {system}"]
    commands += [f"evcosim build {shlex.quote(models[-1])}"] if models else []
    print_next(commands)
