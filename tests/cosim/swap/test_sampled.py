"""Sampled outputs: as the system file says, as the FMU tells, as in the place that an FMU takes."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.swap.sampled import inherited, sampled_in, told, untold

VARIABLES = [
    VariableInfo("u", "Real", "input"),
    VariableInfo("torque", "Real", "output"),
    VariableInfo("gear", "Integer", "output", "discrete"),
    VariableInfo("lamp", "Boolean", "output", "discrete"),
    VariableInfo("count", "Integer", "local", "discrete"),
]
STRANGER = UnitInterface("x.fmu", {v.name: v for v in VARIABLES})


def test_the_key_names_outputs_or_means_the_discrete_ones():
    assert sampled_in(STRANGER) == ()
    assert sampled_in(told(STRANGER, "x", True, "k.")) == ("gear", "lamp")
    assert sampled_in(told(STRANGER, "x", ["torque", "count"], "k.")) == ("torque", "count")
    assert sampled_in(told(told(STRANGER, "x", True, "k."), "x", False, "k.")) == ()


def test_what_the_key_cannot_mean_is_refused():
    with pytest.raises(ConfigError, match=r"^s\.toml: units\.x\.sampled: x\.u is of causality input"):
        told(STRANGER, "x", ["u"], "s.toml: units.x.")
    with pytest.raises(
        ConfigError, match=r"units\.x\.sampled: unit 'x' has no variable 'gaer' \(did you mean 'gear'"
    ):
        told(STRANGER, "x", ["gaer"], "units.x.")
    continuous = dataclasses.replace(STRANGER, variables={"torque": STRANGER.variables["torque"]})
    with pytest.raises(
        ConfigError, match=r"sampled = true: no output of x\.fmu is declared discrete; list those"
    ):
        told(continuous, "x", True, "units.x.")


def test_a_place_is_inherited_by_an_fmu_that_does_not_tell():
    interface, (said,) = inherited(STRANGER, "x", {"torque", "gear", "elsewhere"})
    assert sampled_in(interface) == ("torque", "gear")
    assert "torque, gear of x.fmu are taken as sampled, as in the unit whose place it takes" in said
    tells = dataclasses.replace(STRANGER, tells_sampled=True)
    assert inherited(tells, "x", {"torque"}) == (tells, [])
    assert inherited(STRANGER, "x", ()) == (STRANGER, [])


def test_an_fmu_of_an_earlier_evcosim_is_warned_of():
    (said,) = untold("x", dataclasses.replace(STRANGER, ours=True))
    assert "gear, lamp are not" in said
    assert "sampled = true" in said
    assert (
        untold("x", STRANGER)
        == untold("x", dataclasses.replace(STRANGER, ours=True, tells_sampled=True))
        == []
    )
