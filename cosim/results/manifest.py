"""run.json, which stands beside results.csv: facts of the run as a whole, and of each variable."""

from __future__ import annotations

import dataclasses
import errno
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ..errors import ConfigError, short
from ..reading import content
from ..row_store import write_all
from ..visible import visible_json
from ..writing import finite, replacing
from .variable import ResultVariable

_BEGIN = b'{"evcosim"'  # of a run.json, without white space
_TYPES = ("Real", "Integer", "Boolean", "Enumeration", "String")


def write_manifest(
    path: Path, manifest: Mapping[str, Any], variables: Iterable[ResultVariable], spare: int = 0
) -> None:
    """Write a manifest, and under "variables" the description of each variable.

    Numbers that are not finite become null: JSON has no name for them. `spare` bytes at the end are for
    `overwrite_manifest`. Raises ConfigError where the file cannot be written; then none is left half-done.
    """
    about = {**manifest, "variables": [described(v) for v in variables]}
    with replacing(path) as file:
        file.write(manifest_text(about) + b" " * spare + b"\n")


def overwrite_manifest(path: Path, manifest: Mapping[str, Any], variables: Iterable[ResultVariable]) -> None:
    """Write a manifest into the place of one that is there: on a full disk there is no room beside it.

    It is one line then, which needs less. Raises OSError where the disk refuses that too, or it is too short.
    """
    about = {**manifest, "variables": [described(v) for v in variables]}
    text = manifest_text(about, indent=None)
    descriptor = os.open(path, os.O_WRONLY | getattr(os, "O_NOFOLLOW", 0))
    with open(descriptor, "wb", buffering=0) as file:
        room = os.fstat(descriptor).st_size - 1
        if len(text) > room:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write_all(file, memoryview(text.ljust(room) + b"\n"))


def manifest_text(about: Mapping[str, Any], indent: int | None = 2) -> bytes:
    """Return facts as JSON; without an indent it is one line."""
    text = json.dumps(finite(about), indent=indent, allow_nan=False, ensure_ascii=False)
    return visible_json(text).encode()


def read_manifest(path: Path) -> tuple[dict[str, Any], dict[str, ResultVariable]]:
    """Return the manifest in a run.json, and by name the variables that it describes.

    Both are empty where there is no file. Raises ConfigError naming a file that cannot be read, is no JSON,
    or does not describe variables.
    """
    manifest = _read(path)
    return manifest, variables_in(manifest.pop("variables", []), path)


def described(variable: ResultVariable) -> dict[str, Any]:
    """Return the description of a variable as JSON has it; `variables_in` reads it."""
    about = dataclasses.asdict(variable)
    for name in ("items", "difference"):
        if not about[name]:
            del about[name]
    return about


def _read(path: Path) -> dict[str, Any]:
    if not path.is_file():
        return {}
    text = content(path)
    try:
        manifest = from_json(text.decode("utf-8"))
    except ValueError as error:
        advice = f"; it was cut off: 'evcosim results recover {path.parent}' mends it" if is_cut(path) else ""
        raise ConfigError(f"{path}: is not a JSON file: {error}{advice}") from error
    if not isinstance(manifest, dict):
        raise ConfigError(f"{path}: a JSON object is needed, not {type(manifest).__name__}")
    return manifest


def is_cut(path: Path) -> bool:
    """Return True for a run.json that begins as one and is no JSON: its end is missing, or is zeros."""
    try:
        with path.open("rb") as file:
            begin = b"".join(file.read(4 * len(_BEGIN)).split()).rstrip(b"\0")
        if not (begin.startswith(_BEGIN) or _BEGIN.startswith(begin)):
            return False
        from_json(content(path))
    except (OSError, ConfigError):
        return False
    except ValueError:
        return True
    return False


def from_json(text: str | bytes) -> Any:
    """Return what a JSON text says. Raises ValueError, also for one that is nested too deep."""
    try:
        return json.loads(text)
    except RecursionError as error:
        raise ValueError("it is nested too deep") from error


def variables_in(descriptions: Any, place: Path) -> dict[str, ResultVariable]:
    """Return by name the variables that are described. Raises ConfigError naming the file `place`."""
    try:
        found = [
            ResultVariable(**{**about, "items": tuple((int(v), str(n)) for v, n in about.get("items", ()))})
            for about in descriptions
        ]
        for variable in found:
            _check_types(variable)
    except (TypeError, ValueError, AttributeError, OverflowError) as error:
        raise ConfigError(f"{place}: 'variables' does not describe the variables: {error}") from error
    return {v.name: v for v in found}


def _check_types(variable: ResultVariable) -> None:
    """Raise TypeError for a key of another type than it is declared with, ValueError for no FMI type."""
    for field in dataclasses.fields(variable):
        value = getattr(variable, field.name)
        wanted = {"str": str, "bool": bool}.get(str(field.type))
        if wanted is not None and not isinstance(value, wanted):
            raise TypeError(f"{field.name} = {short(value)} of {short(variable.name)}")
    if variable.type not in _TYPES:
        raise ValueError(
            f"type = {short(variable.type)} of {short(variable.name)}: it is {', '.join(_TYPES)}"
        )


def check_whole(path: Path, count: int, wanted: object) -> None:
    """Raise ConfigError for a results.csv that has fewer rows than run.json says: it was cut off."""
    if isinstance(wanted, int) and count < wanted:
        raise ConfigError(
            f"{path}: has {count} rows, where run.json says {short(wanted)}: the file was cut off. 'evcosim "
            "results recover' makes results of the rows that are left"
        )
