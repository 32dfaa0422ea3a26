"""What the send types of settings and databases mean."""

from __future__ import annotations

import pytest

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.can.send_types import Sending, check_send_type, send_type_of
from evcosim.cosim.errors import ConfigError

NONE = MessageSettings()


def message(text: str = "", *signals: str, cycle: float | None = None) -> Message:
    made = {f"S{i}": Signal(f"S{i}", i, 1, send_type=kind) for i, kind in enumerate(signals)}
    return Message("t.dbc", "M", 1, length=8, send_type=text, signals=made, cycle_time=cycle)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("", "cyclic"), ("Cyclic", "cyclic"), ("NoMsgSendType", "cyclic"), ("cyclicX", "cyclic"),
        ("OnChange", "on_change"), ("Event", "on_change"), ("spontaneous", "on_change"),
        ("triggered", "on_change"),
        ("cyclicAndTriggered", "cyclic_and_on_change"), ("CyclicAndSpontan", "cyclic_and_on_change"),
        ("PeriodicEvent", "cyclic_and_on_change"), ("Cyclic_And_OnChange", "cyclic_and_on_change"),
        ("IfActive", "if_active"), ("cyclicIfActive", "if_active"), ("OnWrite", "on_write"),
    ],
)  # fmt: skip # pairs
def test_the_texts_of_databases(text, kind):
    assert send_type_of(message(text), NONE) == (kind, "")


def test_what_is_not_simulated_is_said():
    for text, kind in (("OnChangeWithRepetition", "on_change"), ("IfActiveWithRepetition", "if_active")):
        assert send_type_of(message(text), NONE) == (
            kind, f"has the send type {text}, whose repetitions are not simulated",
        )  # fmt: skip # a pair
    assert send_type_of(message("BAF"), NONE) == (
        "cyclic",
        "has the send type BAF, which is not simulated: it is sent at each cycle",
    )


@pytest.mark.parametrize(
    ("signals", "cycle", "kind"),
    [
        (["Cyclic", "Cyclic"], 0.1, "cyclic"), (["OnChange", "OnChange"], None, "on_change"),
        (["Cyclic", "OnChange"], 0.1, "cyclic_and_on_change"), (["OnWrite", "OnChange"], None, "on_change"),
        (["NoSigSendType", ""], 0.1, "cyclic"), (["NoSigSendType", "IfActive"], 0.1, "if_active"),
    ],
)  # fmt: skip # rows
def test_where_a_message_says_nothing_its_signals_do(signals, cycle, kind):
    assert send_type_of(message("NoMsgSendType", *signals, cycle=cycle), NONE)[0] == kind
    assert send_type_of(message("OnWrite", *signals, cycle=cycle), NONE)[0] == "on_write"


def test_settings_count_before_the_database():
    assert send_type_of(message("OnChange"), MessageSettings(cycle_time=0.1)) == ("cyclic", "")
    both = MessageSettings(send_type="if_active", cycle_time=0.1)
    assert send_type_of(message("BAF"), both) == ("if_active", "")


def test_a_frame_comes_in_each_cycle_or_it_does_not():
    kinds = ("cyclic", "on_change", "cyclic_and_on_change", "if_active", "on_write")
    assert [Sending(kind).regular for kind in kinds] == [True, False, True, False, True]


@pytest.mark.parametrize(
    ("own", "pages", "rule"),
    [
        ({"min_interval": 0.1}, 1, "min_interval: a cyclic message has its cycle time"),
        ({"send_type": "on_change", "cycle_time": 0.1}, 1, 'no cycle, "cyclic_and_on_change" has one'),
        ({"send_type": "on_write", "cycle_time": 0.1}, 1, "a message that is sent on_write has no cycle"),
        ({"send_type": "on_change", "timeout": 3}, 1, "does not come where nothing changes"),
        ({"send_type": "if_active", "timeout": 3}, 1, "does not come where it is not active"),
        ({"send_type": "on_change"}, 2, "the 2 pages of a multiplexed message are sent cyclically"),
    ],
)
def test_settings_that_do_not_fit_are_refused(own, pages, rule):
    settings = BusSettings(messages={"M": MessageSettings(**own)})
    with pytest.raises(ConfigError, match=r"^s\.toml: buses\.c\.messages\.M\.") as refused:
        check_send_type(message("", cycle=0.1), settings, pages, "s.toml: buses.c")
    assert rule in str(refused.value)


def test_settings_that_fit():
    for own in ({"send_type": "on_change", "min_interval": 0.1}, {"send_type": "on_write", "timeout": 2}, {}):
        check_send_type(message(cycle=0.1), BusSettings(messages={"M": MessageSettings(**own)}), 1, "s.toml")
