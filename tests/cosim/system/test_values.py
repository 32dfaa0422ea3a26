"""Values of files and calls: in the type of their variable, exactly, or refused with place and rule."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.system.values import as_double, checked, of_type
from evcosim.cosim.texts import Texts

REAL = VariableInfo("x", unit="kg", min=-1.0, max=5.0)
INTEGER = VariableInfo("n", "Integer", limits=(-(2**63), 2**63 - 1))
BOOLEAN = VariableInfo("b", "Boolean")
STRING = VariableInfo("s", "String")
STATE = VariableInfo(
    "e", "Enumeration", items=((1, "off"), (2, "on"), (4, "broken")), limits=(-(2**31), 2**31 - 1)
)


@pytest.mark.parametrize(
    ("variable", "given", "value"),
    [
        (REAL, 3, 3.0),
        (REAL, np.float32(0.5), 0.5),
        (INTEGER, 2.0, 2),
        (INTEGER, 2**53 + 1, 2**53 + 1),
        (INTEGER, np.int64(-7), -7),
        (BOOLEAN, 1, True),
        (BOOLEAN, 0.0, False),
        (BOOLEAN, np.True_, True),
        (STATE, "broken", 4),
        (STATE, 2.0, 2),
        (STRING, "a", "a"),
    ],
)  # fmt: skip # one case a line
def test_a_value_is_taken_in_the_type_of_its_variable(
    variable: VariableInfo, given: object, value: object
) -> None:
    found = checked(given, variable, "here")
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize(
    ("variable", "given", "said"),
    [
        (REAL, True, "x is a finite Real number, not true"),
        (REAL, "1", "x is a finite Real number, not '1'"),
        (REAL, math.nan, "x is a finite Real number, not nan"),
        (REAL, 10**400, f"x is a finite Real number, not 1{76 * '0'}..."),
        (REAL, -2, "-2 kg is below the minimum -1.0 kg of x"),
        (REAL, 5.5, "5.5 kg is above the maximum 5.0 kg of x"),
        (INTEGER, 0.5, "n is an Integer, not 0.5"),
        (INTEGER, True, "n is a finite Integer number, not true"),
        (INTEGER, 2**63, f"{2**63} is beyond the numbers of n, {-(2**63)} to {2**63 - 1}"),
        (BOOLEAN, 2, "b is a Boolean, true or false, not 2"),
        (BOOLEAN, "true", "b is a Boolean, true or false, not 'true'"),
        (STATE, 3, "3 is no item of e: 1 off, 2 on, 4 broken"),
        (STATE, "of", "e has no item 'of' (did you mean 'off'?): ['off', 'on', 'broken']"),
        (STRING, 1, "s is a String, not 1: a text stands in quotes"),
        (STRING, "a\0b", 's = "a\\u0000b": no C text holds a NUL or half a character'),
    ],
)  # fmt: skip # one case a line
def test_any_other_value_is_refused(variable: VariableInfo, given: object, said: str) -> None:
    with pytest.raises(ConfigError) as refusal:
        checked(given, variable, "here")
    assert str(refusal.value) == f"here: {said}"


def test_limits_count_for_nothing_where_only_the_type_does() -> None:
    assert of_type(9, REAL, "here") == 9.0


def test_an_enumeration_of_many_items_shows_the_first() -> None:
    many = VariableInfo("e", "Enumeration", items=tuple((i, f"i{i}") for i in range(20)))
    with pytest.raises(ConfigError, match=r"99 is no item of e: 0 i0, .*, 11 i11, \.\.\.$"):
        of_type(99, many, "here")


@given(st.integers(-(2**63), 2**63 - 1))
def test_a_whole_number_is_kept_exactly_or_refused(number: int) -> None:
    try:
        assert int(as_double(INTEGER, number, "here", Texts())) == number
    except ConfigError as error:
        assert abs(number) > 2**53
        assert str(error).startswith(f"here: n = {number} is more than a double")


@pytest.mark.parametrize("number", [2**53 + 1, -(2**53) - 1, 2**63 - 1])
def test_what_no_double_holds_is_refused(number: int) -> None:
    with pytest.raises(
        ConfigError, match="more than a double, in which a run keeps its values, holds exactly"
    ):
        as_double(INTEGER, number, "here", Texts())


def test_a_text_is_kept_as_its_number() -> None:
    texts = Texts()
    number = as_double(STRING, of_type("a", STRING, "here"), "here", texts)
    assert texts.text(number) == "a"


SINGLE = VariableInfo("f", limits=(-(2.0 - 2.0**-23) * 2.0**127, (2.0 - 2.0**-23) * 2.0**127))
DOUBLE = VariableInfo("x")


@given(st.integers(-(10**20), 10**20), st.sampled_from([SINGLE, DOUBLE]))
def test_a_whole_number_is_a_real_exactly_or_refused(number: int, variable: VariableInfo) -> None:
    try:
        found = of_type(number, variable, "here")
    except ConfigError as error:
        below, above = map(int, str(error).partition("the nearest are ")[2].split(" and "))
        assert below < number < above
        for near in (below, above):
            assert of_type(near, variable, "here") == near
    else:
        assert int(found) == number
        assert of_type(float(number), variable, "here") == number


@pytest.mark.parametrize(
    ("variable", "number", "said"),
    [
        (DOUBLE, 2**53 + 1, "double holds exactly: the nearest are 9007199254740992 and 9007199254740994"),
        (
            DOUBLE,
            -(2**53) - 1,
            "double holds exactly: the nearest are -9007199254740994 and -9007199254740992",
        ),
        (SINGLE, 2**24 + 1, "Float32 holds exactly: the nearest are 16777216 and 16777218"),
    ],
)
def test_a_whole_number_that_no_real_is_is_named_with_the_nearest(
    variable: VariableInfo, number: int, said: str
) -> None:
    with pytest.raises(ConfigError) as refusal:
        of_type(number, variable, "here")
    assert str(refusal.value) == f"here: {variable.name} = {number} is no number that a {said}"


def test_a_decimal_number_means_the_nearest_double() -> None:
    for number in (0.1, 9007199254740993.5, 1e23, 2**53, 10**22):
        assert of_type(number, DOUBLE, "here") == number
    assert of_type(0.1, SINGLE, "here") == 0.1
