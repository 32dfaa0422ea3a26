"""The cache of the kernel has another folder as soon as one of the kernel's sources is another."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

from evcosim.master.engine.compiled import cache, kernel


def imported(module: ModuleType) -> set[str]:
    """The names of the modules of this project that a module imports as soon as it is loaded itself."""
    found = set()
    for node in ast.parse(Path(module.__file__ or "").read_text()).body:
        if isinstance(node, ast.ImportFrom) and node.level:
            origin = importlib.util.resolve_name("." * node.level + (node.module or ""), module.__package__)
            inner = {f"{origin}.{alias.name}" for alias in node.names}
            found |= {name for name in inner if name in sys.modules} or {origin}
    return found


def test_the_sources_are_the_kernel_and_all_that_it_imports() -> None:
    known, new = set(), {kernel.__name__}
    while new:
        known |= new
        new = {name for each in new for name in imported(importlib.import_module(each))} - known
    assert {module.__name__ for module in cache.SOURCES} == known


@pytest.mark.parametrize("place", range(len(cache.SOURCES)))
def test_another_source_gives_another_folder(
    place: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = cache._folder()[0]
    changed = tmp_path / "changed.py"
    changed.write_bytes(Path(cache.SOURCES[place].__file__ or "").read_bytes() + b"\n")
    monkeypatch.setattr(cache.SOURCES[place], "__file__", str(changed))
    assert cache._folder()[0] != before
