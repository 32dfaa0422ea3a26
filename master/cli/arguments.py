"""The parsers of options such as `--set unit.parameter=value`, `--fmu unit=PATH` and `--try 5s`."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ...cosim.errors import ConfigError
from ...cosim.interface import Value


def parse_settings(
    options: Sequence[str], of_fmu: bool = False, typed: str = "--set", example: str = "mass=180"
) -> dict[str, Value]:
    """Return `--set` or other `typed` options as "unit.parameter" to value.

    Those `of_fmu` by itself have its own names of variables. Raises ConfigError, also for a name that is
    given twice.
    """
    kind = "parameter" if typed == "--set" else "variable"
    values: dict[str, Value] = {}
    given: dict[str, str] = {}
    for option in options:
        name, equals, text = (part.strip() for part in option.partition("="))
        unit, _, parameter = ("fmu", ".", name) if of_fmu else name.partition(".")
        if not (equals and unit and parameter and text):
            written = (
                f"{kind}=value, as in {example}" if of_fmu else f"unit.{kind}=value, as in vehicle.{example}"
            )
            raise ConfigError(f"{typed} {option}: it is written {written}")
        _note(given, typed, option, name)
        values[name] = scalar(text)
        if isinstance(values[name], str) and text[0] not in "\"'" and _TWO.search(text):
            raise ConfigError(f"{typed} {option}: two values; {typed} is given for each of them")
    return values


_TWO = re.compile(r"[,;\s]\s*[A-Za-z_][\w.\[\]]*\s*=")  # another name and '=' behind a value


def parse_inputs(options: Sequence[str]) -> dict[str, Value | Path]:
    """Return `--input` options as name to value, or to the text of a CSV file.

    Raises ConfigError, also for an input that is given twice.
    """
    values: dict[str, Value | Path] = {}
    given: dict[str, str] = {}
    for option in options:
        name, _, text = (part.strip() for part in option.partition("="))
        if not (name and text):
            raise ConfigError(f"--input {option}: it is written NAME=X, as in u=3.5 or u=table.csv")
        _note(given, "--input", option, name)
        values[name] = scalar(text)
    return values


def scalar(text: str) -> Value:
    """Return a value that is written as in TOML: true, false, a number, a quoted string; else the text."""
    import tomllib

    from ...cosim.system.toml_text import parsed

    with contextlib.suppress(tomllib.TOMLDecodeError):  # then it is plain text
        value = parsed(f"value = {text}")["value"] if "\n" not in text else text
        if isinstance(value, bool | int | float | str):
            return value
    try:
        return float(text)  # ".5", "1.", "1e3" in Python's spelling
    except ValueError:
        return text


def parse_files(option: str, given: Sequence[str], example: str) -> dict[str, str]:
    """Return options unit=PATH (or built-in name) as unit to path.

    Raises ConfigError, also for a unit that is given twice.
    """
    paths: dict[str, str] = {}
    noted: dict[str, str] = {}
    for text in given:
        unit, _, path = (part.strip() for part in text.partition("="))
        if not (unit and path):
            raise ConfigError(f"{option} {text}: it is written unit=PATH, as in vehicle={example}")
        _note(noted, option, text, unit, "unit ")
        paths[unit] = path
    return paths


def _note(given: dict[str, str], option: str, text: str, name: str, kind: str = "") -> None:
    """Note what was given for a name. Raises ConfigError with both texts where something was before."""
    if name in given:
        raise ConfigError(f"{option} {text}: {kind}'{name}' is given already: {option} {given[name]}")
    given[name] = text


_FLAGS = {
    "stop_time": "--stop-time", "step_size": "--step-size", "delay": "--delay", "record": "--record",
    "interface": "--interface", "tolerance": "--tolerance", "inputs": "--input", "fmus": "--fmu",
    "swaps": "--swap", "ideal": "--ideal",
}  # fmt: skip # a table: the option of the library, and that of the command line


@contextlib.contextmanager
def as_typed(
    settings: Sequence[str],
    fmus: Sequence[str] = (),
    inputs: Sequence[str] = (),
    starts: Sequence[str] = (),
    *,
    names: Mapping[str, str | None] | None = None,
) -> Iterator[None]:
    """Put the option that was typed into an error: `--set` for its parameter, `--fmu` for its unit.

    `names` are options of one name each: `input` with the text of `--input`.
    """
    places = {f"{name} {text}:": f"--{name} {text}:" for name, text in (names or {}).items() if text}
    for word, flag, given in (("parameter", "--set", settings), ("start", "--start", starts)):
        for option in given:
            typed = f"{flag} {option}:"
            places |= dict.fromkeys((f"{word} {_name(option)}:", f"{word} fmu.{_name(option)}:"), typed)
    places |= {f"input {_name(option)}:": f"--input {option}:" for option in inputs}
    places |= {f"input fmu.{_name(option)}.constant:": f"--input {option}:" for option in inputs}
    for option in fmus:
        unknown = f"there is no unit '{_name(option)}'"
        places |= {f"fmus: {unknown}": f"--fmu {option}: {unknown}"}
        places |= {f"fmus.{_name(option)}:": f"--fmu {_name(option)}:"}
    try:
        yield
    except ConfigError as error:
        for place, typed in places.items():
            if str(error).startswith(place):
                first, *others = error.lines
                raise ConfigError(f"{typed}{first.removeprefix(place)}", *others) from error
        first, *others = error.lines
        word, space, rest = first.partition(" ")
        name = word.removesuffix(":")
        if space and name in _FLAGS:
            raise ConfigError(f"{_FLAGS[name]}{word.removeprefix(name)} {rest}", *others) from error
        raise


def _name(option: str) -> str:
    return option.partition("=")[0].strip()


def seconds(option: str, text: str) -> float:
    """Return the time [s] that is written as "5s", "500ms" or "5". Raises ConfigError."""
    found = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(ms|s|)\s*", text)
    value = float(found[1]) * (1e-3 if found[2] == "ms" else 1.0) if found else 0.0
    if not 0.0 < value <= 3600.0:
        raise ConfigError(f"{option} {text}: it is a time of up to an hour, written 5s or 500ms")
    return value
