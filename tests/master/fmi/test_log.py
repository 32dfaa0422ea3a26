"""The messages of units: each reaches its own unit's log, the last are kept, and warnings are counted."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator

import pytest

from evcosim.master.fmi import log as module
from evcosim.master.fmi.log import STATUS, UnitLog, receive_3


@pytest.fixture
def log() -> Iterator[UnitLog]:
    made = UnitLog()
    yield made
    made.close()


def test_the_last_message_tells_of_a_failure(log: UnitLog) -> None:
    assert not log.ends_in_error()
    for status, fails in ((3, True), (1, False), (4, True), (0, False)):
        log.add(status, "text")
        assert log.ends_in_error() is fails


def test_messages_are_shown_with_the_word_of_their_status(log: UnitLog) -> None:
    for status, word in enumerate(STATUS):
        log.add(status, f"text {status}")
        assert log.messages[-1] == f"[{word}] text {status}"
    log.add(9, "of no status")
    assert log.messages[-1] == "[9] of no status"
    assert log.warnings == 1


def test_the_last_messages_are_those_of_trouble_where_there_are_any(log: UnitLog) -> None:
    assert log.last() == ""
    for i in range(5):
        log.add(0, f"ok {i}")
    assert log.last() == "[OK] ok 2\n[OK] ok 3\n[OK] ok 4"
    log.add(3, "the reason")
    for i in range(10):
        log.add(0, f"after {i}")
    assert log.last() == "[Error] the reason"
    for i in range(20):
        log.add(0, f"long after {i}")
    assert log.last(1) == "[OK] long after 19"


def test_only_so_much_is_kept(log: UnitLog) -> None:
    for i in range(500):
        log.add(1, f"at {i} s " + "x" * 10_000)
    assert len(log.messages) == 100
    assert all(len(message) < 2100 for message in log.messages)
    assert log.warnings == 500
    assert list(log.kinds.counts.values()) == [10, 90, 400]  # cut off, they have another length
    assert all(len(text) < 2100 for text in log.kinds.counts)


def test_the_texts_of_warnings_that_differ_are_counted(log: UnitLog) -> None:
    for status, text in ((1, "first"), (0, "no warning"), (1, "first"), (1, "second"), (3, "error")):
        log.add(status, text)
    assert (log.warnings, log.kinds.counts) == (3, {"first": 2, "second": 1})


def test_a_message_reaches_the_unit_of_its_environment() -> None:
    logs = [UnitLog(), UnitLog()]
    for status, log in enumerate(logs):
        receive_3(ctypes.c_void_p(log.id), status, b"category", f"to {status}".encode())
    assert [list(log.messages) for log in logs] == [["[OK] to 0"], ["[Warning] to 1"]]
    for log in logs:
        log.close()
    receive_3(ctypes.c_void_p(logs[0].id), 0, b"", b"nobody listens")
    assert len(logs[0].messages) == 1


def test_in_an_instantiation_a_message_without_environment_is_that_of_the_unit(log: UnitLog) -> None:
    """FMI 1.0 names the component, which is known only then."""
    other = UnitLog()
    with other.instantiating():
        module._message(None, b"", 0, None, b"early")
    other.belongs_to(4711)
    module._message(4711, b"", 0, None, b"late")
    assert list(other.messages) == ["[OK] early", "[OK] late"]
    module._message(None, b"", 0, None, b"to nobody")
    other.close()
    module._message(4711, b"", 0, None, b"after the end")
    assert list(log.messages) == []
    assert len(other.messages) == 2


def test_text_that_is_no_utf_8_and_the_words_of_pythonfmu(log: UnitLog) -> None:
    module._message(log.id, b"", 3, None, b"bad \xff byte")
    module._message(log.id, b"", 3, None, None)
    module._message(log.id, b"", 4, None, b"Fatal py exception encountered: \nValueError: no")
    assert list(log.messages) == ["[Error] bad \ufffd byte", "[Error] ", "[Fatal] ValueError: no"]


def test_a_listener_hears_each_message_at_once(log: UnitLog, monkeypatch: pytest.MonkeyPatch) -> None:
    heard: list[tuple[int, str]] = []
    monkeypatch.setattr(UnitLog, "listener", lambda status, text: heard.append((status, text)))
    log.add(1, "first")
    log.add(0, "second")
    assert heard == [(1, "first"), (0, "second")]


def test_the_callbacks_of_a_version_receive_for_the_log(log: UnitLog) -> None:
    callbacks = log.callbacks()
    assert callbacks.componentEnvironment == log.id
    assert callbacks.logger and callbacks.allocateMemory and callbacks.freeMemory
    first = log.callbacks_1()
    assert first.logger and not first.stepFinished
