"""A message as its bus sends it: times, and the kind and length of its frame."""

from __future__ import annotations

import pytest

from evcosim.cosim.can.as_sent import as_sent
from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.database import Message
from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.can.timing.lengths import FD_LENGTHS


def message(cycle: float | None, **more) -> Message:
    return Message("ev.dbc", "M", 1, cycle_time=cycle, start_delay=0.03, **more)


@pytest.mark.parametrize(
    ("given_ms", "bus", "own", "seconds"),
    [
        (20, None, None, 0.02),
        (20, 0.05, None, 0.02),
        (None, 0.05, None, 0.05),
        (20, 0.05, 0.1, 0.1),
        (None, None, 0.1, 0.1),
        (None, None, None, None),
    ],
)
def test_the_settings_give_what_the_database_has_not(given_ms, bus, own, seconds) -> None:
    messages = {"M": MessageSettings(cycle_time=own), "Other": MessageSettings(cycle_time=9.0)}
    timed = as_sent(
        message(None if given_ms is None else given_ms / 1000), BusSettings(cycle_time=bus, messages=messages)
    )
    assert (timed.cycle_time, timed.start_delay) == (seconds, 0.03)


@pytest.mark.parametrize("delay", [0.0, 0.07])
def test_a_start_delay_of_the_settings_counts(delay: float) -> None:
    settings = BusSettings(messages={"M": MessageSettings(start_delay=delay)})
    assert as_sent(message(0.02), settings).start_delay == delay


@pytest.mark.parametrize(
    ("of_message", "bus", "own", "fd"),
    [
        ({"length": 8}, None, None, False),
        ({"length": 8, "fd": True}, None, None, True),
        ({"length": 9}, None, None, True),
        ({"length": 8}, True, None, True),
        ({"length": 8}, True, False, False),
        ({"length": 8}, False, True, True),
        ({"length": 8, "fd": True}, False, None, False),
        ({"length": 9, "j1939": True}, None, None, False),
        ({"length": 8, "j1939": True}, True, True, False),
    ],
)
def test_the_kind_of_a_frame(of_message, bus, own, fd) -> None:
    settings = BusSettings(fd=bus, messages={"M": MessageSettings(fd=own)})
    made = as_sent(message(0.01, **of_message), settings)
    assert (made.fd, made.length, made.problem) == (
        fd,
        12 if fd and of_message["length"] == 9 else of_message["length"],
        "",
    )


@pytest.mark.parametrize("length", range(65))
def test_a_frame_has_a_length_that_there_is(length) -> None:
    made = as_sent(message(0.01, length=length), BusSettings())
    assert made.length in FD_LENGTHS and made.length >= length
    assert all(n < length for n in FD_LENGTHS if n < made.length)
    assert made.fd == (length > 8)
    assert (
        (made.own_length or made.length) == length == (as_sent(made, BusSettings()).own_length or made.length)
    )


def test_a_message_that_no_classic_frame_holds() -> None:
    said = "the message has 9 bytes, and `fd = false` leaves it a classic frame of 8"
    for settings in (BusSettings(fd=False), BusSettings(fd=True, messages={"M": MessageSettings(fd=False)})):
        assert as_sent(message(0.01, length=9), settings).problem == said
        assert as_sent(message(0.01, length=8), settings).problem == ""
