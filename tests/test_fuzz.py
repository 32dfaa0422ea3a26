"""Hostile inputs of every kind end cleanly; `python tests/support/fuzz.py` tries thousands."""

from __future__ import annotations

import os

import pytest

from support import fuzz

COUNT = 60


@pytest.fixture(scope="module", autouse=True)
def warm():
    fuzz.warm()


def test_a_seed_gives_the_same_inputs_again():
    first, again = list(fuzz.inputs(COUNT, 1)), list(fuzz.inputs(COUNT, 1))
    assert first == again != list(fuzz.inputs(COUNT, 2))
    assert {case.kind for case in first} == {"TOML", "DBC", "CSV", "XML", "CLI"}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each input is tried in a child of this process")
def test_hostile_inputs_end_cleanly(tmp_path):
    faults = {}
    codes = set()
    for number, case in enumerate(fuzz.inputs(COUNT, 7)):
        outcome, said = fuzz.tried(case, tmp_path / str(number))
        codes.add(outcome.value)
        if wrong := fuzz.fault(outcome, said):
            faults[number] = (case.arguments, wrong)
    assert not faults
    assert {0, 2} <= codes


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each input is tried in a child of this process")
@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: 1 / 0, "ZeroDivisionError: division by zero"),
        (lambda: os.kill(os.getpid(), 9), "killed by SIGKILL"),
        (lambda: bytearray(8 << 30), "MemoryError"),
        (lambda: next(i for i in iter(int, 1) if i), "more than 0.5 s"),
        (lambda: 3, "exit code 3"),
    ],
)
def test_a_fault_is_seen(call, said):
    assert said in fuzz.fault(fuzz.forked(call, limit=0.5), "")
    assert fuzz.fault(fuzz.forked(lambda: 2), "evcosim: unexpected error: KeyError") != ""
    assert fuzz.fault(fuzz.forked(lambda: 2), "evcosim: s.toml: a key is needed") == ""
