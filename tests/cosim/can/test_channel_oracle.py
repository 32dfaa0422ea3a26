"""The channel against cantools: random databases, and every length, sign and order at both raw limits.

The random part and the sweep find different faults: a saturation that is off by one survives hundreds of
random examples and dies in the sweep at once.
"""

from __future__ import annotations

import itertools
import math
import tempfile
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import cantools
import hypothesis
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can import dbc
from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.can.quantization import ChannelError
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.units.measure import Affine

EV = Path(dbc.__file__).parents[1] / "data" / "can" / "ev.dbc"
ROUNDINGS = ("nearest", "half_even", "truncate")
SCALINGS = [(1, 0), (0.4, 0), (-0.5, 20), (3, -7), (0.001, -273.15), (1 / 3, 0.1), (1_000_003, 1)]


class Line:
    """One signal through a channel: value in, raw and physical value out."""

    def __init__(self, message: Message, name: str, rounding: str, overflow: str = "saturate") -> None:
        route = SignalRoute(message.signals[name], 0, Affine(), ((1, Affine()),))
        use = BusSettings(rounding=rounding, overflow=overflow)  # type: ignore[arg-type] # plain text in parameters
        self.channel = MessageChannel(message, [route], use, log_raw=True)
        self.memory = memoryview(bytearray(16)).cast("d")

    def __call__(self, value: float) -> float:
        self.memory[0] = value
        self.channel.transmit(self.memory, 0)
        return self.memory[1]

    def raws(self) -> list[int | float]:
        name = self.channel.routes[0].signal.name
        return [*self.channel.log.raws[name].tolist()]


def same(a: float, b: float) -> bool:
    """Equal bit for bit; -0.0 is not 0.0."""
    return a == b and math.copysign(1.0, a) == math.copysign(1.0, b)


def decoded(codec: Any, name: str, raw: int) -> float:
    """What cantools decodes from a frame with this raw value."""
    data = codec.encode({name: raw}, scaling=False, strict=False)
    return float(codec.decode(data, decode_choices=False)[name])


