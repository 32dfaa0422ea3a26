"""Protected frames, from the sender's bytes to what a receiver takes."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from e2e import p01, p02, p05

from evcosim.cosim.can.as_sent import as_sent
from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import framing_of
from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.frame_path import FramePath
from evcosim.master.engine.listener_tables import judgments
from evcosim.master.engine.sender import Sender

VALUE = Signal("Value", 24, 16, not_available=0xFFFF, scale=0.5)
PROFILES = {
    "1A": {"data_id": 0x1234},
    "1B": {"data_id": 0x1234},
    "1C": {"data_id": 0x1234, "nibble": "Nibble"},
    "2": {"data_id": list(range(7, 23))},
    "5": {"data_id": 0x1234},
}


class Path:
    """A message of 8 bytes over a bus with a delay of one step, received in slot 1, its status in slot 2."""

    def __init__(self, profile: str = "", length: int = 8, **own: object) -> None:
        wide = profile == "5"
        signals = [
            Signal("Crc", 0, 16 if wide else 8), Signal("Counter", 16 if wide else 8, 8 if wide else 4),
            *([] if wide else [Signal("Nibble", 12, 4)]), VALUE,
        ]  # fmt: skip # a list
        if profile:
            own["e2e"] = {"profile": profile, "crc": "Crc", "counter": "Counter", **PROFILES[profile]}
        use = BusSettings(messages={"M": MessageSettings.model_validate(own)})
        message = Message("test.dbc", "M", 1, length=length, signals={s.name: s for s in signals})
        message = as_sent(message, use)
        framing = dataclasses.replace(framing_of(message, use), status=(2,))
        routes = (SignalRoute(VALUE, 0, Affine(), ((1, Affine(2.0)),)),)
        plan = MessagePlan("can0", message, use, routes, {}, 1, 0, None, delay=1, framing=framing)
        self.memory = np.array([0.0, -7.0, -1.0])
        sender = Sender(plan, MessageChannel(message, routes), memoryview(self.memory), None)
        self.path = FramePath([sender], self.memory, 0.01, True, {1: -7.0})
        self.k = 0

    @property
    def judged(self) -> dict[str, object]:
        """What is counted of the message."""
        (found,) = judgments(self.path.arrays, 0)
        return found

    def step(self, value: float, spoil=lambda payload: None, lost: bool = False) -> tuple[float, float]:
        """Send a value, spoil the frame under way; return what is received a step later, and its status."""
        self.memory[0] = value
        self.path.act(T.SEND, 0, self.k)
        ring, flights = self.path.arrays["rings"][0], self.path.arrays["flights"]
        row = flights[(ring[T.HEAD] + ring[T.COUNT] - 1) % ring[T.ROWS]]
        spoil(row[T.PAYLOAD : T.PAYLOAD + 8])
        ring[T.COUNT] -= lost
        self.k += 1
        self.path.act(T.ARRIVE, 0, self.k)
        self.path.act(T.WATCH, 0, self.k)
        return float(self.memory[1]), float(self.memory[2])


@pytest.mark.parametrize("profile", PROFILES)
def test_values_arrive_with_a_counter_that_goes_round(profile):
    path = Path(profile)
    received = [path.step(value) for value in range(40)]
    assert received == [(2.0 * value, 0.0 if value else 4.0) for value in range(40)]
    frames = [data for *_, data in path.path.log_of("can0").frames[0].frames()]
    counters = [data[2] if profile == "5" else data[1] & 15 for data in frames]
    assert counters == [n % {"5": 256, "2": 16}.get(profile, 15) for n in range(40)]


@pytest.mark.parametrize("profile", PROFILES)
def test_every_flipped_bit_is_seen(profile):
    for bit in range(64):
        path = Path(profile)
        path.step(10.0)

        def flip(payload, bit=bit):
            payload[bit // 8] ^= 1 << bit % 8

        assert path.step(20.0, flip)[0] == 20.0  # the value of the frame before, times 2
        assert path.memory[2] in (2.0, 64.0)
        assert path.judged["rejected"] == 1


@pytest.mark.parametrize("length", [8, 9, 12, 13, 20, 33])
@pytest.mark.parametrize("profile", PROFILES)
def test_the_checksum_covers_the_bytes_of_the_message_alone(profile, length):
    """Those that fill a CAN FD frame are 0, and no part of it: autosar-e2e over the message's own bytes."""
    mode = dict(zip(("1A", "1B", "1C"), (
        p01.E2E_P01_DATAID_BOTH, p01.E2E_P01_DATAID_ALT, p01.E2E_P01_DATAID_NIBBLE,
    ), strict=True)).get(profile)  # fmt: skip # a table
    path = Path(profile, length)
    for value in range(20):
        assert path.step(value)[0] == 2.0 * value
    for *_, data in path.path.log_of("can0").frames[0].frames():
        own = bytearray(data[:length])
        assert len(data) >= length and not any(data[length:])
        if profile == "5":
            assert p05.e2e_p05_check(own, 0x1234)
        elif profile == "2":
            assert p02.e2e_p02_check(own, bytes(range(7, 23)))
        else:
            assert p01.e2e_p01_check(own, 0x1234, data_id_mode=mode)


def test_a_frozen_frame_with_a_right_checksum_is_repeated():
    path = Path("1A")
    kept = []
    path.step(1.0)
    path.step(2.0, lambda payload: kept.extend(payload))

    def freeze(payload):
        payload[:] = kept

    assert path.step(3.0, freeze) == (4.0, 8.0)
    assert path.step(4.0, freeze) == (4.0, 8.0)
    assert path.step(5.0) == (10.0, 32.0)  # two were not taken, so that some were lost


def test_lost_frames_have_no_new_data_and_the_next_is_taken_with_its_gap():
    path = Path("1A")
    path.step(1.0)
    assert path.step(2.0, lost=True) == (2.0, 1.0)
    assert path.step(3.0) == (6.0, 32.0)
    assert path.step(4.0) == (8.0, 0.0)


@pytest.mark.parametrize(("choice", "after"), [("hold", 2.0), ("initial", -7.0), ("sna", 2 * 0xFFFF * 0.5)])
@pytest.mark.parametrize("profile", ["", "1A"])
def test_after_a_timeout_receivers_have_what_stands_in(profile, choice, after):
    path = Path(profile, timeout=3, on_timeout=choice)
    path.step(1.0)
    assert [path.step(2.0, lost=True)[0] for _ in range(4)] == [2.0, 2.0, after, after]
    assert path.judged["timeouts"] == 1
    assert path.memory[2] == 1.0
    assert path.step(5.0)[0] == 10.0  # with each check a greater step of the counter is taken
    assert path.step(6.0)[0] == 12.0


def test_rejected_frames_count_toward_the_timeout():
    path = Path("1A", timeout=2, on_timeout="initial")
    path.step(1.0)

    def spoil(payload):
        payload[5] ^= 4

    assert [path.step(2.0, spoil)[0] for _ in range(3)] == [2.0, -7.0, -7.0]
    assert not math.isnan(path.memory[1])
