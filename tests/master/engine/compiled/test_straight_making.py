"""What LLVM makes of a text is plain bytes, or nothing."""

from __future__ import annotations

import ctypes

import pytest

from evcosim.master.engine.compiled.llvm_text import WORD, Function
from evcosim.master.engine.compiled.straight_making import IS_OPAQUE, linked_code
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.loaded import Loaded

pytestmark = pytest.mark.skipif(not POSSIBLE, reason="no code is flat on another system")


def test_bytes_are_the_function() -> None:
    f = Function("f", ["a"], IS_OPAQUE)
    f.give(f.let(f"mul {WORD} %a, 3"))
    loaded = Loaded(linked_code(f.text(), "f") or b"")
    assert ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(loaded.address)(14) == 42


def test_a_function_that_needs_another_gives_none() -> None:
    f = Function("f", ["a"], IS_OPAQUE)
    f.give(f.known(WORD, "somewhere_else", [(WORD, "%a")]))
    assert linked_code(f.text(), "f") is None
