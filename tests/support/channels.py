"""Signals, channels of them, and strategies that draw both with their edges."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.units.measure import Affine

THROTTLE = Signal("Throttle", 0, 8, scale=0.4, minimum=0, maximum=100, unit="%", not_available=255)
SPEED = Signal("Speed", 8, 8, minimum=0, maximum=254, unit="km/h", not_available=255)
POWER = Signal("Power", 16, 16, signed=True, minimum=-32000, maximum=32000, unit="W")
FREE = Signal("Free", 32, 8, signed=True)

settings = st.builds(
    BusSettings,
    rounding=st.sampled_from(["nearest", "half_even", "truncate"]),
    overflow=st.sampled_from(["saturate", "wrap", "error"]),
)


def message(*signals: Signal) -> Message:
    return Message("test.dbc", "M", 1, length=64, signals={s.name: s for s in signals})


def memory_of(*values: float, size: int = 40) -> memoryview:
    memory = memoryview(bytearray(8 * size)).cast("d")
    for i, value in enumerate(values):
        memory[i] = value
    return memory


def channel_of(*signals: Signal, use: BusSettings | None = None, log_raw: bool = False) -> MessageChannel:
    """Signal i goes from slot i to slot 20 + i, in the DBC signal's unit."""
    routes = [SignalRoute(s, i, Affine(), ((20 + i, Affine()),)) for i, s in enumerate(signals)]
    return MessageChannel(message(*signals), routes, use, log_raw)


@st.composite
def signals(draw: st.DrawFn) -> Signal:
    is_float = draw(st.integers(0, 5)) == 0
    length = draw(st.sampled_from([32, 64]) if is_float else st.integers(1, 64))
    signed = draw(st.booleans())
    scale = draw(st.sampled_from([1, 2, -1, 3, -7, 0.1, -0.5, 0.4, 0.01, 1 / 3, 1e-3, 1000, 2.0**-20]))
    offset = draw(st.sampled_from([0, -40, 1000, 0.5, -273.15, 7, 1e6]))
    signal = Signal("S", 0, length, signed=signed, is_float=is_float, scale=scale, offset=offset)
    if draw(st.booleans()):
        first, last = (max(-(2.0**40), min(2.0**40, r)) for r in signal.raw_type_range)
        ends = [draw(st.floats(first, last)) * scale + offset for _ in range(2)]
        signal = Signal("S", 0, length, signed=signed, is_float=is_float, scale=scale, offset=offset,
                        minimum=min(ends), maximum=max(ends))  # fmt: skip # one call
    return signal


@st.composite
def cases(draw: st.DrawFn) -> tuple[Signal, BusSettings, list[float]]:
    """A signal, settings, and values that love its edges."""
    signal, use = draw(signals()), draw(settings)
    edges = [float(r * signal.scale + signal.offset) for r in signal.raw_type_range]
    edges += [float(x) for x in (signal.minimum, signal.maximum) if x is not None]
    near = st.builds(
        lambda x, d: x + d * signal.scale,
        st.sampled_from(edges),
        st.sampled_from([0, 0.5, -0.5, 1, -1, 0.49, -0.49, 2, -2]),
    )
    inside = st.floats(min(edges), max(edges)) if all(map(math.isfinite, edges)) else st.floats()
    values = st.one_of(near, inside, st.floats(), st.sampled_from([math.inf, -math.inf, math.nan, -0.0]))
    return signal, use, draw(st.lists(values, min_size=1, max_size=12))
