"""Actions of the frame path that are written out leave all tables as those of Python do, bit for bit."""

from __future__ import annotations

import ctypes
import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.can.as_sent import as_sent
from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.framing import Framing, framing_of
from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.errors import RunError
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.cosim.units.measure import Affine
from evcosim.master.engine.compiled.addresses import wire_table
from evcosim.master.engine.compiled.known_frames import frames_of
from evcosim.master.engine.compiled.llvm_text import WORD, Function
from evcosim.master.engine.compiled.straight_frames import FramePath as WrittenOut
from evcosim.master.engine.compiled.straight_frames import is_written_out
from evcosim.master.engine.compiled.straight_making import IS_OPAQUE, linked_code
from evcosim.master.engine.compiled.straight_numbers import Arithmetic
from evcosim.master.engine.frame_path import FramePath
from evcosim.master.engine.sender import Sender
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.loaded import Loaded
from support.channels import cases
from support.framed import layouts

pytestmark = pytest.mark.skipif(not POSSIBLE, reason="no code is flat on another system")
Act = Callable[[int], str]
_HELPER = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)


def in_python(path: FramePath, what: int, i: int = 0) -> Act:
    """An action of a step k by the functions as they stand; it gives the text of an error."""

    def act(k: int) -> str:
        try:
            path.act(what, i, k)
        except RunError as error:
            return str(error)
        return ""

    return act


def in_code(path: FramePath, what: int, i: int = 0) -> Act:
    """The same by code that is written out."""
    frames = frames_of(path.arrays)
    assert frames is not None and is_written_out(frames, what, i)
    f = Function("f", ["wire", "k"], IS_OPAQUE)
    numbers = Arithmetic(f)
    found = WrittenOut(numbers, frames, "%wire").act(what, i, "%k")
    f.give(numbers.text(found, WORD))
    code = linked_code(f.text(), "f")
    assert code is not None
    loaded, raised = Loaded(code), []

    def help_(*asked: int) -> int:
        try:
            return path.help(*asked)
        except RunError as error:
            raised.append(str(error))
            return T.RAISED

    helper = _HELPER(help_)
    addresses = wire_table(path.arrays, ctypes.cast(helper, ctypes.c_void_p).value or 0)
    function = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)(loaded.address)

    def act(k: int) -> str:
        assert loaded.address and helper
        result = function(addresses.ctypes.data, k)
        assert result == (T.RAISED if raised else T.DONE)
        return raised.pop() if raised else ""

    return act


def compare(
    make: Callable[[], FramePath], values: list[list[float]], spoil: Callable[..., None] | None = None
) -> None:
    """Send a row of values in each step, and look for the frame, both ways."""
    paths = make(), make()
    acts = [
        [way(path, what) for what in (T.SEND, T.WATCH)]
        for way, path in zip((in_python, in_code), paths, strict=True)
    ]
    for k, row in enumerate(values):
        said = []
        for path, (send, watch) in zip(paths, acts, strict=True):
            path.wire.memory[: len(row)] = memoryview(np.array(row))
            if spoil is not None:
                spoil(path, k)
            said.append([watch(k) if k % 3 == 2 else send(k)])
        assert said[0] == said[1]
        for name, array in paths[0].arrays.items():
            assert array.tobytes() == paths[1].arrays[name].tobytes(), f"{name} in step {k}"


def path_of(plan: MessagePlan, size: int) -> FramePath:
    """The path of one message, which a run would have, with a memory of so many slots."""
    memory = np.zeros(size)
    channel = MessageChannel(plan.message, plan.routes, plan.settings)
    return FramePath([Sender(plan, channel, memoryview(memory), None)], memory, 0.01, False, {size - 1: -7.0})


