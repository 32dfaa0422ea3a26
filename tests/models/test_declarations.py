"""Relations that every model keeps; a new model in models/ is found and tested without a line here."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
import random
from typing import Any

import pytest

import evcosim.models
from evcosim.models.base import Model, Variable, variables, violations

DT = 0.01
WALKS = 20
STEPS = 30


def all_models() -> list[type[Model]]:
    """Every model of the package."""
    found = []
    for module in pkgutil.iter_modules(evcosim.models.__path__):
        content = vars(importlib.import_module(f"evcosim.models.{module.name}"))
        found += [
            m for m in content.values() if inspect.isclass(m) and issubclass(m, Model) and m is not Model
        ]
    return sorted(set(found), key=lambda m: m.__name__)


every_model = pytest.mark.parametrize("model", all_models(), ids=lambda m: m.__name__)


def test_all_models_are_found() -> None:
    names = {m.__name__ for m in all_models()}
    assert names >= {"Scooter", "BoundController", "BoundPlanner", "Battery", "Rider"}


def any_value(v: Variable, draw: random.Random) -> Any:
    """A value in the range of an input; without one, of the size that its unit and start suggest."""
    if v.type == "Boolean":
        return draw.random() < 0.5
    if v.enumeration is not None:
        return draw.choice(list(v.enumeration))
    size = 100.0 if v.unit in ("%", "km/h") else 10.0 * (v.nominal or max(1.0, abs(v.start)))
    low = v.min if v.min is not None else -0.2 * size
    high = v.max if v.max is not None else low + 1.2 * size
    return draw.choice([low, high, v.start, draw.uniform(low, high), draw.uniform(low, high)])


def any_inputs(model: type[Model], draw: random.Random) -> Any:
    """Inputs in their ranges."""
    return model.Inputs(*(any_value(v, draw) for v in variables(model.Inputs)))


def outputs(model: type[Model], p: Any, x: Any, u: Any) -> Any:
    """The outputs, with or without inputs as the model takes them."""
    return model.outputs(p, x, u) if model.feeds_through() else model.outputs(p, x)


def walk(model: type[Model], seed: int) -> list[tuple[Any, Any]]:
    """States along a walk of random inputs, each with the inputs of the step that starts there."""
    draw = random.Random(seed)
    p, u = model.Parameters(), any_inputs(model, draw)
    x = model.initial(p, u)
    visited = []
    for k in range(STEPS):
        if k % 10 == 0:
            u = any_inputs(model, draw)
        visited.append((x, u))
        x = model.step(p, x, u, DT)
    return visited


@every_model
def test_starts_are_in_range_and_of_their_record(model: type[Model]) -> None:
    assert violations(model.Parameters()) == []
    assert violations(model.Inputs()) == []
    x = model.initial(model.Parameters(), model.Inputs())
    assert type(x) is model.State
    assert type(model.step(model.Parameters(), x, model.Inputs(), DT)) is model.State


@every_model
def test_declared_starts_are_those_of_initial(model: type[Model]) -> None:
    p, u = model.Parameters(), model.Inputs()
    y = outputs(model, p, model.initial(p, u), u)
    assert y == model.Outputs()


@every_model
@pytest.mark.parametrize("seed", range(WALKS))
def test_outputs_stay_finite_and_in_range(model: type[Model], seed: int) -> None:
    p = model.Parameters()
    for x, u in walk(model, seed):
        assert violations(outputs(model, p, x, u)) == []
        assert violations(x) == []


@every_model
@pytest.mark.parametrize("seed", range(3))
def test_a_step_depends_on_its_arguments_alone(model: type[Model], seed: int) -> None:
    p = model.Parameters()
    visited = walk(model, seed)
    again = {k: model.step(p, *visited[k], DT) for k in reversed(range(STEPS - 1))}
    assert [again[k] for k in range(STEPS - 1)] == [x for x, _ in visited[1:]]


@every_model
def test_parameters_that_are_equal_give_equal_steps(model: type[Model]) -> None:
    x, u = walk(model, 1)[-1]
    assert model.step(model.Parameters(), x, u, DT) == model.step(model.Parameters(), x, u, DT)


@every_model
def test_direct_feedthrough_is_the_declared_one(model: type[Model]) -> None:
    """A changed input changes at the same instant the outputs that declare it, and no others."""
    p, draw = model.Parameters(), random.Random(5)
    seen: dict[str, set[str]] = {v.name: set() for v in variables(model.Outputs)}
    for seed in range(WALKS):
        for x, u in walk(model, seed):
            for changed in variables(model.Inputs):
                other = dataclasses.replace(u, **{changed.name: any_value(changed, draw)})
                before, after = outputs(model, p, x, u), outputs(model, p, x, other)
                for name, reached in seen.items():
                    if getattr(before, name) != getattr(after, name):
                        reached.add(changed.name)
    assert seen == {v.name: set(v.depends) for v in variables(model.Outputs)}


@every_model
def test_what_initialization_reads_is_declared(model: type[Model]) -> None:
    """An output at the start depends on its `initially` (else `initial_inputs` and `depends`) alone."""
    p, draw = model.Parameters(), random.Random(6)
    for _ in range(200):
        u = any_inputs(model, draw)
        for changed in variables(model.Inputs):
            other = dataclasses.replace(u, **{changed.name: any_value(changed, draw)})
            before = outputs(model, p, model.initial(p, u), u)
            after = outputs(model, p, model.initial(p, other), other)
            if changed.name not in model.initial_inputs:
                assert model.initial(p, u) == model.initial(p, other)
            for v in variables(model.Outputs):
                allowed = v.initially if v.initially is not None else (*model.initial_inputs, *v.depends)
                if getattr(before, v.name) != getattr(after, v.name):
                    assert changed.name in allowed, v.name
