"""`evcosim build`: the built-in FMUs and those of models of one's own as files, in Python or native."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import completion
from .once import OnceCommand

if TYPE_CHECKING:
    from ..builtin import Wanted


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
    native: Annotated[
        str | None,
        typer.Option(
            "--native",
            metavar="[=require]",
            help="Machine code that needs no Python; a model that cannot be translated is left in Python, "
            "with the reason; '--native=require' refuses it.",
        ),
    ] = None,
    platform: Annotated[
        list[str] | None,
        typer.Option(
            "--platform",
            metavar="NAME",
            help="Of native FMUs: linux64, win64, darwin64, aarch64-linux or aarch64-darwin; several with "
            "one --platform for each; default: this machine's.",
        ),
    ] = None,
    fmi: Annotated[
        int | None, typer.Option("--fmi", metavar="2|3", help="Version of FMI of native FMUs; default: 2.")
    ] = None,
) -> None:
    """Build FMUs, built-in ones or those of your own models, and print where they are.

    Without a Python file the engine is compiled too, with the frames of buses, for later runs.
    """
    from ..builtin import build_fmu, build_models, builtin_names
    from ..engine.selection import compile_engine
    from .failures import complain

    known = builtin_names()
    own = [name for name in names or () if name.endswith(".py")]
    _check_names([name for name in names or () if name not in own], known)
    how = _native(native, platform or [], fmi)
    for name in dict.fromkeys(names or known):
        for made in build_models(Path(name), output, how) if name in own else [build_fmu(name, output, how)]:
            if said := f"left in Python, because {made.left}" if made.left else made.library:
                print(f"{made.name}: {said}")
            print(made.path)
    if not own and how is None and (notice := compile_engine()):
        complain(f"warning: {notice}")


def _check_names(names: Sequence[str], known: Sequence[str]) -> None:
    """Raise ConfigError for a name that is neither that of a built-in FMU nor a Python file."""
    from ...cosim.errors import ConfigError, nearest
    from ...cosim.system.kinds import kind_of

    for name in names:
        if name not in known:
            if said := kind_of(Path(name), "model"):
                raise ConfigError(f"{said}; a model is Python code (.py)")
            raise ConfigError(
                f"there is no built-in FMU '{name}'{nearest(name, known)}; there are {', '.join(known)}; a "
                "model of your own is a Python file (.py)"
            )


class BuildCommand(OnceCommand):
    """The verb `build`, whose option --native may have a value, after a `=`, or none."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments, with --native by itself as --native=auto."""
        end = args.index("--") if "--" in args else len(args)
        return super().parse_args(ctx, [*(_WITH.get(arg, arg) for arg in args[:end]), *args[end:]])


_WITH = {"--native": "--native=auto"}


def _native(native: str | None, platforms: list[str], fmi: int | None) -> Wanted | None:
    """Return the native FMUs that are asked for; None for FMUs of Python. Raises ConfigError."""
    from ...cosim.errors import ConfigError, nearest
    from ..builtin import wanted

    if native is None:
        for option, given in (("--platform", bool(platforms)), ("--fmi", fmi is not None)):
            if given:
                raise ConfigError(f"{option} is for native FMUs: add --native")
        return None
    if native not in ("auto", "require"):
        raise ConfigError(
            f"--native={native}: there is --native and --native=require{nearest(native, ['require'])}"
        )
    if fmi not in (None, 2, 3):
        raise ConfigError(f"--fmi {fmi}: native FMUs are of FMI 2 or 3")
    return wanted(native == "require", tuple(dict.fromkeys(platforms)), fmi or 2)
