"""Parameters and start values: of an option, else of the scenario, else of the system, each in its place."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from support.car import BUS, SENT, plan


def test_a_start_value_of_an_option_counts_before_those_of_the_files() -> None:
    units = {"car": {"start": {"grade": 0.01, "throttle": 5.0}}}
    scenario = {"start": {"car": {"grade": 0.02}}}
    assert plan([], scenario, units=units).units[1].start == {"grade": 0.02, "throttle": 5.0}
    for option in ("start", "parameters"):
        changed = plan([], scenario, units=units, options={option: {"car.grade": 0.03}})
        assert changed.units[1].start == {"grade": 0.03, "throttle": 5.0}


@pytest.mark.parametrize(
    ("start", "said"),
    [
        ({"cart.grade": 1.0}, r"^start cart\.grade: there is no unit 'cart' \(did you mean 'car'\?\)"),
        (
            {"car.grad": 1.0},
            r"^start car\.grad: unit 'car' has no variable 'grad' \(did you mean",
        ),
        ({"car.grade": "steep"}, r"^start car\.grade: grade is a finite Real number, not 'steep'"),
        (
            {"car.mass": 9.0},
            r"^start car\.mass: car\.mass is a parameter, which --set sets",
        ),
        ({"car.speed": 9.0}, r"^start car\.speed: .* whose initial value the FMU computes or fixes"),
        ({"ecu.speed": 9.0}, r"^start ecu\.speed: the input is driven by car\.speed via can0"),
    ],
)
def test_a_wrong_start_value_is_named(start: dict[str, object], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        plan([SENT], **BUS, options={"start": start})


def test_a_value_is_given_once() -> None:
    both = {"start": {"car.grade": 1.0}, "parameters": {"car.grade": 2.0}}
    with pytest.raises(ConfigError, match=r"^start car\.grade: 1\.0 is for .* already: 2\.0$"):
        plan([], options=both)
