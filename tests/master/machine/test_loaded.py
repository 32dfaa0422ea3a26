"""Machine code of another process, as bytes."""

from __future__ import annotations

import pytest

from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.loaded import Loaded

pytestmark = pytest.mark.skipif(not POSSIBLE, reason="the code is that of x86-64 on Linux")

# mov [rdi], rdx; add qword [rdi], 1; xor eax, eax; ret
ONE_MORE = bytes.fromhex("488917 48830701 31c0 c3")


def test_the_answer_of_the_code_is_returned() -> None:
    function = Loaded(ONE_MORE)
    assert [function(n) for n in (0, 41, -1, 2**62)] == [1, 42, 0, 2**62 + 1]


def test_two_codes_are_two_functions() -> None:
    one, other = Loaded(ONE_MORE), Loaded(ONE_MORE.replace(b"\x01\x31", b"\x05\x31"))
    assert (one(1), other(1)) == (2, 6)
