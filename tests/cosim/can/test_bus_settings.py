"""The settings of a bus, and a variation of them."""

from __future__ import annotations

import pytest
from pydantic import TypeAdapter

from evcosim.cosim.can.bus_settings import BusSettings, BusVariation
from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import BusEntry
from evcosim.cosim.system.toml import validate


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"rounding": "up"}, "rounding: Input should be 'nearest', 'half_even' or 'truncate', not 'up'"),
        ({"overflow": "clip"}, "overflow: Input should be 'saturate', 'wrap' or 'error', not 'clip'"),
        ({"bitrate": 0}, "bitrate: Input should be greater than 0, not 0"),
        ({"cycle_time": 0.0}, "cycle_time: Input should be greater than 0, not 0.0"),
    ],
)
def test_unknown_settings_are_refused(keys, said):
    with pytest.raises(ConfigError, match=f"^here: {said}$"):
        validate(keys, BusSettings, "here")


def test_settings_do_not_change_after_they_are_made():
    with pytest.raises(ValueError, match="frozen"):
        BusSettings().delay = 1.0  # type: ignore[misc] # the point of the test


def test_a_bus_of_a_file_is_its_settings_and_a_database():
    assert list(BusEntry.model_fields) == ["dbc", *BusSettings.model_fields, "units"]
    assert isinstance(BusEntry(dbc="x.dbc"), BusSettings)


def test_a_schema_says_what_a_resolution_is():
    (factor, word) = TypeAdapter(BusSettings).json_schema()["properties"]["resolution"]["anyOf"]
    assert (factor, word) == ({"type": "number", "minimum": 1, "maximum": 1e9}, {"const": "ideal"})


# ---- variations


def test_the_option_comes_on_top_of_the_file():
    entry = BusEntry(dbc="x.dbc", delay=0.01, resolution=2, cycle=3)
    more = BusVariation(delay_steps=2, resolution=4, cycle=2).of(entry, 0.01)
    assert (more.delay, more.resolution, more.cycle) == (pytest.approx(0.03), 8.0, 6)
    assert BusVariation(resolution="ideal").of(entry, 0.01).resolution == "ideal"
    assert BusVariation().of(entry, 0.01) == entry
    messages = {"M": MessageSettings(jitter=0.002)}
    own = entry.model_copy(update={"jitter": 0.001, "seed": 3, "messages": messages})
    chance = BusVariation(jitter=0.004, seed=2).of(own, 0.01)
    assert (chance.jitter, chance.seed, chance.jitter_of("M")) == (0.005, 5, 0.006)


def test_a_variation_leaves_the_other_settings():
    entry = BusEntry(dbc="x.dbc", rounding="truncate", overflow="wrap", bitrate=125_000)
    varied = BusVariation(delay_steps=1, resolution=2, cycle=3).of(entry, 0.01)
    changed = {"delay", "resolution", "cycle"}
    assert varied.model_dump(exclude=changed) == entry.model_dump(exclude=changed)


def test_two_variations_are_one_after_the_other():
    settings, h = BusSettings(delay=0.01, resolution=2, cycle=3), 0.01
    one, two = BusVariation(1, 2.0, 2), BusVariation(2, 4.0, 5)
    assert two.of(one.of(settings, h), h) == BusVariation(3, 8.0, 10).of(settings, h)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"delay_steps": -1}, "delay_steps = -1: it is 0 or more steps"),
        ({"delay_steps": 0.5}, "delay_steps = 0.5"),
        ({"cycle": 0}, "cycle = 0: it is a whole number from 1 on"),
        ({"cycle": True}, "cycle = True"),
        ({"resolution": 0.5}, 'resolution = 0.5: a resolution is a factor from 1 to 1e9, or "ideal"'),
        ({"resolution": float("inf")}, "resolution = inf"),
        ({"resolution": "idael"}, "resolution = 'idael'"),
        ({"loss": 1.1}, "loss = 1.1: it is a number from 0 to 1"),
        ({"loss": -0.1}, "loss = -0.1"),
        ({"loss": float("nan")}, "loss = nan"),
        ({"jitter": -1.0}, "jitter = -1.0: it is a number from 0 to"),
        ({"jitter": True}, "jitter = True"),
        ({"seed": -1}, "seed = -1: it is a whole number from 0 to 9223372036854775807"),
        ({"seed": 2**63}, "seed = 9223372036854775808"),
    ],
)
def test_wrong_options(values, text):
    with pytest.raises(ConfigError, match=text):
        BusVariation(**values)
