"""FMUs of models of the user's own whose Python files have been changed since the FMU was built."""

from __future__ import annotations

import hashlib
import re
import shlex
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from .recipes import PYTHON_FILES
from .records import folder_of
from .sources import Source, rewritten

_RESOURCES = "resources/"
_MODEL = re.compile(r"^from \.(\S+) import \S+ as Model$", re.MULTILINE)  # the line of build's _ENTRY
_UNREADABLE = (OSError, zipfile.BadZipFile, KeyError, UnicodeDecodeError)


class Changed(NamedTuple):
    """A Python file that has changed, the file of the model, and the options with which its FMU was built."""

    file: Path
    model: Path
    options: str


class _Carried(NamedTuple):
    """The user's Python files of an FMU: that of the model, and each with a test that it has not changed."""

    model: str
    files: dict[str, Callable[[Path], bool]]
    options: str = ""


def changed_source(fmu: Path, digest: str) -> Changed | None:
    """Return a Python file that is not as it was for the FMU of this SHA-256; None where all are.

    Files are looked up beside the FMU, else in the folder from which `build_model` made it for this user; one
    that is not there, as beside a copy of the FMU, has not changed. Nor has any where the FMU cannot be read,
    or was not built by evcosim.
    """
    try:
        return next(_changed(fmu, digest), None)
    except _UNREADABLE:
        return None


def model_files(fmu: Path) -> list[Path]:
    """Return the files, by their real paths, that can be the one of whose model evcosim built an FMU.

    They are those that are there, beside the FMU and in the folder from which `build_model` made it.
    """
    try:
        digest = hashlib.sha256(fmu.read_bytes()).hexdigest()
        with zipfile.ZipFile(fmu) as archive:
            carried = _carried(archive)
    except _UNREADABLE:
        return []
    return [(folder / carried.model).resolve() for folder in _folders(carried, fmu, digest)]


def _folders(carried: _Carried, fmu: Path, digest: str) -> list[Path]:
    """Return the folders in which the file of the model is."""
    folders = (fmu.resolve().parent, *folder_of(digest))
    return [folder for folder in folders if carried.model and (folder / carried.model).is_file()]


def _changed(fmu: Path, digest: str) -> Iterator[Changed]:
    with zipfile.ZipFile(fmu) as archive:
        carried = _carried(archive)
    for folder in _folders(carried, fmu, digest)[:1]:
        for place, is_same in carried.files.items():
            if (folder / place).is_file() and not is_same(folder / place):
                yield Changed(folder / place, folder / carried.model, carried.options)


def _carried(archive: zipfile.ZipFile) -> _Carried:
    """Return the files of which an FMU was built. Raises KeyError for one that says nothing of them."""
    return _named(archive) if PYTHON_FILES in archive.namelist() else _embedded(archive)


def _named(archive: zipfile.ZipFile) -> _Carried:
    """Return the files that a native FMU names, with their digests."""
    lines = [line.partition("  ") for line in archive.read(PYTHON_FILES).decode().splitlines()]
    names = archive.namelist()
    platforms = sorted({name.split("/")[1] for name in names if name.startswith("binaries/")})
    options = " --native" + " --fmi 3" * ("sources/fmi3.c" in names)
    if len(platforms) > 1:
        options += "".join(f" --platform {shlex.quote(each)}" for each in platforms)
    return _Carried(
        lines[0][2] if lines else "", {place: _has(digest) for digest, _, place in lines}, options
    )


def _has(digest: str) -> Callable[[Path], bool]:
    return lambda file: hashlib.sha256(file.read_bytes()).hexdigest() == digest


def _embedded(archive: zipfile.ZipFile) -> _Carried:
    """Return the files that an FMU of pythonfmu carries."""
    package = _identity(archive)
    start = f"{_RESOURCES}{package}/"
    places = [name.removeprefix(start) for name in archive.namelist() if name.startswith(start)]
    modules = {_module(place): place for place in places if place.endswith(".py")}
    embedded = {name for name in modules if not _is_in(name, "pythonfmu")} - {"", "entry", "evcosim"}
    own = {name: modules[name] for name in sorted(embedded) if not _is_in(name, "evcosim")}

    def is_same(name: str, carried: bytes) -> Callable[[Path], bool]:
        return lambda file: _as_carried(file, name, package, embedded) == carried

    files = {place: is_same(name, archive.read(start + place)) for name, place in own.items()}
    return _Carried(own.get(_model(archive, package), ""), files)


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


def _as_carried(file: Path, module: str, package: str, embedded: set[str]) -> bytes:
    """Return a file as an FMU that is built now would carry it; one that cannot be built as it is."""
    source = Source(module, file, file.read_bytes())
    try:
        return rewritten(source, package, embedded)
    except ValueError:  # no Python, as it stands there now
        return source.content
