"""States of native FMUs: taken back, carried to other instances as bytes, and refused where they are none."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Load = Callable[[Path], Any]


@pytest.fixture
def unit(pairs: Callable[[str], Any], load: Load) -> Any:
    """A native FMU, a few steps after its start."""
    made = load(pairs("Handmade").native)
    made.initialize({"gain": 2.5, "limit": 9}, start=1.5)
    _run(made, 4)
    return made


def _run(unit: Any, steps: int) -> list[dict[str, Any]]:
    """Take steps with inputs that are a function of the number of the step alone; return the outputs."""
    trace = []
    for k in range(steps):
        unit.set({"speed": 3.0 * k, "steps": k - 2, "on": k % 2 == 0, "lever": (-1, 1, 2)[k % 3]})
        unit.fmu.doStep(1.5 + 0.1 * k, 0.1)
        trace.append(unit.get())
    return trace


def _bytes(unit: Any) -> bytes:
    state = unit.fmu.getFMUState()
    try:
        return bytes(unit.fmu.serializeFMUState(state))
    finally:
        unit.fmu.freeFMUState(state)


def test_a_state_is_taken_back(unit: Any, bits: Any) -> None:
    state = unit.fmu.getFMUState()
    before, bytes_before = unit.get(), _bytes(unit)
    first = _run(unit, 7)
    unit.fmu.setFMUState(state)
    assert _bytes(unit) == bytes_before
    assert unit.get() == before
    assert bits(_run(unit, 7)) == bits(first)
    unit.fmu.terminate()
    unit.fmu.setFMUState(state)  # from there on it goes on
    assert bits(_run(unit, 7)) == bits(first)
    unit.fmu.freeFMUState(state)
    assert state.value is None


def test_a_state_is_saved_over_an_older_one(unit: Any, bits: Any) -> None:
    state = unit.fmu.getFMUState()
    place = state.value
    _run(unit, 3)
    unit.fmu.fmi2GetFMUstate(unit.fmu.component, ctypes.byref(state))
    assert state.value == place
    first = _run(unit, 3)
    unit.fmu.setFMUState(state)
    assert bits(_run(unit, 3)) == bits(first)
    unit.fmu.freeFMUState(state)


@pytest.mark.parametrize("name", ["Handmade", "HandmadeSampled", "HandmadePlain"])
def test_bytes_carry_a_state_to_another_instance(
    name: str, pairs: Callable[[str], Any], load: Load, bits: Any
) -> None:
    one, other = load(pairs(name).native), load(pairs(name).native)
    one.initialize({"gain": 2.5, "limit": 9, "mode": 1}, start=1.5)
    _run(one, 5)
    content = _bytes(one)
    state = other.fmu.deSerializeFMUstate(content)
    other.fmu.setFMUState(state)  # which was never initialized
    other.fmu.freeFMUState(state)
    assert _bytes(other) == content
    assert other.get() == one.get()
    assert bits(_run(other, 5)) == bits(_run(one, 5))
    assert _bytes(other) == _bytes(one)


def test_bytes_are_read_into_an_older_state(unit: Any) -> None:
    state, content = unit.fmu.getFMUState(), _bytes(unit)
    place = state.value
    _run(unit, 3)
    later = _bytes(unit)
    assert unit.fmu.deSerializeFMUstate(later, state).value == place
    with pytest.raises(Exception, match="status 3"):
        unit.fmu.deSerializeFMUstate(content[:-1], state)  # and it stays as it is
    unit.fmu.setFMUState(state)
    assert _bytes(unit) == later
    unit.fmu.freeFMUState(state)


def test_equal_states_have_equal_bytes_whatever_was_before(pairs: Callable[[str], Any], load: Load) -> None:
    one, other = load(pairs("HandmadePlain").native), load(pairs("HandmadePlain").native)
    one.initialize({"active": False})
    _run(one, 6)
    one.fmu.reset()
    for each in (one, other):
        each.initialize({"active": False})
        each.fmu.doStep(0.0, 0.1)  # the queue of `one` was full
    assert _bytes(one) == _bytes(other)


def test_the_form_has_no_gaps(unit: Any) -> None:
    content = _bytes(unit)
    stamp = content.index(b"\n") + 1
    assert content[: stamp - 1].decode().startswith("Handmade_")
    phase, stale, time, reached, gain = struct.unpack_from("<bbddd", content, stamp)
    assert (phase, stale, gain) == (2, 0, 2.5)
    assert time == reached == 1.5 + 0.1 * 3 + 0.1
    # 6 parameters of 8 bytes and one of 1, 4 and 1 inputs, 5 and 1 outputs, 6 numbers, a truth value
    assert len(content) == stamp + 18 + (49 + 33 + 41) + (6 * 8 + 1)


def test_a_state_before_the_start(pairs: Callable[[str], Any], load: Load) -> None:
    one, other = load(pairs("Handmade").native), load(pairs("Handmade").native)
    for prepare in (lambda: None, lambda: one.set({"speed": 7.0}), one.fmu.enterInitializationMode):
        prepare()
        state = other.fmu.deSerializeFMUstate(_bytes(one))
        other.fmu.setFMUState(state)
        other.fmu.freeFMUState(state)
    other.fmu.exitInitializationMode()
    assert other.get("total") == {"total": 7.75}


def _refused(unit: Any, content: bytes) -> str:
    before = len(unit.log)
    with pytest.raises(Exception, match="status 3"):
        unit.fmu.deSerializeFMUstate(content)
    ((status, category, message),) = unit.log[before:]
    assert (status, category) == (3, "logStatusError")
    return message


def test_bytes_that_are_no_state(unit: Any, pairs: Callable[[str], Any], load: Load) -> None:
    content = _bytes(unit)
    stamp = content.index(b"\n") + 1
    identity = content[: stamp - 1].decode()
    of_another = f"fmi2DeSerializeFMUstate: these bytes are a state of {{}}, this FMU is '{identity}'"
    sampled = load(pairs("HandmadeSampled").native)
    theirs = _bytes(sampled)
    shown = theirs[:stamp].partition(b"\n")[0].decode()
    assert _refused(unit, theirs) == of_another.format(f"'{shown}'")
    assert _refused(unit, b"Handmade_0\nrubbish") == of_another.format("'Handmade_0'")
    assert _refused(unit, b"it's %s \x07\xff\t\\") == of_another.format('"it\'s %s \\x07\ufffd\\t\\\\"')
    assert _refused(unit, content[: stamp - 1]) == of_another.format(f"'{identity}'")
    for wrong in (content[:-1], content + b"\0", content[:stamp]):
        assert _refused(unit, wrong) == (
            f"fmi2DeSerializeFMUstate: these bytes are no whole state: they are {len(wrong)}, a state has "
            f"{len(content)}"
        )


def test_damaged_bytes_do_not_become_a_state(unit: Any) -> None:
    content = bytearray(_bytes(unit))
    stamp = content.index(b"\n") + 1
    seen, last = len(content) - 3 * 8 - 1, len(content) - 3 * 8 - 1 - 2 * 8
    active, mode = stamp + 18 + 3 * 8, stamp + 18 + 3 * 8 + 1
    for at, value in ((stamp, 3), (stamp + 1, 2), (active, 2), (mode, 7), (seen, 2), (last, 7)):
        damaged = bytearray(content)
        damaged[at] = value
        assert "damaged state" in _refused(unit, bytes(damaged)), at


def test_a_pointer_to_nothing_is_refused(unit: Any) -> None:
    with pytest.raises(Exception, match="status 3"):
        unit.fmu.setFMUState(None)
    assert unit.log[-1][2] == "fmi2SetFMUstate: this is no state of this FMU"


def test_too_little_room_for_the_bytes(unit: Any) -> None:
    state = unit.fmu.getFMUState()
    room = ctypes.create_string_buffer(10)
    with pytest.raises(Exception, match="status 3"):
        unit.fmu.fmi2SerializeFMUstate(unit.fmu.component, state, room, 10)
    unit.fmu.freeFMUState(state)
    assert unit.log[-1][2].endswith(" bytes, there is room for 10")
