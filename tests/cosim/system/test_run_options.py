"""The options of a run: their names, and what they may be."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import evcosim
from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.run_options import RunOptions, check_options, in_floats

ARRAYS = [np.array(0.5), np.array(0.5, np.float32), np.array(Decimal("0.5"))]
NO_NUMBERS = [
    *(Decimal(text) for text in ("NaN", "sNaN", "Infinity", "1e999")),
    *(np.array(value) for value in ([0.5], True, "0.5", 0.5j, None, float("nan"), np.timedelta64(1, "s"))),
    *(np.bool_(True), np.datetime64(1, "s"), np.timedelta64(1, "s")),
]


def test_the_names_that_there_are_pass() -> None:
    check_options(dict.fromkeys(RunOptions.__optional_keys__))
    check_options({})


def test_every_option_may_be_left_out() -> None:
    assert not RunOptions.__required_keys__


@pytest.mark.parametrize("name", sorted(RunOptions.__optional_keys__))
def test_a_misspelled_name_is_told_the_nearest(name: str) -> None:
    with pytest.raises(TypeError, match=rf"has no option '{name}x' \(did you mean '{name}'\?\); there"):
        check_options({name: None, f"{name}x": None})


@pytest.mark.parametrize("name", sorted(RunOptions.__optional_keys__))
@pytest.mark.parametrize("value", ["no", b"", 1j, [], True])
def test_a_value_of_another_type_is_refused_by_name(name: str, value: object) -> None:
    if (name, value) in ((key, True) for key in ("allow_open", "ideal", "strict", "trust")):
        return check_options({name: value})
    with pytest.raises(ConfigError, match=rf"^{name} = {re.escape(repr(value))}: must be "):
        check_options({name: value})
    return None


def test_numbers_of_numpy_are_numbers() -> None:
    check_options({"stop_time": np.float32(1.5), "bus": BusVariation(delay_steps=np.int64(1))})


@pytest.mark.parametrize("name", ["delay", "stop_time", "step_size", "tolerance"])
@pytest.mark.parametrize("value", [0.5, Fraction(1, 2), Decimal("0.50"), np.float32(0.5), *ARRAYS])
def test_numbers_of_every_type_are_floats(name: str, value: float) -> None:
    given = {name: value}
    check_options(given)
    assert in_floats(given) == {name: 0.5}  # type: ignore[arg-type] # a key that is not known before
    assert isinstance(in_floats(given)[name], float)  # type: ignore[arg-type,literal-required] # as above


@pytest.mark.parametrize("text", ["0.01", "0.1", "0.3", "1e-3", "1.0000000000000001"])
def test_a_decimal_is_the_float_of_its_digits(text: str) -> None:
    assert in_floats({"step_size": Decimal(text)}) == {"step_size": float(text)}


@pytest.mark.parametrize("name", ["delay", "step_size", "tolerance"])
@pytest.mark.parametrize("value", NO_NUMBERS, ids=repr)
def test_what_is_no_real_number_is_refused(name: str, value: object) -> None:
    with pytest.raises(ConfigError, match=rf"^{name} = .*: must be a number "):
        check_options({name: value})


def test_a_run_takes_numbers_of_every_type() -> None:
    usual = evcosim.simulate("scooter", stop_time=0.05, step_size=0.005)
    for number in (Decimal, Fraction, lambda text: np.array(float(text))):
        again = evcosim.simulate("scooter", stop_time=number("0.05"), step_size=number("0.005"))
        assert np.array_equal(again.data, usual.data)


def test_what_is_a_number_already_stays() -> None:
    given: RunOptions = {"stop_time": 10, "step_size": None, "engine": "python"}
    assert in_floats(given) == given and isinstance(in_floats(given)["stop_time"], int)
