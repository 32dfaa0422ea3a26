"""The command line that does again what this command does."""

from __future__ import annotations

import enum
import shlex
from collections.abc import Iterator
from typing import Any

import typer


def repeating(context: typer.Context, *without: str) -> str:
    """Return the command as it was typed, its options in the order in which they are declared.

    Options named in `without`, as "output", are left out: they say where results go and what is printed.
    """
    words = ["evcosim", context.info_name or ""]
    options: list[str] = []
    for parameter in context.command.params:
        name = parameter.name or ""
        source = context.get_parameter_source(name)
        if name in without or source is None or source.name != "COMMANDLINE":
            continue
        values = list(_texts(context.params[name]))
        if parameter.param_type_name == "argument":
            words += values
        elif getattr(parameter, "is_flag", False):
            options.append(parameter.opts[0])
        else:
            options += [text for value in values for text in (parameter.opts[0], value)]
    return shlex.join([*words, *options])


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, list | tuple):
        for each in value:
            yield from _texts(each)
    else:
        yield str(value.value if isinstance(value, enum.Enum) else value)
