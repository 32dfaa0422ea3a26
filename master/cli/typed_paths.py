"""The paths that are typed for a verb, checked before it does anything."""

from __future__ import annotations

import functools
import typing
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeVar

T = TypeVar("T")


def checks_paths(verb: Callable[..., T]) -> Callable[..., T]:
    """Let a verb refuse paths that no file can have: one with a name that is too long, for instance.

    The ConfigError names the option, the path, the rule and the value.
    """

    @functools.wraps(verb)
    def checked(**arguments: Any) -> T:
        from ...cosim.errors import ConfigError
        from ...cosim.file_names import flaw_of_name, short_path

        for name, value in arguments.items():
            if isinstance(value, Path) and (flaw := flaw_of_name(value)):
                raise ConfigError(f"{_typed(verb, name)} {short_path(value)}: {flaw}")
        return verb(**arguments)

    return checked


def check_given(arguments: Sequence[str]) -> None:
    """Raise ConfigError for an argument or a value that is empty, as "$DIR" is where DIR is not set.

    An empty path would be taken for the working folder, an empty name for the default.
    """
    from ...cosim.errors import ConfigError

    for before, argument in pairwise(["", *arguments]):
        option = before if not argument else argument[:-1]
        if not argument or (argument.startswith("--") and argument.find("=") == len(argument) - 1):
            place = f"{option} ''" if option.startswith("-") else "''"
            raise ConfigError(f"{place}: the text is empty, where a value is needed")


def _typed(verb: Callable[..., Any], name: str) -> str:
    """Return how a parameter of a verb is typed: `--output`, or the name of an argument in the help."""
    hints = typing.get_type_hints(verb, localns={"RunOptions": Any}, include_extras=True)
    (about,) = hints[name].__metadata__
    given = (about.default, *(about.param_decls or ()))  # typer's own signature has a default first
    declared = [text for text in given if str(text).startswith("--")]
    if declared:
        return str(declared[0])
    return about.metavar if type(about).__name__ == "ArgumentInfo" else f"--{name.replace('_', '-')}"
