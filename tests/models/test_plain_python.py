"""Models of the catalog are plain Python: the standard library alone, and what no version changes."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from evcosim import models
from evcosim.fmus.catalog import CATALOG, model_file

FOLDER = Path(models.__file__ or "").parent

ALONE = """
import importlib, math, sys
sys.modules["numpy"] = sys.modules["scipy"] = None
from evcosim.fmus.catalog import CATALOG
from evcosim.models.base import variables
for name, entry in CATALOG.items():
    model = getattr(importlib.import_module(f"evcosim.models.{entry.module}"), name)
    p, u = model.Parameters(), model.Inputs()
    x = model.initial(p, u)
    for _ in range(100):
        x = model.step(p, x, u, 0.01)
        y = model.outputs(p, x, u) if model.feeds_through() else model.outputs(p, x)
    assert all(math.isfinite(getattr(y, v.name)) for v in variables(model.Outputs)), name
    print(name)
"""


def test_every_model_runs_without_numpy_and_scipy(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", ALONE], capture_output=True, text=True, cwd=tmp_path)
    assert done.stderr == ""
    assert done.stdout.split() == list(CATALOG)


def reached(name: str) -> dict[str, ast.Module]:
    """The modules that a model is made of, by name, itself too; `base` declares and calculates nothing."""
    found: dict[str, ast.Module] = {}
    waiting = [model_file(name).stem]
    while waiting:
        module = waiting.pop()
        if module in found or module == "base":
            continue
        found[module] = ast.parse((FOLDER / f"{module}.py").read_text(encoding="utf-8"))
        waiting += [
            n.module
            for n in ast.walk(found[module])
            if isinstance(n, ast.ImportFrom) and n.level and n.module
        ]
    return found


REFUSED: dict[str, tuple[type[ast.AST], ...]] = {
    "a comprehension": (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp),
    "lambda": (ast.Lambda,),
    "try": (ast.Try,),
    "import": (ast.Import, ast.ImportFrom),
}
CALLED = {"sum", "fsum", "sumprod", "zip", "sorted", "list", "tuple", "getattr", "attrgetter", "partial"}
METHODS = {"append", "pop", "insert", "extend"}


def refused(tree: ast.Module) -> list[str]:
    """What in the functions of a module has no fixed size, or a meaning that depends on Python's version."""
    return [
        f"{function.name}: {found}"
        for function in (n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef))
        for statement in function.body
        for node in ast.walk(statement)
        if (found := offence(node))
    ]


def offence(node: ast.AST) -> str:
    """What is wrong with a part of a function, or nothing."""
    match node:
        case ast.Call(func=ast.Name(id=name)) if name in CALLED:
            return name
        case ast.Call(func=ast.Attribute(attr=name)) if name in METHODS:
            return name
        case ast.Constant(value=complex()):
            return "a complex constant"
    return next((what for what, kinds in REFUSED.items() if isinstance(node, kinds)), "")


@pytest.mark.parametrize("name", CATALOG)
def test_a_model_is_written_in_loops_of_floats(name: str) -> None:
    for module, tree in reached(name).items():
        assert refused(tree) == [], module


def test_the_rules_find_what_they_forbid() -> None:
    code = (
        "def f(p):\n import numpy\n try:\n  pass\n finally:\n  pass\n a = [x for x in p]\n a.append(1.0)\n"
        " return sum(a), (lambda: 1j)()\n"
    )
    assert len(refused(ast.parse(code))) == 7
