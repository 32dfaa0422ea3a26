"""A system with a variation of its buses."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import System, SystemFile
from evcosim.cosim.system.variation import varied


def system(**buses: dict[str, object]) -> System:
    file = {"name": "s", "units": {"a": {"fmu": "A"}}, "buses": buses}
    return System(Path("s.toml"), SystemFile.model_validate(file))


def test_all_buses_are_varied_each_from_its_own_settings() -> None:
    given = system(
        one={"dbc": "a.dbc", "cycle": 2}, two={"dbc": "b.dbc", "delay": 0.02, "rounding": "truncate"}
    )
    one, two = varied(given, BusVariation(delay_steps=1, cycle=3), 0.01).file.buses.values()
    assert (one.dbc, one.delay, one.cycle, one.rounding) == ("a.dbc", 0.01, 6, "nearest")
    assert (two.dbc, two.delay, two.cycle, two.rounding) == ("b.dbc", 0.03, 3, "truncate")


def test_the_system_that_was_given_stays_as_it_is() -> None:
    given = system(one={"dbc": "a.dbc"})
    varied(given, BusVariation(delay_steps=1), 0.01)
    assert given.file.buses["one"].delay == 0.0


def test_no_variation_is_the_same_system() -> None:
    given = system(one={"dbc": "a.dbc", "resolution": 2.0}, two={"dbc": "b.dbc", "resolution": "ideal"})
    assert varied(given, BusVariation(), 0.01) == given


def test_a_system_without_a_bus_is_refused() -> None:
    said = r"^s\.toml: a variation of its buses was asked for, but the system has none$"
    with pytest.raises(ConfigError, match=said):
        varied(system(), BusVariation(), 0.01)
