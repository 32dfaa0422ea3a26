"""The command that repeats a run, made of the options that the run was given."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any

from ..system.run_options import RunOptions

_NAMED = {
    "parameters": "--set", "start": "--start", "inputs": "--input", "fmus": "--fmu", "swaps": "--swap",
}  # fmt: skip # a table: the option of the library, and that of the command line
_VALUES = (
    *("delay", "algorithm", "stop_time", "step_size", "interface", "tolerance", "isolation", "engine"),
    "units",
)
_FLAGS = ("allow_open", "ideal", "trust", "strict")
_PLAIN = re.compile(r"(?!(?:true|false|inf|nan)$)[A-Za-z_./~][\w./~:-]*")


def given_options(options: RunOptions) -> dict[str, Any]:
    """Return the options that were given, without those that are as if they were not (JSON-able)."""
    kept: dict[str, Any] = {name: value for name, value in options.items() if not _is_nothing(value)}
    if bus := options.get("bus"):
        kept["bus"] = {"delay_steps": bus.delay_steps, "resolution": bus.resolution, "cycle": bus.cycle}
    return kept


def command_of(target: str, scenario: str, options: Mapping[str, Any]) -> str:
    """Return the command that runs `target` again, in the scenario ("": its own), from the same folder.

    `options` are those of `given_options`. "" where no command says the same: a system made in memory, or
    the variation of buses that only Python has.
    """
    if not target or "bus" in options:
        return ""
    words = ["evcosim", "run", target, *(["--scenario", scenario] if scenario else [])]
    for name, flag in _NAMED.items():
        for key, value in options.get(name, {}).items():
            words += [flag, f"{key}={_written(value)}"]
    for name in _VALUES:
        if name in options:
            words += [_flag(name), _written(options[name])]
    for pattern in options.get("record", ()):
        words += ["--record", pattern]
    words += [_flag(name) for name in _FLAGS if options.get(name)]
    return shlex.join(words)


def _is_nothing(value: object) -> bool:
    return value is None or value is False or (isinstance(value, Mapping | list) and not value)


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


def _written(value: Any) -> str:
    """Return a value as the command line reads it: a text in quotes where it would be another value."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return repr(float(value))
    text = str(value)
    return text if _PLAIN.fullmatch(text) else json.dumps(text, ensure_ascii=False)