def type_range(signal: Signal) -> tuple[int, int]:
    """By the definition of two's complement, said here once more."""
    return (
        (-(2**signal.length) // 2, 2**signal.length // 2 - 1) if signal.signed else (0, 2**signal.length - 1)
    )


def expected_raw(signal: Signal, rounding: str, value: float) -> int:
    """Saturate, divide, round by exact fractions, clip: independent of the implementation."""
    x = value if signal.minimum is None else max(value, signal.minimum)
    x = x if signal.maximum is None else min(x, signal.maximum)
    low, high = type_range(signal)
    q = (x - signal.offset) / signal.scale
    if math.isinf(q):
        return high if q > 0 else low
    exact, half = Fraction(abs(q)), Fraction(1, 2)
    if rounding == "half_even":
        magnitude = round(exact)
    else:
        magnitude = math.floor(exact + half if rounding == "nearest" else exact)
    return min(max(int(math.copysign(1, q)) * magnitude, low), high)


# ---- the sweep


def sweep_text(signed: bool, little_endian: bool, limits: bool) -> str:
    """A message for each length and scaling."""
    lines = ['VERSION ""', "NS_ :", "BS_:", "BU_: A B"]
    cases = itertools.product(range(1, 65), enumerate(SCALINGS))
    for i, (length, (j, (scale, offset))) in enumerate(cases, start=1):
        signal = Signal("S", 0, length, signed=signed)
        ends = sorted(r * scale + offset for r in signal.raw_type_range)
        middle = [ends[0] + (ends[1] - ends[0]) * part for part in (0.26, 0.74)]  # off the raw grid
        ends = middle if limits else [0, 0]
        start = 0 if little_endian else 7
        order, sign = int(little_endian), "-" if signed else "+"
        lines += [
            f"BO_ {i} M{length}_{j}: 8 A",
            f' SG_ S : {start}|{length}@{order}{sign} ({scale!r},{offset!r}) [{ends[0]!r}|{ends[1]!r}] "" B',
            "",
        ]
    return "\n".join(lines) + "\n"


def edge_values(signal: Signal) -> Iterator[float]:
    """Values around both ends of the raw range and both limits, on the grid, off it, and half way."""
    ends = [*type_range(signal)]
    for limit in (signal.minimum, signal.maximum):
        if limit is not None:
            yield from (limit, math.nextafter(limit, -math.inf), math.nextafter(limit, math.inf))
            ends.append(round((limit - signal.offset) / signal.scale))
    for raw in ends:
        for step in (-2, -1, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1, 2):
            x = (raw + step) * signal.scale + signal.offset
            yield float(x)
            if step in (-0.5, 0.5):
                yield from (math.nextafter(x, -math.inf), math.nextafter(x, math.inf))
    yield from (0.0, -0.0, math.inf, -math.inf)


@pytest.mark.parametrize("limits", [False, True])
@pytest.mark.parametrize("little_endian", [False, True])
@pytest.mark.parametrize("signed", [False, True])
def test_every_length_and_scaling_at_both_raw_limits(
    tmp_path: Path, signed: bool, little_endian: bool, limits: bool
) -> None:
    path = tmp_path / "sweep.dbc"
    path.write_text(sweep_text(signed, little_endian, limits))
    codecs = cantools.database.load_file(path, strict=True)
    # the order of the bytes matters to the codec alone, so one rounding will do for the second order
    roundings = ROUNDINGS if little_endian else ROUNDINGS[:1]
    checked = 0
    for message in load_dbc(path).messages.values():
        codec, signal = codecs.get_message_by_name(message.name), message.signals["S"]
        values = [*dict.fromkeys(edge_values(signal))]
        for rounding in roundings:
            try:
                line = Line(message, "S", rounding)
            except ConfigError:
                assert limits and signal.length < 3  # no raw value lies between limits so close
                continue
            received = [line(x) for x in values]
            meanings: dict[int, float] = {}
            for x, y, raw in zip(values, received, line.raws(), strict=True):
                want = expected_raw(signal, rounding, x)
                if want not in meanings:
                    meanings[want] = decoded(codec, "S", want)
                assert (int(raw), y) == (want, meanings[want]), (signal, rounding, x, line.channel.source)
                checked += 1
    assert checked > 10_000


def test_the_sweep_has_points_on_both_sides_of_each_limit() -> None:
    signal = Signal("S", 0, 8, scale=0.4)
    raws = {expected_raw(signal, "nearest", x) for x in edge_values(signal)}
    assert {0, 1, 2, 253, 254, 255} <= raws
    assert any(x > 255.5 * 0.4 for x in edge_values(signal)) and any(x < -0.2 for x in edge_values(signal))


# ---- random databases


@st.composite
def databases(draw: st.DrawFn) -> str:
    """DBC text of one message: up to four signals, each somewhere in nine bytes of its own."""
    lines = []
    for i in range(draw(st.integers(1, 4))):
        is_float = draw(st.integers(0, 4)) == 0
        length = draw(st.sampled_from([32, 64]) if is_float else st.integers(1, 64))
        shift = draw(st.integers(0, 72 - length))
        little_endian, signed = draw(st.booleans()), draw(st.booleans())
        start = shift if little_endian else 8 * (shift // 8) + 7 - shift % 8
        scale = draw(st.sampled_from([1, 2, -1, 3, -7, 0.1, -0.5, 0.4, 0.01, 1 / 3, 1e-3, 1000, 0.0078125]))
        offset = draw(st.sampled_from([0, -40, 1000, 0.5, -273.15, 7, 1e6, 1e-5]))
        ends: list[float] = [0, 0]
        if draw(st.booleans()):  # limits at two raw values, or off the grid; at times tight
            signal = Signal("S", 0, length, signed=signed, is_float=is_float)
            least, most = (int(max(-(2**60), min(2**60, raw))) for raw in signal.raw_type_range)
            first = draw(st.integers(least, most))
            last = draw(st.sampled_from([first, min(first + 1, most), most]))
            off = draw(st.sampled_from([0, 0, 0.3, 0.5]))
            ends = sorted(float((raw + off) * scale + offset) for raw in (first, last))
        lines.append(
            f" SG_ S{i} : {72 * i + start}|{length}@{int(little_endian)}{'-' if signed else '+'} "
            f'({scale!r},{offset!r}) [{ends[0]!r}|{ends[1]!r}] "" B'
        )
        if is_float:
            lines.insert(0, f"SIG_VALTYPE_ 1 S{i} : {1 if length == 32 else 2};")
    types = [line for line in lines if line.startswith("SIG")]
    rest = [line for line in lines if not line.startswith("SIG")]
    return "\n".join(['VERSION ""', "NS_ :", "BS_:", "BU_: A B", "BO_ 1 M: 36 A", *rest, "", *types, ""])


def load_text(text: str) -> tuple[Message, Any]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "random.dbc"
        path.write_text(text)
        return load_dbc(path).messages["M"], cantools.database.load_file(path, strict=True).messages[0]


def in_range(signal: Signal, value: float) -> bool:
    """Whether cantools, too, would send the value: within the limits and the raw range."""
    if signal.minimum is not None and value < signal.minimum:
        return False
    if signal.maximum is not None and value > signal.maximum:
        return False
    q = (value - signal.offset) / signal.scale
    low, high = signal.raw_type_range
    return low <= (q if signal.is_float or math.isinf(q) else round(q)) <= high


def draw_value(data: st.DataObject, signal: Signal) -> float:
    ends = [float(raw * signal.scale + signal.offset) for raw in signal.raw_type_range]
    if signal.minimum is not None and signal.maximum is not None:
        ends = [float(signal.minimum), float(signal.maximum)]
    inside = st.floats(min(ends), max(ends), allow_nan=False, allow_infinity=False) if all(
        map(math.isfinite, ends)
    ) else st.floats(allow_nan=False, allow_infinity=False)  # fmt: skip # one choice
    return data.draw(inside, label=signal.name)


def lines_of(message: Message, rounding: str) -> dict[str, Line]:
    """The signals of the message that a channel can carry (limits between two raw values: none)."""
    found = {}
    for name in message.signals:
        try:
            found[name] = Line(message, name, rounding)
        except ConfigError:
            continue
    return found


@hypothesis.settings(max_examples=150)
@given(databases(), st.data())
def test_a_random_message_is_what_cantools_encodes_and_decodes(text: str, data: st.DataObject) -> None:
    message, codec = load_text(text)
    lines = lines_of(message, "half_even")
    values = {name: draw_value(data, message.signals[name]) for name in lines}
    if not values or not all(in_range(message.signals[name], x) for name, x in values.items()):
        return
    others = {name: 0 for name in message.signals if name not in values}
    scaled = values | {name: message.signals[name].offset for name in others}
    frame = codec.encode(scaled, strict=False)
    decoded_values = codec.decode(frame, decode_choices=False)
    raw_values = codec.decode(frame, decode_choices=False, scaling=False)
    for name, line in lines.items():
        assert same(line(values[name]), float(decoded_values[name])), (name, line.channel.source)
        assert line.raws()[-1] == raw_values[name]


@hypothesis.settings(max_examples=150)
@given(databases(), st.data(), st.sampled_from(ROUNDINGS))
def test_relations(text: str, data: st.DataObject, rounding: str) -> None:
    message, _ = load_text(text)
    for name, line in lines_of(message, rounding).items():
        signal = message.signals[name]
        x = draw_value(data, signal) + data.draw(st.sampled_from([0, 0.5, -0.5, 300, -300])) * signal.scale
        other = draw_value(data, signal)
        y = line(x)
        # monotone
        assert (line(min(x, other)) <= line(max(x, other))) or math.isnan(y)
        # saturate twice is saturate once
        low, high = line.channel.operations[0].low, line.channel.operations[0].high
        clamped = min(max(x, low), high)
        if clamped == x:
            resolution = 4 * math.ulp(max(abs(x), abs(signal.offset), abs(y)))
            step = abs(signal.scale) * (1.0 if rounding == "truncate" else 0.5)
            if signal.is_float:
                step = abs(x - signal.offset) * 2**-23 + abs(signal.scale) * 2**-149
            # decode after encode is within half a step
            assert abs(y - x) <= step * (1 + 1e-9) + resolution, (signal, x, y)
        coarse = math.ulp(max(abs(signal.offset), abs(y))) > 0.01 * abs(signal.scale)
        if rounding != "truncate" and not signal.is_float and not coarse:
            assert same(line(y), y), (signal, x, y)  # through the channel twice is once


@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_saturate_twice_is_saturate_once(rounding: str) -> None:
    for message in load_dbc(EV).messages.values():
        if any(signal.is_multiplexer for signal in message.signals.values()):
            continue
        for name, line in lines_of(message, rounding).items():
            low, high = message.signals[name].minimum, message.signals[name].maximum
            assert low is not None and high is not None
            for x in (low - 1e9, low - 1e-9, low, high, high + 1e-9, high + 1e9):
                assert line(x) == line(min(max(x, low), high))


@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_wrap_keeps_the_low_bits(rounding: str) -> None:
    for length, signed in itertools.product((1, 7, 8, 16, 33, 64), (False, True)):
        signal = Signal("S", 0, length, signed=signed, minimum=0, maximum=1)  # not looked at
        line = Line(Message("f", "M", 1, signals={"S": signal}), "S", rounding, "wrap")
        low, high = signal.raw_type_range
        for x in (0.0, 1.75, -1.75, 2.5, 300.0, -300.0, 1e10, -1e10, 2.0**63, 1e300):
            line(x)
            raw = int(line.raws()[-1])
            unlimited = Signal("S", 0, 2000, signed=True)
            assert low <= raw <= high
            assert (raw - expected_raw(unlimited, rounding, x)) % 2**length == 0


@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_error_is_raised_exactly_where_saturation_would_act(rounding: str) -> None:
    for limits in ({}, {"minimum": 3, "maximum": 99.7}, {"maximum": 4000}):
        signal = Signal("S", 0, 8, scale=0.5, **limits)
        message = Message("f", "M", 1, signals={"S": signal})
        for x in edge_values(signal):
            saturating, strict = Line(message, "S", rounding), Line(message, "S", rounding, "error")
            y = saturating(x)
            if saturating.channel.saturations:
                with pytest.raises(ChannelError, match="outside"):
                    strict(x)
            else:
                assert strict(x) == y


# ---- the project's own database


def test_every_raw_value_of_the_project_s_database_arrives(tmp_path: Path) -> None:
    codecs = cantools.database.load_file(EV, strict=True)
    for message in load_dbc(EV).messages.values():
        if any(signal.is_multiplexer for signal in message.signals.values()):
            continue
        codec = codecs.get_message_by_name(message.name)
        zero = dict.fromkeys(message.signals, 0)
        for name, line in lines_of(message, "half_even").items():
            signal = message.signals[name]
            assert signal.minimum is not None and signal.maximum is not None
            span = signal.maximum - signal.minimum
            for x in (signal.minimum + span * i / 40 for i in range(41)):
                raw = codec.encode(zero, scaling=False, strict=False)
                raw_of_x = next(s for s in codec.signals if s.name == name).conversion.numeric_scaled_to_raw(
                    x
                )
                raw = codec.encode(zero | {name: raw_of_x}, scaling=False, strict=False)
                assert same(line(x), float(codec.decode(raw, decode_choices=False)[name])), (name, x)
            assert line.channel.saturations == {}
