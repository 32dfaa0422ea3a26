"""The application: its verbs, and the options before the verb."""

from __future__ import annotations

import functools
import importlib
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

import typer

from . import completion
from .once import OnceCommand
from .typed_paths import checks_paths

_PLAIN: dict[str, Any] = {
    "add_completion": False,  # its options cannot name a shell; ours stand below
    "rich_markup_mode": None,  # rich's boxes would cost a third of the time that --help may take
    "pretty_exceptions_enable": False,
}
_VERBS = {
    "run": ".run:run",
    "new": ".new:new",
    "list": ".listing:list_",
    "info": ".info:info",
    "check": ".check:check",
    "plot": ".plot:plot",
    "compare": ".compare:compare",
    "identify": ".identify:identify",
    "reproduce": ".reproduce:reproduce",
    "build": ".build:build",
    "compile": ".compile:compile_",
    "budget": ".budget:budget",
    "bus": ".bus:bus",
    "schema": ".schema:schema",
    "results": ".results:results",
}
"""The modules of the verbs, and their functions in these."""
_OF_CLASS = {"build": ".build:BuildCommand"}


@functools.cache
def command() -> Any:
    """The click command of `evcosim` with all its verbs."""
    app = typer.Typer(name="evcosim", context_settings={"help_option_names": ["-h", "--help"]}, **_PLAIN)
    app.callback(invoke_without_command=True)(_global_options)
    group = typer.main.get_command(app)
    group.commands = Verbs()  # type: ignore[attr-defined] # of a group, which it is
    return group


class Verbs(Mapping[str, Any]):
    """The click commands of the verbs by name, each made when it is asked for.

    A command has one verb, and what the others are made of takes longer than a short run.
    """

    def __init__(self) -> None:
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            self._made[name] = _made(name)
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(_VERBS)

    def __len__(self) -> int:
        return len(_VERBS)

    def __contains__(self, name: object) -> bool:
        return name in _VERBS


def _made(name: str) -> Any:
    """Make the click command of a verb, which may be a group of verbs. Raises KeyError for no verb."""
    verb = _imported(_VERBS[name])
    if not isinstance(verb, typer.Typer):
        app, kind = typer.Typer(**_PLAIN), _imported(_OF_CLASS[name]) if name in _OF_CLASS else OnceCommand
        app.command(name, cls=kind)(checks_paths(verb))
        verb = app
    made = typer.main.get_command(verb)
    made.name = name
    return made


def _imported(place: str) -> Any:
    """Return what "module:name" names in this package."""
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(module, __package__), name)


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
