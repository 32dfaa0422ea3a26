"""Constructs of Python that have a native form: each in a small model that its program must equal."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.fmus.native import ir
from evcosim.fmus.native.lower import lower
from support.ir_interpreter import Failed, Interpreter
from support.ir_types import check, parts
from support.lowered import compare
from support.random_steps import random_step
from support.small_model import cases, small

CASES = cases(Path(__file__).with_name("constructs.txt"))


@pytest.mark.parametrize("name", CASES)
def test_a_construct_computes_what_python_does(name: str) -> None:
    model = CASES[name].model()
    program = lower(model)
    check(program)
    for seed in range(12):
        compare(model, program, seed, steps=6)


def test_a_whole_number_beyond_64_bits_fails() -> None:
    model = small("return Small.State(x.x, floor(u.u * 1e19))")
    run = Interpreter(lower(model), model.Parameters())
    with pytest.raises(Failed, match="beyond 64 bits"):
        run.step(run.initial(model.Inputs()), model.Inputs(u=2.0), 0.1)


def test_a_loop_of_c_stands_for_a_loop_of_python_and_a_function_for_a_function() -> None:
    program = lower(CASES["a list that a function changes"].model())
    loops = {f.name: sum(isinstance(n, ir.For) for n in parts(f.body)) for f in program.functions}
    assert loops == {"initial": 0, "fill": 1, "halved": 1, "rest": 0, "step": 0, "outputs": 0}


def test_callers_with_arguments_of_equal_types_share_a_function() -> None:
    program = lower(CASES["one function for two types"].model())
    assert sorted(f.name for f in program.functions if "twice" in f.name) == ["twice", "twice_2"]


def test_an_equation_mark_is_the_note_of_its_statement() -> None:
    body = "y = u.u / u.v  # (V2)\nz = sqrt(\n    y  # no mark\n)  # (V3), Heun\nreturn Small.State(y + z)"
    notes = [getattr(n, "note", "") for n in parts(lower(small(body)).functions[-2].body)]
    assert [note for note in notes if note] == ["(V2)", "(V3), Heun"]


def test_a_place_is_that_of_the_traceback() -> None:
    program = lower(small("y = (\n    u.u\n    / u.v\n)\nreturn Small.State(y)"))
    checked = [n for f in program.functions for n in parts(f.body) if isinstance(n, ir.Checked)]
    assert len(checked) == 1 and checked[0].place.file.startswith("small_")


@pytest.mark.parametrize("seed", range(30))
def test_a_random_step_computes_what_python_does(seed: int) -> None:
    model = small(*random_step(seed))
    program = lower(model)
    check(program)
    for draw in range(4):
        compare(model, program, draw, steps=4)
