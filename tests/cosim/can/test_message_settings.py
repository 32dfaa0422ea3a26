"""The settings of one message of a bus."""

from __future__ import annotations

import pytest

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.toml import validate


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"cycle_time": -1.0}, "cycle_time: Input should be greater than 0, not -1.0"),
        ({"start_delay": -1.0}, "start_delay: Input should be greater than or equal to 0, not -1.0"),
        ({"cycletime": 1.0}, r"cycletime: unknown key \(did you mean 'cycle_time'\?\)"),
    ],
)
def test_wrong_settings_are_refused(keys, said):
    with pytest.raises(ConfigError, match=rf"^here: messages\.M\.{said}"):
        validate({"messages": {"M": keys}}, BusSettings, "here")


def test_a_message_without_settings_has_those_of_no_file():
    own = MessageSettings(cycle_time=0.1)
    settings = BusSettings(messages={"M": own})
    assert (settings.of_message("M"), settings.of_message("N")) == (own, MessageSettings())
