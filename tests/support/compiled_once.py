"""Objects and libraries of native FMUs, compiled once in a run of the tests: the same sources give the same.

Each C file is compiled by itself, as for a wheel, so that what all models share is compiled for the first of
them. That a compiler does so each time is what tests/fmus/native/test_build.py shows, which lets them be
forgotten.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from evcosim.fmus.native import toolchain

_COMPILED = toolchain.compiled
_OWN = {name: shutil.which(name) for name in ("cc", "gcc", "clang")}
"""The compilers of this machine: those that a test writes are asked each time."""
_FOLDER = Path(tempfile.gettempdir()) / "compiled"
"""One for all processes of a run."""
_begun: list[int] = []


@pytest.fixture
def compiled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compile the same sources once, whoever asks."""
    monkeypatch.setattr(toolchain, "compiled", _compiled)


def forget() -> None:
    """Let all be compiled again in this process."""
    _begun.append(os.getpid())


def _compiled(
    folder: Path, sources: Sequence[str], target: toolchain.Platform, command: Sequence[str] = ()
) -> bytes:
    command = command or toolchain.compiler(target)
    path = shutil.which(command[0])
    if path is None or path != _OWN.get(command[0]):
        return _COMPILED(folder, sources, target, command)
    made = (path, *command[1:], target, _begun)
    headers = [(file.name, file.read_bytes()) for file in sorted(folder.glob("*.h"))]
    objects = []
    for source in sources:
        if source.endswith(".c"):
            key = (made, source, headers, (folder / source).read_bytes())
            content = _kept(
                key, lambda source=source: toolchain.compiled_object(folder, source, target, command)
            )
            objects.append(Path(source).with_suffix(".o").name)
            (folder / objects[-1]).write_bytes(content)
        else:
            objects.append(source)
    linked = (made, [(name, (folder / name).read_bytes()) for name in objects])
    return _kept(linked, lambda: _COMPILED(folder, objects, target, command))


def _kept(key: object, make: Callable[[], bytes]) -> bytes:
    """Return what this key stands for, made by the first process that asks."""
    place = _FOLDER / hashlib.sha256(repr(key).encode()).hexdigest()
    if not place.exists():
        _FOLDER.mkdir(exist_ok=True)
        own = place.with_suffix(f".{os.getpid()}")
        own.write_bytes(make())
        own.replace(place)  # as a whole
    return place.read_bytes()
