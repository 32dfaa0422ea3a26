"""Machine code of another process, as bytes."""

from __future__ import annotations

import ctypes

import pytest

from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.loaded import Loaded

pytestmark = pytest.mark.skipif(not POSSIBLE, reason="the code is that of x86-64 on Linux")

# lea rax, [rdi + 1]; ret
ONE_MORE = bytes.fromhex("488d4701 c3")


def called(code: Loaded, argument: int) -> int:
    """The answer of int64(int64)."""
    return int(ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(code.address)(argument))


def test_the_answer_of_the_code_is_returned() -> None:
    code = Loaded(ONE_MORE)
    assert [called(code, n) for n in (0, 41, -1, 2**62)] == [1, 42, 0, 2**62 + 1]


def test_two_codes_are_two_functions() -> None:
    one, other = Loaded(ONE_MORE), Loaded(ONE_MORE.replace(b"\x47\x01", b"\x47\x05"))
    assert (called(one, 1), called(other, 1)) == (2, 6)
