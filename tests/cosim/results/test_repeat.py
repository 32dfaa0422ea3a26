"""The command that repeats a run says what the run was given, and nothing else."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import pytest

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.results.repeat import command_of, given_options
from evcosim.cosim.system.run_options import RunOptions
from evcosim.master.cli.arguments import parse_inputs, parse_settings


def test_what_is_left_out_is_not_said() -> None:
    nothing: Any = dict.fromkeys(RunOptions.__optional_keys__) | {"ideal": False, "parameters": {}}
    assert given_options(nothing) == {}
    assert command_of("scooter", "", {}) == "evcosim run scooter"


@pytest.mark.parametrize(
    "value", [1, -2.5, 1e-9, True, False, "fast", "3", "true", "two words", 'a"b', "é$", ""]
)
def test_a_value_is_read_back_as_it_was(value: object) -> None:
    words = shlex.split(
        command_of("my own.toml", "s", {"parameters": {"a.b": value}, "start": {"a.c": value}})
    )
    assert words[:5] == ["evcosim", "run", "my own.toml", "--scenario", "s"]
    for flag, name in (("--set", "a.b"), ("--start", "a.c")):
        read = parse_settings([words[words.index(flag) + 1]])[name]
        assert read == value and type(read) is type(value)


def test_tables_and_fmus_are_named_as_they_were() -> None:
    options = {"inputs": {"u": Path("a b.csv")}, "fmus": {"vehicle": "my/Car.fmu"}, "record": ["*", "!ecu.*"]}
    words = shlex.split(command_of("x", "", options))
    assert parse_inputs([words[words.index("--input") + 1]]) == {"u": "a b.csv"}
    assert words[words.index("--fmu") + 1] == "vehicle=my/Car.fmu"
    assert words[-4:] == ["--record", "*", "--record", "!ecu.*"]


def test_what_no_command_says_has_none() -> None:
    given = given_options({"bus": BusVariation(delay_steps=2)})
    assert given == {"bus": {"delay_steps": 2, "resolution": 1.0, "cycle": 1}}
    assert command_of("scooter", "", given) == command_of("", "", {}) == ""
