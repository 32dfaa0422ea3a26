"""The runtime of native FMUs beside the FMU in Python: the same values, the same refusals, the same words."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

import pytest

KINDS = ("Handmade", "HandmadeSampled", "HandmadePlain")


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("seed", [1, 2])
def test_the_same_run(name: str, seed: int, both: Callable[[str], Any], random_inputs: Any) -> None:
    two = both(name)
    draw = random.Random(seed)
    parameters = {"gain": draw.uniform(0.0, 10.0), "limit": 1, "divisor": 3.7, "mode": 1}
    two.do(lambda unit: unit.initialize(parameters, start=draw_start(seed)))
    two.do(lambda unit: unit.get())
    inputs = random_inputs(two.model, 60, seed)
    for k, values in enumerate(inputs):
        values.pop("steps", None) if name == "HandmadeSampled" else None
        two.do(lambda unit, values=values: unit.set(values))
        if k % 2 and name != "HandmadePlain":
            two.do(lambda unit: unit.get("direct", "clock"))
        two.call("doStep", draw_start(seed) + k * 0.01, 0.01)
        two.do(lambda unit: unit.get())
    assert any("steps, 100 % of them" in line for line in two.said[0])


def draw_start(seed: int) -> float:
    """Return a start time [s]."""
    return (0.0, 5.0, 123.456)[seed % 3]


def test_a_notice_is_told_once_and_again_after_a_reset(both: Callable[[str], Any]) -> None:
    two = both("HandmadePlain")
    for _ in range(2):
        two.do(lambda unit: unit.initialize({"limit": 1, "active": False}))
        for k in range(2):
            two.call("doStep", k * 0.1, 0.1)
        two.call("reset")
    assert two.said[1] == ["first at t = 0.1 s: 0 of 1 steps, 100 % of them"] * 2


OUT_OF_RANGE = [
    ({"gain": 10.5}, "gain = 10.5 N/m is above its maximum 10.0 N/m"),
    ({"gain": -1e-7}, "gain = -1e-07 N/m is below its minimum 0.0 N/m"),
    ({"share": 120.0}, "share = 120.0 % is above its maximum 100 %"),
    ({"gain": math.nan}, "gain = nan is not a finite number"),
    ({"divisor": -math.inf}, "divisor = -inf is not a finite number"),
    ({"limit": 10}, "limit = 10 is above its maximum 9"),
    ({"word": -1, "limit": -2, "gain": 1e22}, "gain = 1e+22 N/m is above its maximum 10.0 N/m; limit = -2"),
]


@pytest.mark.parametrize(("values", "expected"), OUT_OF_RANGE)
def test_parameters_out_of_their_ranges(
    values: dict[str, Any], expected: str, both: Callable[[str], Any]
) -> None:
    two = both("Handmade")
    two.call("setupExperiment")
    two.do(lambda unit: unit.set(values))
    two.call("enterInitializationMode")
    assert expected in two.do(lambda unit: unit.get("total"))[0]
    for _ in range(2):
        said = two.call("exitInitializationMode")
        assert expected in said[0]
        assert said[0].startswith("fmi2ExitInitializationMode: ")
    two.call("reset")
    two.do(lambda unit: unit.initialize())
    two.call("doStep", 0.0, 0.1)
    assert two.do(lambda unit: unit.get())["total"] == pytest.approx(0.75)


@pytest.mark.parametrize("word", [1, 2])
def test_initial_fails(word: int, both: Callable[[str], Any]) -> None:
    two = both("Handmade")
    two.call("setupExperiment")
    two.do(lambda unit: unit.set({"word": word}))
    two.call("enterInitializationMode")
    said = two.do(lambda unit: unit.get("total"))
    assert "Error: " in said[0]
    assert "(handmade.py:" in said[0]
    two.call("exitInitializationMode")
    two.do(lambda unit: unit.set({"word": 0}))  # it is still in its initialization
    assert two.call("exitInitializationMode") == 0
    two.do(lambda unit: unit.get())


def test_a_step_that_fails_leaves_all_as_it_was(both: Callable[[str], Any]) -> None:
    two = both("HandmadeSampled")
    two.do(lambda unit: unit.initialize({"limit": 2}))
    two.call("doStep", 0.0, 0.1)
    before = two.do(lambda unit: unit.get())
    two.do(lambda unit: unit.set({"speed": 666.0}))
    for t in (0.1, 1e22, 0.30000000000000004, 1e-7):
        said = two.call("doStep", t, 0.1)
        assert said[0].startswith(f"fmi2DoStep at t = {t} s: ZeroDivisionError: ")
        assert two.do(lambda unit: unit.get()) == before
        two.do(lambda unit: unit.get("clock"))
    two.do(lambda unit: unit.set({"speed": 1.0}))
    for t in (0.1, 0.2):
        two.call("doStep", t, 0.1)
        two.do(lambda unit: unit.get())


def test_the_model_divides_by_zero(both: Callable[[str], Any]) -> None:
    two = both("HandmadePlain")
    two.do(lambda unit: unit.initialize({"divisor": 0.0}))
    assert "ZeroDivisionError" in two.call("doStep", 0.0, 0.1)[0]


def test_outputs_that_feed_through_fail_when_they_are_read(both: Callable[[str], Any]) -> None:
    two = both("Handmade")
    two.do(lambda unit: unit.initialize())
    two.do(lambda unit: unit.set({"speed": 666.0}))
    for _ in range(2):
        assert two.do(lambda unit: unit.get("direct"))[0].startswith("fmi2GetReal: ZeroDivisionError: ")
    two.do(lambda unit: unit.set({"speed": 6.0}))
    two.do(lambda unit: unit.get())


def test_an_integer_that_leaves_32_bits(both: Callable[[str], Any]) -> None:
    two = both("HandmadePlain")
    two.do(lambda unit: unit.initialize({"limit": 9, "word": 3}))
    said = [two.call("doStep", float(k), 1.0) for k in range(3)]
    assert said[:2] == [None, None]
    assert said[2] == ["fmi2DoStep at t = 2.0 s: output ticks is 3000000000, which is no Integer"]
    two.do(lambda unit: unit.get())


FIXED = "is a fixed parameter: it cannot be set after the initialization"
NEITHER = "is neither parameter nor input: it cannot be set"
NO_ITEM = "is no item of its enumeration (-1 reverse, 1 neutral, 2 forward)"
UNKNOWN = "variable with value reference"
WRONG = [
    ("Real", [99, 7, 98, 99], [0.0] * 4, f"there is no Real {UNKNOWN} 98, 99"),
    ("Real", [9], [0.0], f"there is no Real {UNKNOWN} 9"),
    ("Real", [12, 0], [0.0, 0.0], f"gain {FIXED}"),
    ("Real", [12, 7], [0.0, 0.0], f"total {NEITHER}"),
    ("Real", [8], [0.0], f"clock {NEITHER}"),
    ("Integer", [11], [0], f"lever = 0 {NO_ITEM}"),
    ("Integer", [16], [7], f"last = 7 {NO_ITEM}"),
    ("Integer", [16], [2], f"last {NEITHER}"),
    ("Integer", [7], [2], f"there is no Integer {UNKNOWN} 7"),
    ("Integer", [2], [2], f"limit {FIXED}"),
    ("Boolean", [9], [True], f"there is no Boolean {UNKNOWN} 9"),
    ("Boolean", [3], [True], f"active {FIXED}"),
    ("String", [3], ["x"], f"there is no String {UNKNOWN} 3"),
]


@pytest.mark.parametrize(("kind", "references", "values", "expected"), WRONG)
def test_values_that_cannot_be_set(
    kind: str, references: list[int], values: list[Any], expected: str, both: Callable[[str], Any]
) -> None:
    two = both("Handmade")
    two.do(lambda unit: unit.initialize())
    before = two.do(lambda unit: unit.get())
    assert two.call(f"set{kind}", references, values) == [f"fmi2Set{kind}: {expected}"]
    assert two.do(lambda unit: unit.get()) == before  # all or nothing


@pytest.mark.parametrize("call", ["getReal", "getInteger", "getBoolean", "getString"])
def test_values_that_there_are_not(call: str, both: Callable[[str], Any]) -> None:
    two = both("Handmade")
    two.do(lambda unit: unit.initialize())
    kind = call.removeprefix("get")
    many = [*range(3, 12), 2147483647, 77, 18]
    said = two.call(call, many)
    assert said[0].startswith(f"fmi2Get{kind}: there is no {kind} variable with value reference ")
    assert said[0].endswith("18, 77, 2147483647")
    assert two.call(call, []) == []


@pytest.mark.parametrize("step", [0.0, -0.1, math.nan, math.inf])
def test_a_step_that_is_none(step: float, both: Callable[[str], Any]) -> None:
    two = both("Handmade")
    assert two.call("doStep", 0.0, 0.1) == [
        "fmi2DoStep at t = 0.0 s: the initialization mode has not been left"
    ]
    two.do(lambda unit: unit.initialize())
    expected = f"fmi2DoStep at t = 0.5 s: the step is {step} s: it must be finite and longer than 0"
    assert two.call("doStep", 0.5, step) == [expected]
    two.call("doStep", 0.5, 0.1)
    two.call("terminate")
    assert two.call("doStep", 0.6, 0.1) == ["fmi2DoStep at t = 0.6 s: it was terminated"]
    two.do(lambda unit: unit.get())
