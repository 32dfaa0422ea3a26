"""The notebooks in examples/notebooks run from top to bottom, and say what is so.

Their outputs are cleared: the code cells are executed here in order, as a kernel would, and what ends a cell
is made to show itself. They use no magic, so that no kernel is needed.
"""

from __future__ import annotations

import ast
import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from support.needs import need_module

need_module("pandas")

ROOT = Path(__file__).parents[1]
BOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))


def cells(book: Path, kind: str) -> list[str]:
    """Return the sources of a notebook's cells of a kind."""
    content = json.loads(book.read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in content["cells"] if cell["cell_type"] == kind]


def shown(value: Any) -> Any:
    """Return what a notebook would show of a value: HTML, a picture, or a text."""
    for method in ("_repr_html_", "_repr_png_"):
        if (made := getattr(value, method, lambda: None)()) is not None:
            return made
    return repr(value)


def executed(book: Path) -> tuple[dict[str, Any], list[Any]]:
    """Execute the code cells in order; return the names that are there then, and what each cell shows."""
    names: dict[str, Any] = {"__name__": book.stem}
    outputs = []
    for number, source in enumerate(cells(book, "code"), 1):
        tree = ast.parse(source)
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        where = f"{book.name}, code cell {number}"
        exec(compile(tree, where, "exec"), names)
        if isinstance(last, ast.Expr):
            outputs.append(shown(eval(compile(ast.Expression(last.value), where, "eval"), names)))
    return names, outputs


def links(book: Path) -> list[str]:
    """Return the links of a notebook's texts that lead to a file."""
    found = re.findall(r"\]\(([^)\s]+)\)", "\n".join(cells(book, "markdown")))
    return [link.partition("#")[0] for link in found if not link.startswith("http")]


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Execute a notebook in an empty folder, from which it can import, as in Jupyter."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    return lambda name: executed(ROOT / "examples" / "notebooks" / f"{name}.ipynb")


def pictures(outputs: list[Any]) -> int:
    return sum(isinstance(each, bytes) and each.startswith(b"\x89PNG") for each in outputs)


@pytest.mark.parametrize("book", BOOKS, ids=lambda book: book.stem)
def test_a_notebook_is_as_it_is_kept(book):
    """Without outputs, as format 4.5 wants it; its links lead somewhere in the project."""
    assert links(book)
    assert [link for link in links(book) if not (book.parent / link).exists()] == []
    content = json.loads(book.read_text(encoding="utf-8"))
    assert (content["nbformat"], content["nbformat_minor"]) == (4, 5)
    found = content["cells"]
    assert len({cell["id"] for cell in found}) == len(found)
    for cell in found:
        code = {"execution_count": None, "outputs": []} if cell["cell_type"] == "code" else {}
        assert {key: cell[key] for key in cell if key not in ("source", "cell_type", "id")} == {
            "metadata": {},
            **code,
        }


def test_first_run(run):
    names, outputs = run("first_run")
    assert outputs[0].count("<img") == 1
    assert "highest speed over the bound" in outputs[0]
    assert pictures(outputs) == 1
    assert len(names["frame"]) == len(names["results"]) == 4001
    assert set(names["by_state"].index) == {"driver", "acceleration", "velocity"}
    over = {
        name: each.metrics["highest speed over the bound"].value for name, each in names["others"].items()
    }
    assert len(set(over.values())) == 3


def test_own_system(run):
    names, outputs = run("own_system")
    assert pictures(outputs) == 1
    assert names["after"].metrics["error"].value < names["before"].metrics["error"].value
    light, heavy, impossible = names["outcomes"]
    assert light.result() < heavy.result()
    assert "below the minimum" in impossible.failure.reason


def test_swap(run):
    names, outputs = run("swap")
    assert pictures(outputs) == 1
    assert names["tried"].returncode == 0, names["tried"].stdout
    assert names["theirs"].manifest["units"]["vehicle"]["isolation"] == "process"
    assert names["theirs"]["vehicle.speed"].max() == pytest.approx(30.0 / 3.6, rel=0.15)
    heavy, theirs = (names[key].metrics["energy per distance"].value for key in ("heavy", "theirs"))
    assert heavy > theirs


def test_paper(run):
    names, outputs = run("paper")
    assert pictures(outputs) == 1
    rows = tomllib.loads((ROOT / "master" / "reproduce" / "printed.toml").read_text(encoding="utf-8"))["row"]
    table = {
        row["value"]
        for row in rows
        if row["paper"] == "braking"
        and row["place"] == "Table I"
        and row["quantity"].endswith("stopping distance")
    }
    assert set(names["printed"].values()) == table
    assert names["table"]["difference [%]"].abs().max() < 2.0
    lost = names["lost"].metrics
    assert lost["front wheel locked"].value > 1.0
    assert lost["rear wheel locked"].value > 1.0
    order = ["known_speed", "front_compensated", "front_only"]
    for variant in names["distances"]:
        assert list(names["distances"][variant].sort_values().index) == order, variant
