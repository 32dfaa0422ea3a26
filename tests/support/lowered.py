"""A model's own functions beside its program run by the interpreter: the same values, the same failures."""

from __future__ import annotations

import enum
import traceback
from typing import Any

import numpy as np

from evcosim.fmus.native import ir
from evcosim.models.base import Model, variables

from .ir_interpreter import Failed, Interpreter

Outcome = tuple[Any, ...]


def outcome(function: Any, *arguments: Any) -> Outcome:
    """Return ("value", bits) or ("failure", exception, text, file, line) of a call."""
    try:
        value = function(*arguments)
    except Failed as failed:
        return ("failure", *failed.args)
    except Exception as error:
        # an enumeration raises within Python's enum.py, the program where it is called
        frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename != enum.__file__]
        frame = frames[-1]
        return ("failure", type(error).__name__, str(error), frame.filename, frame.lineno)
    return ("value", bits(value))


def bits(value: Any) -> Any:
    """Return a value so that equal ones have equal bits."""
    if isinstance(value, str):
        return value
    if isinstance(value, dict):
        return {name: bits(item) for name, item in value.items()}
    if isinstance(value, float):
        return value.hex()
    if isinstance(value, bool):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, tuple) and not hasattr(value, "_fields"):
        return [bits(item) for item in value]
    if isinstance(value, tuple):
        return {name: bits(item) for name, item in zip(value._fields, value, strict=True)}
    return {name: bits(getattr(value, name)) for name in type(value).__dataclass_fields__}


def assert_same(of_python: Outcome, of_program: Outcome) -> None:
    """Check that both give the same value, or fail with the same exception, text and place."""
    if of_python[0] == of_program[0] == "failure":
        *_, file, line = of_python
        *_, own_file, own_line = of_program
        assert of_python[1:3] == of_program[1:3]
        on_disk = own_file.removeprefix("evcosim/")  # the folders of the packages stand at the top
        assert (file.endswith(on_disk), line) == (True, own_line), (of_python, of_program)
    else:
        assert of_python == of_program


def compare(model: type[Model], program: ir.Program, seed: int, steps: int = 20) -> int:
    """Run a model and its program with random values and steps; return how many steps went well."""
    random = np.random.default_rng(seed)
    p = model.Parameters(**draw(model.Parameters, random, 0.3))
    run = Interpreter(program, p)
    u = model.Inputs(**draw(model.Inputs, random, 1.0))
    x, there = _both((model.initial, p, u), (run.initial, u))
    taken = 0
    for _ in range(steps):
        if x is None:
            break
        more = (u,) if model.feeds_through() else ()
        assert_same(outcome(model.outputs, p, x, *more), outcome(run.outputs, there, u))
        dt = float(random.choice([1e-3, 1e-2, 0.0173, 0.1]))
        if random.random() < 0.5:
            u = model.Inputs(**draw(model.Inputs, random, 1.0))
        before, was = x, there
        x, there = _both((model.step, p, x, u, dt), (run.step, there, u, dt))
        if x is not None:
            taken += 1
            if model.notice is not None:
                assert_same(outcome(model.notice, p, before, x, u), outcome(run.notice, was, there, u))
    return taken


def _both(of_python: tuple[Any, ...], of_program: tuple[Any, ...]) -> tuple[Any, Any]:
    """Return the results of two calls that must be the same; None where they fail in the same way."""
    kept: list[Any] = []

    def kept_call(function: Any, *arguments: Any) -> Any:
        kept.append(function(*arguments))
        return kept[-1]

    assert_same(outcome(kept_call, *of_python), outcome(kept_call, *of_program))
    return (kept[0], kept[1]) if len(kept) == 2 else (None, None)


def draw(record: type, random: np.random.Generator, share: float) -> dict[str, Any]:
    """Return random values for a record's variables, each with probability `share`, within their ranges."""
    return {v.name: _drawn(v, random) for v in variables(record) if random.random() < share}


def _drawn(v: Any, random: np.random.Generator) -> Any:
    if isinstance(v.start, enum.IntEnum):
        items = list(type(v.start))
        return items[random.integers(len(items))]
    if isinstance(v.start, bool):
        return bool(random.random() < 0.5)
    low = -np.inf if v.min is None else v.min
    high = np.inf if v.max is None else v.max
    if isinstance(v.start, int):
        return int(random.integers(max(low, 0), min(high, 50), endpoint=True))
    size, kind = v.nominal or 1.0, random.random()
    value = v.start * random.uniform(0.5, 2.0) if v.start else size * random.normal(0.0, 2.0)
    if kind < 0.1:
        value = -value if kind < 0.05 else 0.0
    # a value at the edge of its range may need millions of inner steps
    return float(value if low <= value <= high else v.start)
