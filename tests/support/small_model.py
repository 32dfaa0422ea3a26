"""Models of a few lines, each in a file of its own: what a construct of Python becomes."""

from __future__ import annotations

import hashlib
import importlib.util
import sys
import tempfile
import textwrap
from pathlib import Path
from typing import NamedTuple

from evcosim.models.base import Model

_TEXT = """from __future__ import annotations

import cmath
import dataclasses
import enum
import functools
import math
import operator
from dataclasses import dataclass
from enum import IntEnum
from functools import cache, cached_property, lru_cache, partial
from math import ceil, cos, exp, floor, sin, sqrt
from typing import NamedTuple

from evcosim.models.base import Model, record, var


class Mode(IntEnum):
    OFF = 0
    SLOW = 1
    FAST = 5


@@ABOVE@@


class Small(Model):
    @record
    class Parameters:
        a: float = var(1.5, "", "a")
        n: int = var(3, "", "n")
        mode: Mode = var(Mode.SLOW, "", "mode")
        on: bool = var(True, "", "on")

@@DERIVED@@

    @record
    class Inputs:
        u: float = var(1.0, "", "u")
        v: float = var(0.5, "", "v")
        k: int = var(2, "", "k")
        flag: bool = var(False, "", "flag")

    @record
    class State:
        x: float = var(1.0, "", "x")
        k: int = var(0, "", "k")
        on: bool = var(False, "", "on")
        mode: Mode = var(Mode.OFF, "", "mode")
@@STATE@@

    @record
    class Outputs:
        out: float = var(0.0, "", "out")

    @staticmethod
    def initial(p, u):
@@INITIAL@@

    @staticmethod
    def step(p, x, u, dt):
@@BODY@@

    @staticmethod
    def outputs(p, x):
        return Small.Outputs(x.x)
"""

_FOLDER = Path(tempfile.mkdtemp(prefix="small-models-"))


class Case(NamedTuple):
    """A step, what stands above the model, derived values of its parameters, and how the step is refused."""

    step: str
    above: str = ""
    derived: str = ""
    refused: str = ""
    state: str = ""
    initial: str = "return Small.State(0.5)"

    def model(self) -> type[Model]:
        """Return the model."""
        return small(self.step, self.above, self.derived, self.state, self.initial)


def cases(file: Path) -> dict[str, Case]:
    """Return the cases of a file by their names: `=== name`, then parts behind `--- step` and the like."""
    found = {}
    for text in file.read_text().split("=== ")[1:]:
        name, *parts = text.strip("\n").split("\n--- ")
        found[name] = Case(**dict(part.split("\n", 1) for part in parts))
    return found


def small(
    body: str, above: str = "", derived: str = "", state: str = "", initial: str = "return Small.State(0.5)"
) -> type[Model]:
    """Return a model whose step has this body, in a module with these lines above it.

    `state` are more fields of its state.
    """
    text = _TEXT.replace("@@ABOVE@@", textwrap.dedent(above).strip("\n"))
    parts = {"@@BODY@@": body, "@@DERIVED@@": derived, "@@STATE@@": state, "@@INITIAL@@": initial}
    for mark, part in parts.items():
        text = text.replace(mark, textwrap.indent(textwrap.dedent(part).strip("\n"), "        "))
    name = f"small_{hashlib.sha256(text.encode()).hexdigest()[:12]}"
    if name not in sys.modules:
        file = _FOLDER / f"{name}.py"
        file.write_text(text)
        spec = importlib.util.spec_from_file_location(name, file)
        assert spec is not None and spec.loader is not None
        module = sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    found: type[Model] = sys.modules[name].Small
    return found
