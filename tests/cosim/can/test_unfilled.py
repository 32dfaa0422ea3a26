"""What signals that nothing fills have in a frame, beside cantools."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cantools
import pytest

from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.can.framing import Framing, Protection
from evcosim.cosim.can.logs.frames import BusLog, frames
from evcosim.cosim.can.pages import pages
from evcosim.cosim.can.protection.profiles import P1A
from evcosim.cosim.can.unfilled import raw_values, unfilled
from evcosim.cosim.clock import Clock
from evcosim.cosim.units.measure import Affine
from support.unfilled import DATABASE, EXPECTED


@pytest.fixture
def message(tmp_path: Path) -> Message:
    (tmp_path / "u.dbc").write_text(DATABASE)
    return load_dbc(tmp_path / "u.dbc").messages["Long"]


def test_the_code_of_not_available_then_the_start_value_then_zero(message: Message) -> None:
    found = {each.signal.name: (each.raw, each.reason) for each in unfilled(message, ["Fed"])}
    assert found == EXPECTED


def test_the_log_of_values_has_the_bytes_that_cantools_makes_of_them(tmp_path: Path, message: Message):
    route = SignalRoute(message.signals["Fed"], 0, Affine(), ())
    channel = MessageChannel(message, [route], log_raw=True)
    channel.transmit([5.0], 0)
    (frame,) = frames([BusLog("can0", [channel.log])], Clock.counted(0.0, 0.01, 0))
    codec = cantools.database.load_file(tmp_path / "u.dbc", strict=False).get_message_by_name("Long")
    raws = {"Fed": 5} | {name: raw for name, (raw, _) in EXPECTED.items()}
    assert frame.data == codec.encode(raws, scaling=False, strict=False)


def test_what_a_protection_fills_and_multiplexers_are_filled() -> None:
    crc, counter = Signal("Crc", 0, 8, not_available=255), Signal("Counter", 8, 4, not_available=15)
    selector = Signal("Page", 12, 4, not_available=15, is_multiplexer=True)
    first, second, all_ = (
        Signal("First", 16, 8, not_available=255, multiplexer="Page", multiplexer_ranges=((3, 3),)),
        Signal("Second", 16, 8, start_raw=9, multiplexer="Page", multiplexer_ranges=((4, 4),)),
        Signal("All", 24, 8),
    )
    signals = {s.name: s for s in (crc, counter, selector, first, second, all_)}
    message = Message("f", "M", 1, length=4, signals=signals)
    framing = Framing(Protection(P1A, (1,), crc, counter, None, 1))
    (page,) = pages(message, ["First"])
    sent = page.of(message)
    assert [each.signal.name for each in unfilled(sent, ["First"], framing)] == ["All"]
    assert [each.signal.name for each in unfilled(sent, ["First"])] == ["Crc", "Counter", "All"]
    assert raw_values(sent)["Page"] == 3  # not its code: it says which page this is


def test_what_no_frame_holds_is_left_out() -> None:
    good = Signal("Good", 0, 8, not_available=255)
    flawed = [
        Signal("Beyond", 60, 8, not_available=255, problem="it does not fit"),
        Signal("Odd", 8, 24, is_float=True),
    ]
    fed = Signal("Fed", 8, 8)
    message = Message("f", "M", 1, signals={s.name: s for s in (good, fed, *flawed)})
    assert raw_values(message) == {"Good": 255, "Fed": 0}
    assert [each.signal for each in unfilled(message, ["Fed"])] == [good]
    channel = MessageChannel(message, [SignalRoute(fed, 0, Affine(), ())], log_raw=True)
    channel.transmit([18.0], 0)
    (frame,) = frames([BusLog("can0", [channel.log])], Clock.counted(0.0, 0.01, 0))
    assert frame.data == bytes.fromhex("FF12000000000000")


@pytest.mark.parametrize(("code", "raw"), [(127, 127), (128, 7), (-1, 7), (None, 7)])
def test_a_code_that_the_bits_do_not_hold_is_none(code: int | None, raw: int) -> None:
    signal = Signal("S", 0, 7, start_raw=7, not_available=code)
    message = Message("f", "M", 1, signals={"S": signal})
    assert raw_values(message) == {"S": raw}
    as_float = dataclasses.replace(signal, length=32, is_float=True, start_raw=7.5)
    assert raw_values(dataclasses.replace(message, signals={"S": as_float})) == {"S": 7.5}
