"""The mark "published", wherever it stands, against the table of what the papers print.

A number marked so in a model's docstring or comment, in a system or scenario file or in a table of the docs
must be the value of a row of that paper, in its unit; and a parameter that a row names must be marked so by
its model.
"""

from __future__ import annotations

import ast
import importlib
import itertools
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.units.conversion import between
from evcosim.fmus.catalog import CATALOG
from evcosim.master.reproduce import printed
from evcosim.models.base import variables

ROOT = Path(__file__).parents[3]
OF_PAPER = {  # what names the paper in a model's source
    "Dardanelli": "scooter",
    "4WS electric vehicle": "lane_keeping",
    "Tanelli": "braking",
    "Gasbaoui": "multi_drive",
}
DERIVED = {"lateral_vehicle": "bicycle", "lane_keeping_controller": "bicycle"}  # whose parameters they have
REFERENCE = re.compile(
    r"\(\w?\d+[a-z]?\)(?:-\(\w?\d+\))?"
    r"|\b(?:Figs?\.|Tables?|section|Propositions?) [\dIV][\d.]*(?:(?:,| and| to) \d+)*"
    r"|\(\d x \d\)"
)
FACTORS = (1.0, 1e3, 1e-3, 100.0, 1e6, 3.6, 180.0 / math.pi, 1.0 / (2.0 * math.pi))  # between units
SPELLED = {"N m": "N.m", "kg m²": "kg.m2", "m²": "m2", "m/s²": "m/s2", "Ω": "ohm", "µH": "uH"}
UNITS = sorted(
    [
        *SPELLED,
        *SPELLED.values(),
        "km/h",
        "m/s",
        "rad/s",
        "N/rad",
        "kg",
        "m",
        "mm",
        "ms",
        "s",
        "Hz",
        "H",
        "%",
        "deg",
    ],
    key=len,
    reverse=True,
)
NUMBER = re.compile(
    r"(?<![\w.^/])(\d+(?: \d{3})*(?:\.\d+)?(?:e-?\d+)?)(?!/[A-Z])"
    rf"(?: *({'|'.join(map(re.escape, UNITS))})(?![\w/]))?"
)


class Mark(NamedTuple):
    """A text of a paper that is marked as published, and where it stands."""

    paper: str
    place: str
    text: str


def numbers(text: str) -> Iterator[tuple[float, str]]:
    """Yield the numbers in a text, each with the unit behind it ("" for none), without references."""
    for match in NUMBER.finditer(REFERENCE.sub(" ", text)):
        yield float(match[1].replace(" ", "")), SPELLED.get(match[2] or "", match[2] or "")


def is_printed(paper: str, value: float, unit: str) -> bool:
    """Return True if a row of the paper has the value; units are converted where both are known."""
    return any(_equal(number, row.unit, value, unit) for row in printed.rows(paper) for number in row.numbers)


def _equal(number: float, row_unit: str, value: float, unit: str) -> bool:
    if row_unit and unit and row_unit != unit:
        try:
            value *= between(unit, row_unit).scale
        except ConfigError:  # another quantity
            return False
    return math.isclose(abs(number), value, rel_tol=1e-9, abs_tol=1e-12)


def docstring(module: str) -> str:
    tree = ast.parse((ROOT / "models" / f"{module}.py").read_text(encoding="utf-8"))
    return ast.get_docstring(tree) or ""


def part(text: str, name: str) -> str:
    """Return a part of a docstring, on one line; "" where it has none."""
    match = re.search(rf"^{name}: (.*?)(?=\n\n|\n\w+: |\Z)", text, re.MULTILINE | re.DOTALL)
    return " ".join(match[1].split()) if match else ""


def paper_of(module: str) -> str:
    source = docstring(module)
    return next((paper for name, paper in OF_PAPER.items() if name in source), "")


def marks_of_models() -> Iterator[Mark]:
    for path in sorted((ROOT / "models").glob("*.py")):
        module = path.stem
        if text := part(docstring(module), "published"):
            yield Mark(paper_of(module), path.name, text)
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if re.search(r"= .*# .*\bpublished\b", line):
                code, _, comment = line.partition("#")
                literal = re.fullmatch(r"[A-Z_]+ = ([\d.e-]+) *", code)  # a formula is no printed number
                text = f"{literal[1]} {comment}" if literal else comment
                yield Mark(paper_of(module), f"{path.name}:{number}", text)


def marks_of_files() -> Iterator[Mark]:
    """Yield the parts, between semicolons, of sources and comments that say "published"."""
    data = ROOT / "cosim" / "data"
    for path in sorted([*data.glob("systems/*.toml"), *data.glob("scenarios/*/*.toml")]):
        paper = path.stem if path.parent.name == "systems" else path.parent.name
        for line in path.read_text(encoding="utf-8").splitlines():
            texts = re.findall(r'^source = "(.*)"$|#(.*)', line)
            for text in itertools.chain.from_iterable(texts):
                for phrase in text.split(";"):
                    if re.search(r"\bpublished\b", phrase):
                        yield Mark(paper, path.name, phrase)


