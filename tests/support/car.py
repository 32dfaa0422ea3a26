"""A car and its ECU as mocks: the system that the tests of the plan resolve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.plan.plan import Plan
from evcosim.cosim.units.measure import UnitOfMeasure
from support.mocks import MockUnit, plan_of, real

SPEED = (0, 1, -1, 0, 0, 0, 0, 0)
DEFINED = {
    "m/s": UnitOfMeasure("m/s", SPEED),
    "km/h": UnitOfMeasure("km/h", SPEED, 1 / 3.6),
    "N": UnitOfMeasure("N", (1, 1, -2, 0, 0, 0, 0, 0)),
    "%": UnitOfMeasure("%", (0,) * 8, 0.01),
}


def unit(name: str, *variables: VariableInfo) -> MockUnit:
    """A mock whose FMU defines the units of measure DEFINED."""
    mock = MockUnit(name, list(variables))
    mock.interface = UnitInterface(f"{name}.fmu", mock.interface.variables, DEFINED)
    return mock


def car() -> MockUnit:
    return unit(
        "car",
        real("throttle", "input", unit="%"),
        real("grade", "input"),
        real("speed", "output", unit="m/s"),
        real("force", "output", unit="N"),
        VariableInfo("gear", "Integer", "output", "discrete"),
        real("mass", "parameter", unit="kg", start=200.0, min=1.0, max=1e4),
        VariableInfo("sport", "Boolean", "parameter", "fixed", start=False),
        VariableInfo("mode", "Enumeration", "parameter", "fixed", start=0, items=((0, "eco"), (1, "fast"))),
        VariableInfo("count", "Integer", "parameter", "fixed", start=0),
    )


def ecu() -> MockUnit:
    return unit(
        "ecu",
        real("speed", "input", unit="km/h", start=0.0),
        VariableInfo("flag", "Boolean", "input", "discrete", start=False),
        real("throttle", "output", unit="%", variability="discrete"),
    )


def plan(
    connect: Sequence[Mapping[str, Any]],
    scenario: Mapping[str, Any] | None = None,
    options: Mapping[str, Any] | None = None,
    **more: Any,
) -> Plan:
    """The plan of ECU and car; `more` are tables of the system file, `options` those of the run."""
    return plan_of([ecu(), car()], {"connect": connect, **more}, scenario, **(options or {}))


BUS = {"buses": {"can0": {"dbc": "can/ev.dbc"}}}
SENT = {"from": "car.speed", "to": ["ecu.speed"], "via": "can0.EMD_Status.EMD_VehicleSpeed"}
