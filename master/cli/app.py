"""The application: its verbs, and the options before the verb."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Annotated, Any

import typer

from . import completion
from .budget import budget
from .build import BuildCommand, build
from .bus import bus
from .check import check
from .compare import compare
from .compile import compile_
from .identify import identify
from .info import info
from .listing import list_
from .new import new
from .once import OnceCommand
from .plot import plot
from .reproduce import reproduce
from .results import results
from .run import run
from .schema import schema
from .typed_paths import checks_paths


@functools.cache
def command() -> Any:
    """The click command of `evcosim` with all its verbs."""
    # plain help: rich's boxes would cost a third of the time that --help may take
    app = typer.Typer(
        name="evcosim",
        add_completion=False,  # its options cannot name a shell; ours stand below
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback(invoke_without_command=True)(_global_options)
    verbs: dict[str, Callable[..., int | None]] = {
        "run": run,
        "new": new,
        "list": list_,
        "info": info,
        "check": check,
        "plot": plot,
        "compare": compare,
        "identify": identify,
        "reproduce": reproduce,
        "build": build,
        "compile": compile_,
        "budget": budget,
        "bus": bus,
        "schema": schema,
    }
    for name, verb in verbs.items():
        app.command(name, cls=BuildCommand if verb is build else OnceCommand)(checks_paths(verb))
    app.add_typer(results, name="results")
    return typer.main.get_command(app)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"evcosim {version('evcosim')}")
        raise typer.Exit


def _global_options(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
    debug: Annotated[
        bool, typer.Option("--debug", help="Show the traceback of an error (or set EVCOSIM_DEBUG=1).")
    ] = False,
    install_completion: Annotated[
        str | None,
        typer.Option(
            "--install-completion",
            metavar="[SHELL]",
            callback=completion.install,
            is_eager=True,
            help="Let the Tab key complete names, in this shell or the named one.",
        ),
    ] = None,
    show_completion: Annotated[
        str | None,
        typer.Option(
            "--show-completion",
            metavar="[SHELL]",
            callback=completion.show,
            is_eager=True,
            help="Print the script that does it.",
        ),
    ] = None,
) -> None:
    """A co-simulation bench for electric-vehicle control: FMUs on a CAN bus.

    Start with: evcosim run scooter
    """
    # --debug is declared here for --help; `failures.guarded` takes it wherever it stands
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
        raise typer.Exit(2)
