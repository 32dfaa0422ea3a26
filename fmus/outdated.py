"""FMUs of models of the user's own whose Python files have been changed since the FMU was built."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

from .records import folder_of
from .sources import Source, rewritten

_RESOURCES = "resources/"
_MODEL = re.compile(r"^from \.(\S+) import \S+ as Model$", re.MULTILINE)  # the line of build's _ENTRY
_UNREADABLE = (OSError, zipfile.BadZipFile, KeyError, UnicodeDecodeError)


def changed_source(fmu: Path, digest: str) -> tuple[Path, Path] | None:
    """Return a Python file that is not as the FMU of this SHA-256 carries it, and the file of its model.

    None where all are as they were. Files are looked up beside the FMU, else in the folder from which
    `build_model` made it for this user; one that is not there, as beside a copy of the FMU, has not changed.
    Nor has any where the FMU cannot be read, or was not built by evcosim.
    """
    try:
        return next(_changed(fmu, digest), None)
    except _UNREADABLE:
        return None


def carried_model(fmu: Path) -> str:
    """Return the module of the model in an FMU that evcosim built of a file; "" for any other file."""
    try:
        with zipfile.ZipFile(fmu) as archive:
            return _model(archive, _identity(archive))
    except _UNREADABLE:
        return ""


def _changed(fmu: Path, digest: str) -> Iterator[tuple[Path, Path]]:
    with zipfile.ZipFile(fmu) as archive:
        package = _identity(archive)
        model, start = _model(archive, package), f"{_RESOURCES}{package}/"
        places = [name.removeprefix(start) for name in archive.namelist() if name.startswith(start)]
        modules = {_module(place): place for place in places if place.endswith(".py")}
        embedded = {name for name in modules if not _is_in(name, "pythonfmu")} - {"", "entry", "evcosim"}
        own = {name: modules[name] for name in sorted(embedded) if not _is_in(name, "evcosim")}
        for folder in (fmu.resolve().parent, *folder_of(digest)):
            if model not in own or not (folder / own[model]).is_file():
                continue
            for name, place in own.items():
                carried = archive.read(start + place)
                if _as_carried(folder / place, name, package, embedded) not in (carried, None):
                    yield folder / place, folder / own[model]
            return


def _identity(archive: zipfile.ZipFile) -> str:
    """Return the name of the package in an FMU of pythonfmu. Raises KeyError for any other archive."""
    return archive.read(f"{_RESOURCES}slavemodule.txt").decode().strip().removesuffix("_slave")


def _model(archive: zipfile.ZipFile, package: str) -> str:
    found = _MODEL.search(archive.read(f"{_RESOURCES}{package}/entry.py").decode())
    return found[1] if found else ""


def _module(place: str) -> str:
    """Return the dotted name of a module by its path below the package; "" for the package itself."""
    return place.removesuffix(".py").removesuffix("__init__").rstrip("/").replace("/", ".")


def _is_in(module: str, package: str) -> bool:
    return module.partition(".")[0] == package


def _as_carried(file: Path, module: str, package: str, embedded: set[str]) -> bytes | None:
    """Return a file as an FMU that is built now would carry it; None for one that is not there.

    One from which none can be built is returned as it is.
    """
    if not file.is_file():
        return None
    source = Source(module, file, file.read_bytes())
    try:
        return rewritten(source, package, embedded)
    except ValueError:  # no Python, as it stands there now
        return source.content
