"""Names of modules, before any of their code runs."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest

from evcosim.cosim.can.protection.module_names import bound_names, installed

BOUND = b"""# -*- coding: latin-1 -*-
import os.path, json as j
from math import floor, ceil as up
try:
    def one(): local = 1
except ImportError as error:
    one = None
if sys_is_odd:
    class Two:
        inner = 3
for three in ():
    with open(x) as four: (five, [six]) = 1, [2]
eight: int = 8
def makes():
    global nine
    nine = 9
print(ten := 10, "\xe9")
"""


def test_names_are_those_of_the_module_alone() -> None:
    assert bound_names(BOUND, "m.py") == {
        "os", "j", "floor", "up", "one", "error", "Two", "three", "four", "five", "six", "eight", "makes",
        "nine", "ten",
    }  # fmt: skip # a list


@pytest.mark.parametrize(
    "source",
    ["from os import *", "globals()['f'] = 1", "exec('f = 1')", "def __getattr__(name): return f"],
)
def test_a_module_may_bind_more_than_it_says(source: str) -> None:
    assert bound_names(source.encode(), "m.py") is None


@pytest.mark.parametrize("source", [b"def f(:", b"x = 1\x00", b"\xff", b"# coding: no-such\n"])
def test_what_is_no_python_is_an_error(source: bytes) -> None:
    with pytest.raises((SyntaxError, ValueError)):
        bound_names(source, "m.py")


def test_installed_modules_are_found_and_not_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inner = tmp_path / "pack_of_sums" / "inner"
    inner.mkdir(parents=True)
    for folder in (inner.parent, inner):
        (folder / "__init__.py").write_text("raise RuntimeError\n")
    (inner / "deep.py").write_text("raise RuntimeError\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    assert installed("pack_of_sums.inner.deep") == (True, inner / "deep.py")
    assert installed("pack_of_sums.inner") == (True, inner / "__init__.py")
    assert installed("pack_of_sums.outer.deep") == (False, None)
    assert installed("no_pack_of_sums.inner") == (False, None)
    assert installed("math") == installed("os.path") == (True, None)
    assert not any(name.startswith("pack_of_sums") for name in sys.modules)
