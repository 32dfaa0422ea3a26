"""Model parameters beside printed numbers."""

from __future__ import annotations

from decimal import Decimal

import pytest

from evcosim.master.reproduce import printed
from evcosim.master.reproduce.parameters import compared, parameter
from evcosim.master.reproduce.printed import Printed

MASS = "two_motor_vehicle.TwoMotorVehicle.mass"
EFFICIENCY = "induction_motor_drive.InductionMotorDrive.gear_efficiency"


def row(value, unit=""):
    return Printed("mine", "1", "number", "x", value, "by construction", unit, parameters=("a.B.c",))


@pytest.mark.parametrize(
    ("path", "value", "unit", "shown", "same"),
    [
        (MASS, 3904, "kg", "3904 kg", True),
        (MASS, 3905, "kg", "3904 kg", False),
        (MASS, Decimal("3.904"), "t", "3.904 t", True),
        (MASS, 3904, "", "3904 kg", True),
        (EFFICIENCY, 93, "%", "93 %", True),
        (EFFICIENCY, Decimal("0.93"), "", "0.93", True),
        (MASS, [1, 3904], "kg", "3904 kg", True),
    ],
)
def test_a_parameter_is_compared_in_the_unit_of_the_print(path, value, unit, shown, same):
    assert compared(path, row(value, unit)) == (path.partition(".")[2], shown, same)


def test_every_parameter_of_the_table_exists():
    paths = {path for each in printed.rows() for path in each.parameters}
    assert len(paths) > 40
    assert all(parameter(path).name for path in paths)


def test_a_parameter_that_does_not_exist():
    with pytest.raises(KeyError, match="weight"):
        parameter("two_motor_vehicle.TwoMotorVehicle.weight")