@settings(deadline=None, max_examples=40)
@given(cases())
def test_a_signal_of_any_kind(case: tuple[Signal, BusSettings, list[float]]) -> None:
    signal, use, values = case
    if signal.length > 59:
        signal = dataclasses.replace(signal, start=0)
    else:
        signal = dataclasses.replace(signal, start=5)
    message = Message("test.dbc", "M", 1, length=8, signals={"S": signal})
    routes = (SignalRoute(signal, 0, Affine(2.0, 0.25), ((1, Affine()), (2, Affine(0.5, -3.0)))),)
    plan = MessagePlan("can0", message, use, routes, {"S": "a.y"}, 1, 0, None, framing=Framing())
    compare(lambda: path_of(plan, 3), [[value] for value in values])


@settings(deadline=None, max_examples=40)
@given(layouts(8), st.data())
def test_signals_at_any_place_of_a_frame(message: Message, data: st.DataObject) -> None:
    signals = list(message.signals.values())
    routes = tuple(SignalRoute(s, i, Affine(), ((20 + i, Affine()),)) for i, s in enumerate(signals))
    plan = MessagePlan(
        "can0",
        message,
        BusSettings(),
        routes,
        {s.name: "a.y" for s in signals},
        1,
        0,
        None,
        framing=Framing(),
    )
    number = st.floats(-(2.0**40), 2.0**40) | st.integers(-3, 300).map(float)
    rows = data.draw(
        st.lists(st.lists(number, min_size=len(signals), max_size=len(signals)), min_size=1, max_size=9)
    )
    compare(lambda: path_of(plan, 40), rows)


VALUE = Signal("Value", 24, 16, not_available=0xFFFF, scale=0.5)
PROFILES = {
    "": {},
    "1A": {"data_id": 0x1234},
    "1B": {"data_id": 0x1234},
    "1C": {"data_id": 0x1234, "nibble": "Nibble"},
    "2": {"data_id": list(range(7, 23))},
    "5": {"data_id": 0x1234},
}


@pytest.mark.parametrize("timeout", [0, 2])
@pytest.mark.parametrize("profile", PROFILES)
def test_protection_with_counters_that_jump_and_keys_that_are_wrong(profile: str, timeout: int) -> None:
    def make() -> FramePath:
        wide = profile == "5"
        signals = [
            Signal("Crc", 0, 16 if wide else 8),
            Signal("Counter", 16 if wide else 8, 8 if wide else 4),
        ]
        signals += [*([] if wide else [Signal("Nibble", 12, 4)]), VALUE]
        own: dict[str, object] = {"timeout": timeout} if timeout else {}
        if profile:
            own["e2e"] = {"profile": profile, "crc": "Crc", "counter": "Counter", **PROFILES[profile]}
        use = BusSettings(messages={"M": MessageSettings.model_validate(own)})
        message = as_sent(Message("test.dbc", "M", 1, length=8, signals={s.name: s for s in signals}), use)
        framing = dataclasses.replace(framing_of(message, use) or Framing(), status=(2,))
        routes = (SignalRoute(VALUE, 0, Affine(), ((1, Affine(2.0)),)),)
        return path_of(MessagePlan("can0", message, use, routes, {}, 1, 0, None, framing=framing), 3)

    def spoil(path: FramePath, k: int) -> None:
        """Let the receiver have seen another counter; frames are sent with another key now and then."""
        if k % 7 == 5:
            path.wire.listeners[0, T.LAST] = k % 15
        if k % 11 == 9:
            path.wire.messages[0, T.COUNTER] = (k * 5) % 15

    compare(make, [[0.7 * k] for k in range(60)], spoil)


def test_what_stays_with_its_own_function() -> None:
    plan = MessagePlan(
        "can0",
        Message("test.dbc", "M", 1, length=64, signals={}, fd=True),
        BusSettings(),
        (),
        {},
        1,
        0,
        None,
        framing=Framing(),
    )
    path = path_of(plan, 3)
    frames = frames_of(path.arrays)
    assert frames is not None
    assert not is_written_out(frames, T.SEND, 0)
    assert not is_written_out(frames, T.ARRIVE, 0)
    assert is_written_out(frames, T.WATCH, 0)
    path.arrays["state"][T.FAULTS] = 1
    assert frames_of(path.arrays) is None
