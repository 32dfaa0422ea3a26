"""The docstring of a model's module: its parts in one order, its equations in the code, its pointers in docs.

Name: one sentence.
Source: ...                      then the equations, numbered as in the paper, the first within ten lines
Deviations: ...                  from the source, where there are any
published: ..., inferred: ..., chosen: ...    the parameters
At the edges: ...
Step: ...                        integration, order, error
"""

from __future__ import annotations

import ast
import importlib
import inspect
import io
import pkgutil
import re
import tokenize
from pathlib import Path
from types import ModuleType

import pytest

import evcosim.models
from evcosim.models.base import Model

DOCS = Path(__file__).parents[2] / "docs" / "systems"
NO_EQUATIONS = ("base", "constants")
NUMBER = re.compile(r"\(([A-Z]?\d+)\)")
NUMBERED = re.compile(r" {4}.*? {2}((?:\([A-Z]?\d+\)(?:-|, )?)+)")
PART = re.compile(r"(Source|Deviations|published|inferred|chosen|At the edges|Step): \S")
POINTER = re.compile(r'"([^"]+)"\s+in\s+docs/systems/(\w+)\.md')

MODULES = [
    importlib.import_module(f"evcosim.models.{found.name}")
    for found in pkgutil.iter_modules(evcosim.models.__path__)
    if found.name not in NO_EQUATIONS
]
every_module = pytest.mark.parametrize("module", MODULES, ids=lambda m: m.__name__.rpartition(".")[2])


def lines_of(module: ModuleType) -> list[str]:
    """Return the lines of a module's docstring."""
    return inspect.cleandoc(module.__doc__ or "").splitlines()


def model_of(module: ModuleType) -> type[Model] | None:
    """Return the model that a module defines; None for a module that helps the others."""
    for content in vars(module).values():
        if inspect.isclass(content) and issubclass(content, Model) and content.__module__ == module.__name__:
            return content
    return None


def numbered(module: ModuleType) -> set[str]:
    """Return the numbers of the equations in a module's docstring; of a range, the first and the last."""
    ends = [match[1] for match in map(NUMBERED.fullmatch, lines_of(module)) if match]
    return {number for end in ends for number in NUMBER.findall(end)}


def commented(module: ModuleType) -> set[str]:
    """Return the numbers of equations that stand in the comments of a module's code."""
    tokens = tokenize.generate_tokens(io.StringIO(inspect.getsource(module)).readline)
    comments = " ".join(token.string for token in tokens if token.type == tokenize.COMMENT)
    return set(NUMBER.findall(comments))


@every_module
def test_the_first_line_is_a_name_and_a_sentence(module: ModuleType) -> None:
    name, colon, sentence = lines_of(module)[0].partition(": ")
    model = model_of(module)
    if model is not None:
        assert name == model.__name__
    else:
        assert name.lower().replace("-", " ") == module.__name__.rpartition(".")[2].replace("_", " ")
    assert colon
    assert sentence.endswith(".")


@every_module
def test_the_equations_begin_within_ten_lines_after_the_source(module: ModuleType) -> None:
    lines = lines_of(module)
    first = next(number for number, line in enumerate(lines, 1) if line.startswith("    "))
    source = next(number for number, line in enumerate(lines, 1) if line.startswith("Source: "))
    assert source < first <= 10
    assert numbered(module)


@every_module
def test_the_parts_stand_in_one_order_behind_the_equations(module: ModuleType) -> None:
    lines = lines_of(module)
    parts = [(number, match[1]) for number, match in enumerate(map(PART.match, lines)) if match]
    names = [name for _, name in parts]
    optional = ["Deviations", "inferred"] + ([] if model_of(module) else ["At the edges", "Step"])
    wanted = ["Source", "Deviations", "published", "inferred", "chosen", "At the edges", "Step"]
    assert names == [name for name in wanted if name in names]
    assert set(wanted) - set(names) <= set(optional)
    last_equation = max(number for number, line in enumerate(lines) if NUMBERED.fullmatch(line))
    assert all(number > last_equation for number, name in parts if name != "Source")


@every_module
def test_a_models_step_is_the_last_paragraph(module: ModuleType) -> None:
    paragraphs = "\n".join(lines_of(module)).split("\n\n")
    named = [k for k, paragraph in enumerate(paragraphs) if paragraph.startswith("Step: ")]
    assert named == [len(paragraphs) - 1] or (model_of(module) is None and not named)


@every_module
def test_every_numbered_equation_stands_at_a_line_of_the_code(module: ModuleType) -> None:
    assert numbered(module) - commented(module) == set()


@every_module
def test_every_number_in_the_code_is_an_equation_of_the_docstring(module: ModuleType) -> None:
    assert commented(module) - numbered(module) == set()


@every_module
def test_the_sections_of_the_docs_that_it_points_at_exist(module: ModuleType) -> None:
    text = " ".join(lines_of(module))
    pointers = POINTER.findall(text)
    assert len(pointers) == text.count("docs/")
    for title, page in pointers:
        content = (DOCS / f"{page}.md").read_text(encoding="utf-8")
        assert f"\n## {title}\n" in content or f"\n**{title}.**" in content, (title, page)


@pytest.mark.parametrize("module", list(pkgutil.iter_modules(evcosim.models.__path__)), ids=lambda m: m.name)
def test_a_shared_constant_is_written_once(module: pkgutil.ModuleInfo) -> None:
    """9.81 m/s2 and the 3.6 km/h in 1 m/s stand in `constants` alone, as literals and as names."""
    tree = ast.parse((Path(evcosim.models.__path__[0]) / f"{module.name}.py").read_bytes())
    literals = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    shared = {name for name in vars(importlib.import_module("evcosim.models.constants")) if name.isupper()}
    assigned = {
        target.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    if module.name == "constants":
        assert {3.6, 9.81} <= set(literals)
        assert assigned == shared
    else:
        assert not {3.6, 9.81} & {value for value in literals if isinstance(value, float)}
        assert not assigned & shared