def marks_of_docs() -> Iterator[Mark]:
    """Yield the values of parameters that are marked so, and the columns "published"."""
    for path in sorted((ROOT / "docs" / "systems").glob("*.md")):
        head: list[str] = []
        for line in path.read_text(encoding="utf-8").splitlines():
            cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
            if not cells:
                head = []
            elif not head:
                head = cells
            elif "published" in head:
                at = head.index("published")
                yield Mark(path.stem, f"{path.name}: {cells[0]}", cells[at])
            elif cells[-1].startswith("published"):
                yield Mark(path.stem, f"{path.name}: {cells[0]}", cells[1])


def marks_of_prose() -> Iterator[Mark]:
    """Yield what the sentences of the pages call published, to the next comma, semicolon or bracket."""
    for path in sorted((ROOT / "docs" / "systems").glob("*.md")):
        lines = path.read_text(encoding="utf-8").splitlines()
        text = " ".join(line for line in lines if not line.startswith("|"))
        for match in re.finditer(r"\bpublished ([^;:,()]*?)(?=[;:,()]|\. |$)", text):
            yield Mark(path.stem, f"{path.name}: {match[1]}", match[1])


MARKS = [*marks_of_models(), *marks_of_files(), *marks_of_docs(), *marks_of_prose()]


def test_marks_are_found_everywhere():
    """A pattern that finds nothing would let everything pass."""
    places = " ".join(mark.place for mark in MARKS)
    for part_of in ("scooter.py", "bicycle.py:", "fig8.toml", "launch.toml", "braking.md", "multi_drive.md"):
        assert part_of.removesuffix(":") in places
    assert len(MARKS) > 80
    assert sum(len(list(numbers(mark.text))) for mark in MARKS) > 120


@pytest.mark.parametrize("mark", MARKS, ids=lambda mark: mark.place)
def test_what_is_marked_as_published_is_printed(mark):
    found = list(numbers(mark.text))
    assert mark.paper or not found
    missing = [f"{value:g} {unit}" for value, unit in found if not is_printed(mark.paper, value, unit)]
    assert not missing, f"{mark.place}: no row of {mark.paper} in printed.toml has {', '.join(missing)}"


@pytest.mark.parametrize("row", [row for row in printed.rows() if row.parameters], ids=str)
def test_a_printed_parameter_is_marked_so_by_its_model(row):
    for path in row.parameters:
        module = path.partition(".")[0]
        text = part(docstring(module), "published")
        text += part(docstring(DERIVED.get(module, module)), "published")
        marked = list(numbers(text))
        symbols = row.place == "4.3"  # Q = I and R = I have no number
        assert symbols or any(_equal(n, row.unit, *each) for each in marked for n in row.numbers), path


def defaults(model: str) -> list[tuple[str, float]]:
    """Return path and value of the parameters of a model that have a number other than 0."""
    module = CATALOG[model].module
    record = getattr(importlib.import_module(f"evcosim.models.{module}"), model).Parameters
    numeric = [v for v in variables(record) if type(v.start) in (int, float) and v.start]
    return [(f"{module}.{model}.{v.name}", float(v.start)) for v in numeric]


def marks_of(value: float, module: str) -> set[str]:
    """Return the parts of a model's docstring, or of one that it names, which have a value in some unit."""
    docs = [docstring(module)]
    docs += [
        docstring(name) for name in re.findall(r"`(\w+)`", docs[0]) if (ROOT / f"models/{name}.py").exists()
    ]
    found = set()
    for name in ("published", "inferred", "chosen"):
        numbers_there = [number for doc in docs for number, _ in numbers(part(doc, name))]
        if any(math.isclose(value * f, n, rel_tol=1e-3) for f in FACTORS for n in numbers_there):
            found.add(name)
        if any(math.isclose(1.0 / (2.0 * math.pi * value), n, rel_tol=1e-3) for n in numbers_there):
            found.add(name)  # a time constant from a frequency
    return found


@pytest.mark.parametrize("model", CATALOG)
def test_every_parameter_of_a_model_has_a_mark(model):
    """And one that has no other mark than "published" is the parameter of a printed number."""
    named = {path for row in printed.rows() for path in row.parameters}
    for path, value in defaults(model):
        marks = marks_of(value, CATALOG[model].module)
        assert marks, f"{path} = {value:g}: neither published nor inferred nor chosen"
        assert marks != {"published"} or path in named, f"{path} = {value:g}: no row names it"


def test_a_number_that_no_paper_prints_is_found_out():
    assert is_printed("braking", 33.34, "m")
    assert is_printed("braking", 0.01, "s")  # printed as 10 ms
    assert not is_printed("braking", 33.34, "kg")
    assert not is_printed("braking", 1.2801, "")  # Burckhardt's table is none of the paper's
    assert not is_printed("scooter", 0.41, "")
    assert list(numbers("(3), Fig. 8: v_0 = 30 km/h, 1 m/s2, 0.46")) == [
        (30.0, "km/h"),
        (1.0, "m/s2"),
        (0.46, ""),
    ]


def test_modules_exist():
    for path in {path for row in printed.rows() for path in row.parameters}:
        importlib.import_module(f"evcosim.models.{path.partition('.')[0]}")
