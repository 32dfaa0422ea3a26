"""The options of a run: declared once, the same for every verb, and those of the library."""

from __future__ import annotations

import inspect
from typing import get_args

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.run_options import RunOptions
from evcosim.cosim.system.system import Algorithm, EngineName, Isolation
from evcosim.master.cli import options
from evcosim.master.cli.options import QuietOption, SystemArgument, takes_run_options


@pytest.mark.parametrize(
    ("choices", "known"),
    [
        (options.AlgorithmChoice, Algorithm),
        (options.EngineChoice, EngineName),
        (options.IsolationChoice, Isolation),
    ],
)
def test_choices_are_those_of_the_library(choices, known):
    assert tuple(choice.value for choice in choices) == get_args(known)


def test_every_option_of_a_run_is_an_option_but_the_variation_of_buses():
    assert set(options._run_options()) == RunOptions.__optional_keys__ - {"bus"}


@takes_run_options("ideal", *options.ALONE)
def verb(system: SystemArgument, *, options: RunOptions, quiet: QuietOption = False):
    """Show the options."""
    return system, options, quiet


def test_a_verb_declares_them_in_the_place_of_its_argument():
    names = list(inspect.signature(verb).parameters)
    assert names[:5] == ["system", "settings", "starts", "fmus", "swaps"]
    assert names[-2:] == ["strict", "quiet"]
    assert not {"options", "ideal"} & set(names)
    assert verb.__doc__ == "Show the options."


def test_a_verb_receives_them_as_one_record():
    given = dict.fromkeys(("fmus", "swaps", "isolation", "step_size"))
    given |= {"starts": ["vehicle.road_grade=0.1"], "delay": 0.02, "record": ["vehicle.*", "!*.power"]}
    given |= {"settings": ["vehicle.mass=180"], "strict": True, "stop_time": 2.0}
    given |= {"allow_open": True, "trust": True}
    given |= {"algorithm": options.AlgorithmChoice.jacobi, "engine": options.EngineChoice.python}
    given |= {"units": options.UnitsChoice.native}
    system, found, quiet = verb(system="scooter", quiet=True, **given)
    assert (system, quiet) == ("scooter", True)
    assert found == {
        "parameters": {"vehicle.mass": 180},
        "start": {"vehicle.road_grade": 0.1},
        "delay": 0.02,
        "record": ["vehicle.*", "!*.power"],
        "inputs": {},
        "step_size": None,
        "interface": None,
        "tolerance": None,
        "fmus": {},
        "swaps": {},
        "ideal": False,
        "algorithm": "jacobi",
        "isolation": None,
        "trust": True,
        "engine": "python",
        "units": "native",
        "stop_time": 2.0,
        "strict": True,
        "allow_open": True,
    }


def test_an_error_about_a_parameter_names_the_option():
    @takes_run_options()
    def refuse(*, options: RunOptions):
        raise ConfigError("parameter a.b: too large")

    given = inspect.signature(refuse).parameters
    with pytest.raises(ConfigError, match=r"^--set a\.b=9: too large$"):
        refuse(**{name: ["a.b=9"] if name == "settings" else None for name in given})


@pytest.mark.parametrize(
    ("said", "typed"),
    [
        ("stop_time 0.0 s is not after start_time 0.0 s", "--stop-time 0.0 s is not after start_time 0.0 s"),
        ("step_size = 0: must be a number", "--step-size = 0: must be a number"),
        ("record: 'a' fits no variable", "--record: 'a' fits no variable"),
        ("fmus is for a system", "--fmu is for a system"),
        ("start a.b: too large", "--start a.b=9: too large"),
        ("recorded by nobody", "recorded by nobody"),
    ],
)
def test_an_error_about_an_option_names_it_as_it_was_typed(said, typed):
    @takes_run_options()
    def refuse(*, options: RunOptions):
        raise ConfigError(said)

    given = dict.fromkeys(inspect.signature(refuse).parameters)
    with pytest.raises(ConfigError) as caught:
        refuse(**given | {"starts": ["a.b=9"]})
    assert str(caught.value) == typed


@pytest.mark.parametrize(
    ("name", "missing"),
    [("run", ()), ("budget", ("--ideal", "--record")), ("identify", ("--stop-time", "--record"))],
)
def test_verbs_that_run_a_system_take_all_of_them(evcosim, name, missing):
    shown = evcosim(name, "--help").out
    known = (
        "--set",
        "--start",
        "--delay",
        "--step-size",
        "--record",
        "--fmu",
        "--swap",
        "--ideal",
        "--algorithm",
        "--isolation",
        "--engine",
        "--units",
        "--stop-time",
        "--strict",
    )
    assert {option for option in known if f"{option} " not in shown} == set(missing)
