"""`evcosim schema`: the JSON schema of a file, by which an editor completes and checks it."""

from __future__ import annotations

import enum
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from pydantic import BaseModel


class Kind(enum.StrEnum):
    """The kinds of files that evcosim reads."""

    system = "system"
    scenario = "scenario"
    swap = "swap"


class Verb(enum.StrEnum):
    """The verbs with `--json`."""

    run = "run"
    list = "list"
    info = "info"
    check = "check"
    compare = "compare"
    identify = "identify"
    budget = "budget"
    bus = "bus"
    reproduce = "reproduce"


def schema(
    kind: Annotated[
        Kind,
        typer.Argument(metavar="[KIND]", help="system (the default), scenario or swap.", show_default=False),
    ] = Kind.system,
    json_of: Annotated[
        Verb | None,
        typer.Option("--json-of", help="Of what a verb prints with --json.", show_default=False),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="PATH", help="Write it: a file, or a folder to put it into."),
    ] = None,
) -> None:
    """Print the JSON schema of a kind of file, for editors, or of the output of a verb.

    An editor that knows TOML completes and checks a file whose first line is #:schema ./system.schema.json
    """
    from ...cosim.system.schema import json_schema
    from ...cosim.writing import write_text
    from .json_schemas import schema_of

    made = json_schema(_model(kind), f"evcosim {kind} file") if json_of is None else schema_of(json_of)
    text = json.dumps(made, indent=2, ensure_ascii=False) + "\n"
    if output is None:
        typer.echo(text, nl=False)
        return
    name = kind if json_of is None else f"{json_of}-output"
    path = output / f"{name}.schema.json" if output.is_dir() else output
    write_text(path, text)
    typer.echo(path)


def _model(kind: Kind) -> type[BaseModel]:
    from ...cosim.swap.swap_file import SwapFile
    from ...cosim.system.scenario import ScenarioFile
    from ...cosim.system.system import SystemFile

    models: dict[Kind, type[BaseModel]] = {
        Kind.system: SystemFile,
        Kind.scenario: ScenarioFile,
        Kind.swap: SwapFile,
    }
    return models[kind]
