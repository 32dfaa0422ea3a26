"""The probes of a trial, each with courses made up for its verdicts."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.units.measure import Affine
from evcosim.master.studies.trial import probes
from evcosim.master.studies.trial.levels import Level

RISE = np.linspace(0.0, 10.0, 101)
PAIR = ("throttle", "speed")


@pytest.mark.parametrize(
    ("theirs", "ours", "verdict", "sign", "text"),
    [
        (RISE, RISE, "good", 1, "raises it by up to 10 m/s, as that of the system (10 m/s)"),
        (2.0 * RISE, RISE, "good", 1, "raises it by up to 20 m/s"),
        (-RISE, RISE, "problem", -1, "lowers it by up to 10 m/s: the other sign"),
        (
            3.6 * RISE,
            RISE,
            "problem",
            1,
            "3.6 times as much as it should: is its unit of measure another one",
        ),
        (7.0 * RISE, RISE, "problem", 1, "7 times as much as it should; that of the system raises it"),
        (0.0 * RISE, RISE, "problem", 0, "no reaction; that of the system raises it by up to 10 m/s"),
        (np.sin(9.0 * RISE), RISE, "note", 0, "in another course"),
        (RISE, 0.0 * RISE, "note", 0, "that of the system does not react"),
    ],
)
def test_reactions(theirs, ours, verdict, sign, text):
    found = probes.reaction(PAIR, "m/s", theirs, ours)
    assert found is not None
    assert (found.finding.what, found.finding.verdict, found.sign) == ("throttle -> speed", verdict, sign)
    assert text in found.finding.text


def test_two_units_that_do_not_react():
    assert probes.reaction(PAIR, "m/s", 0.0 * RISE, 0.0 * RISE) is None


def bench(**limits):
    variable = VariableInfo("speed", "Real", "output", unit="m/s", **limits)
    throttle = VariableInfo("throttle", "Real", "input", unit="%", **limits)
    interface = SimpleNamespace(variables={"speed": variable, "throttle": throttle})
    identity = lambda name: Affine()  # noqa: E731 - a method of the bench
    return SimpleNamespace(outputs=["speed"], interface=interface, to_ours=identity, from_ours=identity)


@pytest.mark.parametrize(
    ("reached", "limits", "expected"),
    [
        ([0.0, 10.0], {"min": 0.0, "max": 10.0}, []),
        ([0.0, 12.0], {"max": 10.0}, [("note", "goes up to 12, above the FMU's own max 10")]),
        ([-3.0, 5.0], {"min": 0.0}, [("note", "goes down to -3, below the FMU's own min 0")]),
        ([0.0, 2e5], {}, [("problem", "from 0 to 200000; that of the system stays within 10")]),
    ],
)
def test_values(reached, limits, expected):
    found = probes.values([{"speed": np.array(reached)}], [{"speed": np.array([0.0, 10.0])}], bench(**limits))
    assert [(f.verdict, f.text) for f in found] == expected


@pytest.mark.parametrize(
    ("limits", "given", "verdict"),
    [
        ({"min": 0.0, "max": 100.0}, (0.0, 100.0), None),
        ({"min": 0.0, "max": 80.0}, (0.0, 100.0), "problem"),
        ({"min": 0.0, "max": 80.0}, (0.0, math.inf), "note"),  # nothing declares how far it goes
        ({}, (0.0, 100.0), None),
    ],
)
def test_ends_of_inputs(limits, given, verdict):
    found = probes.input_ends(bench(**limits), {"throttle": Level(0.0, 50.0, given)})
    assert [f.verdict for f in found] == ([] if verdict is None else [verdict])


def test_steps_that_are_small_enough_and_those_that_are_not():
    def run(error):
        return lambda count: {"speed": RISE * (1.0 + error / count)}

    finding, enough = probes.steps(run(0.001), (1, 2, 5, 10), ["speed"], 0.01)
    assert (finding.verdict, enough) == ("good", 1)
    finding, enough = probes.steps(run(0.04), (1, 2, 5, 10), ["speed"], 0.01)
    assert (finding.verdict, enough) == ("problem", 5)
    assert finding.text.endswith("(speed): substeps = 5")
    assert finding.text.startswith("of 10, 5, 2 ms differ from those of 1 ms by 3.6 %")


def test_steps_that_fail():
    def run(count):
        if count < 5:
            raise RunError("NaN")
        return {"speed": RISE}

    finding, enough = probes.steps(run, (1, 2, 5, 10), ["speed"], 0.01)
    assert enough == 5
    assert "by no result, no result, 0 % of the range (the run, which fails)" in finding.text


def test_the_speed_is_that_of_the_fastest_stretch():
    unit = SimpleNamespace(start_step=lambda steps: None, finish_step=lambda: None)
    finding = probes.speed(unit, 0.0, 0.01, 0.02)
    assert finding.verdict == "good"
    assert "us for a step of 10 ms" in finding.text


def test_a_failed_run_is_one_line():
    assert probes.failed("start", RunError("a\n  b")) == probes.Finding("start", "problem", "a b")
