"""The load of a bus before a run: shares, bounds, and what is refused."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.database import Message
from evcosim.cosim.can.send_types import Sending
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.bus_load import MessageLoad, bus_loads, check_load
from evcosim.cosim.plan.plan import MessagePlan


def sent(name: str, frame_id: int, every: int, settings: BusSettings, **message: object) -> MessagePlan:
    about = Message("f", name, frame_id, **message)  # type: ignore[arg-type] # those of a message
    return MessagePlan("can0", about, settings, (), {}, every, 0, None)


def test_shares_and_bounds_of_two_messages() -> None:
    settings = BusSettings(bitrate=500_000)
    messages = [sent("Low", 0x200, 2, settings), sent("High", 0x100, 1, settings, length=2)]
    load = bus_loads(messages, 0.01)["can0"]
    high, low = load.messages
    assert (high.name, low.name) == ("High", "Low")
    # 44 + 8 n + 3 bits without and 55 + 10 n with all stuff bits, of 2 us each (Davis 2007)
    assert (high.least, high.most) == pytest.approx((63 * 2e-6 / 0.01, 75 * 2e-6 / 0.01))
    assert (low.least, low.most) == pytest.approx((111 * 2e-6 / 0.02, 135 * 2e-6 / 0.02))
    assert load.most == pytest.approx(high.most + low.most)
    # the higher one waits for a frame of the other that has just begun, and takes its own bits but the last 3
    assert high.response == pytest.approx((135 + 72) * 2e-6)
    assert low.response == pytest.approx((75 + 132) * 2e-6)


def test_pages_of_a_message_count_once() -> None:
    settings = BusSettings()
    page = sent("M", 1, 4, settings)
    pages = [dataclasses.replace(page, first=i, page={"Mux": i}) for i in range(4)]
    (paged,) = bus_loads(pages, 0.01)["can0"].messages
    (plain,) = bus_loads([sent("M", 1, 1, settings)], 0.01)["can0"].messages
    assert paged == plain


def test_a_data_bit_rate_shortens_frames_of_can_fd() -> None:
    slow, fast = BusSettings(), BusSettings(data_bitrate=2_000_000)
    times = [
        bus_loads([sent("M", 1, 1, settings, length=64, fd=True)], 0.01)["can0"].messages[0].longest
        for settings in (slow, fast)
    ]
    assert times[1] < 0.4 * times[0]


def test_a_message_that_is_not_cyclic_has_its_minimum_interval_as_period() -> None:
    settings = BusSettings(bitrate=500_000)

    def of(sending: Sending, every: int = 1) -> MessageLoad:
        plan = dataclasses.replace(sent("M", 1, every, settings), sending=sending)
        return bus_loads([plan], 0.01)["can0"].messages[0]

    cyclic, spontaneous = of(Sending(), 5), of(Sending("on_change", 0, 5))
    assert (spontaneous.cycle, spontaneous.most, spontaneous.response) == (
        cyclic.cycle, cyclic.most, cyclic.response,
    )  # fmt: skip # a row
    assert spontaneous.least == 0.0  # it need not be sent at all
    assert spontaneous.every == "on_change, >= 50"
    without = of(Sending("on_change"))
    assert (without.bounded, without.every, without.cycle) == (
        False,
        "on_change, no min_interval: >= 10",
        0.01,
    )
    mixed = of(Sending("cyclic_and_on_change", 10, 5))
    assert (mixed.least, mixed.most) == pytest.approx((cyclic.least / 2, cyclic.most))
    assert of(Sending("on_write"), 5).least == cyclic.least
    assert cyclic.every == "50"


def test_jitter_is_part_of_the_bound() -> None:
    bounds = [
        bus_loads([sent("M", 1, 1, BusSettings(jitter=jitter))], 0.01)["can0"].messages[0].response
        for jitter in (0.0, 0.002)
    ]
    assert bounds[1] == pytest.approx(bounds[0] + 0.002)


def test_a_bus_that_cannot_carry_its_messages_is_refused_unless_frames_take_time() -> None:
    settings = BusSettings(bitrate=50_000)
    load = bus_loads([sent(f"M{i}", i, 1, settings) for i in range(5)], 0.01)["can0"]
    with pytest.raises(ConfigError, match=r'buses\.can0: its messages take 111\.0% of 50000 bit/s .*"frame"'):
        check_load(load, "instant", "s.toml: buses.can0")
    said = check_load(load, "frame", "p")
    assert said.endswith("take 111.0% of 50000 bit/s without any stuff bit: low priorities starve")
    assert load.messages[-1].response is None


def test_a_bus_that_stuff_bits_could_fill_is_a_warning() -> None:
    settings = BusSettings(bitrate=59_000)
    load = bus_loads([sent(f"M{i}", i, 1, settings) for i in range(5)], 0.01)["can0"]
    assert load.least < 1.0 < load.most
    assert "94.1% to 114.4% of 59000 bit/s" in check_load(load, "instant", "p")
    assert check_load(bus_loads([sent("M", 1, 1, settings)], 0.01)["can0"], "instant", "p") == ""
