"""The parsers of options: values as in TOML, settings, files, times."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.cli.arguments import as_typed, parse_files, parse_inputs, parse_settings, scalar, seconds


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True),
        ("false", False),
        ("180", 180),
        ("-3", -3),
        ("1_000", 1000),
        ("0.5", 0.5),
        (".5", 0.5),
        ("1e3", 1000.0),
        ("True", "True"),
        ("velocity", "velocity"),
        ('"180"', "180"),
        ("[1, 2]", "[1, 2]"),
        ("a = b", "a = b"),
        ("1\nother = 2", "1\nother = 2"),
    ],
)
def test_scalars(text, value):
    assert scalar(text) == value
    assert type(scalar(text)) is type(value)


def test_settings_by_name():
    assert parse_settings(["a.b=1", "a.c=x=y"]) == {"a.b": 1, "a.c": "x=y"}
    assert parse_settings(["b=1", "a.b=2"], of_fmu=True) == {"b": 1, "a.b": 2}


@pytest.mark.parametrize("of_fmu", [False, True])
def test_a_parameter_is_set_once(of_fmu):
    with pytest.raises(ConfigError, match=r"^--set a\.b = 2: 'a\.b' is given already: --set a\.b=1$"):
        parse_settings(["a.b=1", "a.c=3", "a.b = 2"], of_fmu)


def test_an_input_is_given_once():
    with pytest.raises(ConfigError, match=r"^--input u=2: 'u' is given already: --input u=t\.csv$"):
        parse_inputs(["u=t.csv", "u=2"])


@pytest.mark.parametrize("option", ["vehicle.mass", "mass=180", "vehicle.=180", ".mass=180", "vehicle.mass="])
def test_a_setting_names_unit_parameter_and_value(option):
    with pytest.raises(ConfigError, match=r"--set .*: it is written unit\.parameter=value"):
        parse_settings([option])


def test_files_by_unit():
    assert parse_files("--fmu", ["a=x.fmu", "b = my/y=2.fmu"], "z.fmu") == {"a": "x.fmu", "b": "my/y=2.fmu"}
    with pytest.raises(ConfigError, match=r"--swap a: it is written unit=PATH, as in vehicle=my/swap\.toml"):
        parse_files("--swap", ["a"], "my/swap.toml")
    with pytest.raises(ConfigError, match=r"^--fmu a=y\.fmu: unit 'a' is given already: --fmu a=x\.fmu$"):
        parse_files("--fmu", ["a=x.fmu", "b=x.fmu", "a=y.fmu"], "z.fmu")


@pytest.mark.parametrize(
    ("text", "value"), [("5s", 5.0), ("500ms", 0.5), (" 2.5 ", 2.5), (".5 s", 0.5), ("1h", None)]
)
def test_times(text, value):
    if value is not None:
        assert seconds("--try", text) == value
    else:
        with pytest.raises(ConfigError, match="--try 1h: it is a time of up to an hour"):
            seconds("--try", text)


@pytest.mark.parametrize("text", ["0s", "3601", "-1s", "inf", ""])
def test_times_out_of_range(text):
    with pytest.raises(ConfigError, match="written 5s or 500ms"):
        seconds("--try", text)


@pytest.mark.parametrize("text", ["180,ecu.gain=1", "180 ecu.gain=1", "180; x[1].y = 2", "slow,b=2"])
def test_two_values_in_one_option_are_told(text):
    with pytest.raises(ConfigError, match="two values; --set is given for each of them"):
        parse_settings([f"a.b={text}"])
    assert parse_settings([f'a.b="{text}"']) == {"a.b": text}


def test_an_option_of_one_name_is_put_into_an_error_as_it_was_typed():
    names = {"input": "throtle", "output": None}
    with pytest.raises(ConfigError, match=r"^--input throtle: it is not there"), as_typed((), names=names):
        raise ConfigError("input throtle: it is not there")
    with pytest.raises(ConfigError, match=r"^output x: it"), as_typed((), names=names):
        raise ConfigError("output x: it is not there")
