"""The models of the catalog, lowered: a program that computes what the model does, bit for bit."""

from __future__ import annotations

import importlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.fmus.catalog import CATALOG
from evcosim.fmus.native import ir
from evcosim.fmus.native.lower import lower
from evcosim.models.base import Model
from support.ir_types import check
from support.lowered import compare

PROGRAMS: dict[str, ir.Program] = {}


def model_named(name: str) -> type[Model]:
    """Return a model of the catalog."""
    found: type[Model] = getattr(importlib.import_module(f"evcosim.models.{CATALOG[name].module}"), name)
    return found


def program(name: str) -> ir.Program:
    """Return a model's program, lowered once."""
    if name not in PROGRAMS:
        PROGRAMS[name] = lower(model_named(name))
    return PROGRAMS[name]


@pytest.mark.parametrize("name", CATALOG)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_program_computes_what_its_model_does(name: str, seed: int) -> None:
    compare(model_named(name), program(name), seed, steps=8)


@pytest.mark.parametrize("name", CATALOG)
def test_a_program_keeps_the_rules_of_its_types(name: str) -> None:
    check(program(name))
