"""The interface of a unit: its variables by name, and what is said where one is not as it is needed."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import UnitInterface, VariableInfo

SPEED = VariableInfo("speed", causality="output", unit="m/s")
THROTTLE = VariableInfo("throttle", causality="input", declared="u[1]", inverted=True)
MASS = VariableInfo("mass", causality="parameter", start=200.0)
INTERFACE = UnitInterface(
    "Scooter.fmu", {v.name: v for v in (SPEED, THROTTLE, MASS)}, unusable={"clock": "is a Clock"}
)


def test_a_variable_has_the_name_that_its_fmu_declares_or_its_own() -> None:
    assert (SPEED.declared_name, THROTTLE.declared_name) == ("speed", "u[1]")


def test_variables_come_in_declared_order() -> None:
    assert INTERFACE.of_causality("parameter", "output") == (SPEED, MASS)
    assert INTERFACE.of_causality("local") == ()


@pytest.mark.parametrize("variable", [SPEED, THROTTLE, MASS])
def test_what_is_required_and_there_is_returned(variable: VariableInfo) -> None:
    found = INTERFACE.require("vehicle", variable.name, (variable.causality, "local"), "scooter.toml")
    assert found is variable


@pytest.mark.parametrize(
    ("name", "causalities", "message"),
    [
        (
            "sped",
            ("output",),
            "scooter.toml: unit 'vehicle' has no variable 'sped' (did you mean 'speed'?); "
            "output variables of Scooter.fmu: speed",
        ),
        (
            "x",
            ("local",),
            "scooter.toml: unit 'vehicle' has no variable 'x'; local variables of Scooter.fmu: none",
        ),
        (
            "mass",
            ("input", "output"),
            "scooter.toml: vehicle.mass is of causality parameter, not input or output",
        ),
        ("clock", ("input",), "scooter.toml: unit 'vehicle': clock is a Clock (Scooter.fmu)"),
    ],
)
def test_what_is_not_there_is_refused(name: str, causalities: tuple[str, ...], message: str) -> None:
    with pytest.raises(ConfigError) as refusal:
        INTERFACE.require("vehicle", name, causalities, "scooter.toml")
    assert str(refusal.value) == message
