"""Libraries of native FMUs, compiled once by each process that runs tests: the same sources give the same.

That a compiler does so each time is what tests/fmus/native/test_build.py shows, which lets them be forgotten.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from evcosim.fmus.native import toolchain

_COMPILED = toolchain.compiled
_OWN = {name: shutil.which(name) for name in ("cc", "gcc", "clang")}
"""The compilers of this machine: those that a test writes are asked each time."""
_MADE: dict[tuple[object, ...], bytes] = {}


@pytest.fixture
def compiled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compile the same sources once, whoever asks."""
    monkeypatch.setattr(toolchain, "compiled", _compiled)


def forget() -> None:
    """Let all be compiled again."""
    _MADE.clear()


def _compiled(
    folder: Path, sources: Sequence[str], target: toolchain.Platform, command: Sequence[str] = ()
) -> bytes:
    command = command or toolchain.compiler(target)
    path = shutil.which(command[0])
    if path is None or path != _OWN.get(command[0]):
        return _COMPILED(folder, sources, target, command)
    files = tuple((file.name, file.read_bytes()) for file in sorted(folder.iterdir()) if file.is_file())
    key = (path, *command[1:], target, *sources, files)
    if key not in _MADE:
        _MADE[key] = _COMPILED(folder, sources, target, command)
    return _MADE[key]
