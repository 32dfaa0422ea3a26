"""The table of FMI types: each row agrees with C, and no other module knows a type by its name."""

from __future__ import annotations

import ast
import ctypes
import math
from pathlib import Path

import pytest

import evcosim.master.engine
import evcosim.master.fmi
from evcosim.master.fmi.types import (
    BOOLEAN,
    BUFFERS,
    ENUMERATION,
    INTEGER,
    REAL,
    REAL_CODES,
    STRING,
    TYPES,
    WIDE_CODES,
    FmiType,
    fmi_type,
)

IDS = [f"{t.name}-{t.versions}" for t in TYPES]
WHOLE = [t for t in TYPES if t.kind in (INTEGER, ENUMERATION)]


def test_a_version_and_a_name_are_one_type() -> None:
    named = [(version, t.name) for t in TYPES for version in t.versions]
    assert len(named) == len(set(named))
    for version, name in named:
        found = fmi_type(f"{version}.0", name)
        assert found is not None and found.name == name and version in found.versions


@pytest.mark.parametrize(("version", "name"), [("2.0", "Float64"), ("3.0", "Real"), ("3.0", "Clock")])
def test_what_is_no_type_of_a_version_is_none(version: str, name: str) -> None:
    assert fmi_type(version, name) is None


@pytest.mark.parametrize("version", ["1.0", "2.0", "3.0"])
def test_every_version_has_every_type_of_the_system(version: str) -> None:
    kinds = {t.kind for t in TYPES if version[0] in t.versions}
    assert kinds == {REAL, INTEGER, ENUMERATION, BOOLEAN, STRING}


@pytest.mark.parametrize("kind", WHOLE, ids=lambda t: f"{t.name}-{t.versions}")
def test_a_whole_number_fits_from_low_to_high_and_no_further(kind: FmiType) -> None:
    for number in (kind.low, kind.high):
        assert kind.c_type(number).value == number
    for number in (kind.low - 1, kind.high + 1):
        assert kind.c_type(number).value != number
    low, high = kind.doubles
    assert low == kind.low and high <= kind.high < math.nextafter(high, math.inf)
    assert kind.wide == (float(kind.high) != kind.high)


def test_a_single_float_fits_to_its_greatest() -> None:
    kind = fmi_type("3.0", "Float32")
    assert kind is not None
    assert kind.c_type(kind.high).value == kind.high == -kind.low
    assert kind.c_type(kind.high * (1.0 + 2.0**-24)).value == math.inf


def test_types_of_one_code_are_one_in_memory() -> None:
    for kind in TYPES:
        assert (kind.code == 0) == (kind.kind is STRING)
        if kind.code:
            other = BUFFERS[kind.code]
            assert (other.c_type, other.kind is BOOLEAN) == (kind.c_type, kind.kind is BOOLEAN)
            assert (kind.code in REAL_CODES) == (kind.kind is REAL)
            assert (kind.code in WIDE_CODES) == kind.wide
    assert len({(t.c_type, t.kind is BOOLEAN) for t in TYPES if t.code}) == len(BUFFERS)


@pytest.mark.parametrize("kind", TYPES, ids=IDS)
def test_what_a_kind_reads_it_parses(kind: FmiType) -> None:
    for text in ("0", "1", " 7 ", "-3", "1.5", "1e3", "true", "False", "nan", "", "word", "0x10"):
        if kind.kind.reads(text):
            assert isinstance(kind.kind.parse(text), type(kind.kind.zero))
    assert kind.kind.from_c(kind.c_type().value) == kind.kind.zero


def test_no_other_module_names_a_type() -> None:
    """So that another number type is a row of the table: engines and readers follow the table."""
    own = {t.name for t in TYPES if t.versions == "3"} - {"Boolean", "String", "Enumeration"}
    # the types of counts, references and times, which are arguments of functions
    kept = {"c_int", "c_uint", "c_int64"}
    numbers = {name for name in dir(ctypes) if name.startswith(("c_int", "c_uint", "c_float"))} - kept
    rooms = [Path(room.__file__ or "").parent for room in (evcosim.master.fmi, evcosim.master.engine)]
    modules = [path for room in rooms for path in room.rglob("*.py") if path.name != "types.py"]
    assert len(modules) > 20
    for path in modules:
        for node in ast.walk(ast.parse(path.read_text())):
            assert not (isinstance(node, ast.Constant) and node.value in own), (path, node.value)
            assert not (isinstance(node, ast.Attribute) and node.attr in numbers), (path, node.attr)
