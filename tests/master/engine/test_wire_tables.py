"""The tables of the frame path, from plans."""

from __future__ import annotations

from typing import get_args

import numpy as np

from evcosim.cosim.can.bus_settings import BusSettings, Rounding
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import Framing
from evcosim.cosim.can.logs.frames import encoder
from evcosim.cosim.can.quantization import operation
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.can.wire.tables import Wire
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.sender import Sender
from evcosim.master.engine.wire_tables import rounding_code, views, wire_arrays
from support.channels import FREE

FED, LEFT = Signal("Fed", 7, 16, little_endian=False, start_raw=9), Signal("Left", 16, 8, start_raw=255)


def sender(delay: int, every: int) -> Sender:
    message = Message("test.dbc", "M", 0x20, length=3, signals={"Fed": FED, "Left": LEFT})
    routes = (SignalRoute(FED, 2, Affine(), ((5, Affine(2.0)), (6, Affine()))),)
    plan = MessagePlan(
        "can0", message, BusSettings(), routes, {}, every, 1, None, delay=delay, framing=Framing()
    )
    return Sender(plan, MessageChannel(message, routes), memoryview(np.zeros(9)), None)


def test_rows_of_a_message_and_its_signals():
    made = wire_arrays([sender(0, 2), sender(5, 2)], np.zeros(9), 0.01, logs=False)
    assert made["messages"][:, T.RING].tolist() == [-1, 0]
    assert made["messages"][1, [T.KEY, T.LENGTH, T.FIRST_SIGNAL, T.SIGNALS]].tolist() == [0x20 << 20, 3, 1, 1]
    assert made["signals"][1, [T.SOURCE, T.START, T.BITS, T.LITTLE, T.FIRST_SINK]].tolist() == [
        2,
        0,
        16,
        0,
        2,
    ]
    assert made["sinks"][:, T.SLOT].tolist() == [5, 6, 5, 6]
    assert made["rings"][0, T.ROWS] == 3
    assert made["state"][T.STEP_TIME] == 10**10
    assert made["base"][0, :4].tolist() == [0, 0, 255, 0]  # a signal that nothing feeds has its start value


STARTS = {
    "Flag": Signal("Flag", 0, 1, start_raw=1),
    "Signed": Signal("Signed", 1, 11, signed=True, start_raw=-700),
    "Motorola": Signal("Motorola", 23, 40, little_endian=False, start_raw=0x12_3456_789A),
    "Negative": Signal("Negative", 56, 64, signed=True, start_raw=-(2**63) + 5),
    "Large": Signal("Large", 127, 64, little_endian=False, start_raw=2**64 - 2),
    "Single": Signal("Single", 184, 32, is_float=True, start_raw=-0.1),
    "Double": Signal("Double", 223, 64, little_endian=False, is_float=True, start_raw=1e-320),
}


def test_start_values_are_the_bits_that_cantools_writes():
    message = Message("test.dbc", "M", 0x20, length=48, fd=True, signals=STARTS)
    plan = MessagePlan("can0", message, BusSettings(), (), {}, 1, 1, None, framing=Framing())
    one = Sender(plan, MessageChannel(message, ()), memoryview(np.zeros(9)), None)
    made = wire_arrays([one], np.zeros(9), 0.01, logs=False)
    expected = encoder(message)({name: signal.start_raw for name, signal in STARTS.items()})
    assert bytes(made["base"][0, :48].tolist()) == expected
    assert sum(map(bool, expected)) > 20


def test_every_table_has_a_place_and_is_shared_with_its_view():
    made = wire_arrays([], np.zeros(9), 0.01, logs=False)
    assert {*made, "helper"} == set(Wire._fields)
    wire = views(made, None)
    wire.double[0] = 1.0
    assert made["double_bits"][0] == 0x3FF0000000000000
    made["messages"][0, T.SENT] = 7
    assert wire.messages[0, T.SENT] == 7


def test_ways_of_rounding_and_floats_differ() -> None:
    whole = {rounding_code(operation(FREE, BusSettings(rounding=r))) for r in get_args(Rounding)}
    floats = {
        rounding_code(operation(Signal("F", 0, n, is_float=True), BusSettings(rounding=r)))
        for n in (32, 64)
        for r in get_args(Rounding)
    }
    assert (len(whole), len(floats)) == (len(get_args(Rounding)), 2)
    assert not whole & floats
