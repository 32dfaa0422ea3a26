"""Moves, checks and roundings in machine code against those of Python and of the kernel."""

from __future__ import annotations

import ctypes
import math
import random
from collections.abc import Callable

import numpy as np
import pytest

from evcosim.cosim.can.wire import tables as T
from evcosim.master.engine.compiled import kernel
from evcosim.master.engine.compiled.llvm_text import WORD, Function
from evcosim.master.engine.compiled.straight_making import IS_OPAQUE, linked_code
from evcosim.master.engine.compiled.straight_values import Memory
from evcosim.master.engine.compiled.structure import Move
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.loaded import Loaded

pytestmark = pytest.mark.skipif(not POSSIBLE, reason="no code is flat on another system")
ODD = [0.5, 1.5, -2.5, 0.49999999999999994, -0.49999999999999994, 1e15 + 0.5, -0.0, 0.0, 3.7, -3.7]
RANDOM = [random.Random(2).uniform(-1e6, 1e6) for _ in range(50)]


def made(write: Callable[[Function, Memory], str | int]) -> Callable[[np.ndarray], int]:
    """A function of an array that is the memory; `write` gives the word that it returns."""
    f = Function("f", ["memory"], IS_OPAQUE)
    f.give(write(f, Memory(f, "%memory")))
    code = linked_code(f.text(), "f")
    assert code is not None
    loaded = Loaded(code)
    function = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(loaded.address)

    def call(memory: np.ndarray) -> int:
        assert loaded.address
        return function(memory.ctypes.data)

    return call


@pytest.mark.parametrize("mode", [T.NEAREST, T.HALF_EVEN, T.TRUNCATE, T.FLOAT32, T.FLOAT64])
def test_rounding_is_that_of_the_kernel(mode: int) -> None:
    def write(f: Function, memory: Memory) -> int:
        memory.put(1, memory.rounded(memory.get(0), mode))
        return 0

    function = made(write)
    for value in ODD + RANDOM:
        memory = np.array([value, math.nan])
        function(memory)
        assert memory[1].tobytes() == np.float64(kernel.rounded(value, mode)).tobytes(), value


@pytest.mark.parametrize("count", range(1, 20))
def test_one_number_that_is_not_finite_is_found(count: int) -> None:
    function = made(lambda f, memory: f.let(f"zext i1 {memory.are_finite(1, count)} to {WORD}"))
    memory = np.full(count + 2, math.nan)
    memory[1:-1] = -1.7976931348623157e308
    assert function(memory) == 1
    for place in range(1, count + 1):
        for value in (math.nan, math.inf, -math.inf):
            changed = memory.copy()
            changed[place] = value
            assert function(changed) == 0


def test_slots_in_any_order_are_copied() -> None:
    slots = [*range(5, 21), 3, 2, 1, *range(30, 35), 5, 5, 6]

    def write(f: Function, memory: Memory) -> int:
        memory.copy(slots, "%memory", 40)
        return 0

    memory = np.arange(80.0)
    expected = memory.copy()
    expected[40 : 40 + len(slots)] = expected[slots]
    made(write)(memory)
    assert memory.tolist() == expected.tolist()


def test_a_map_multiplies_and_then_adds() -> None:
    """In two roundings, with the numbers in the second row of a table of four columns."""

    def write(f: Function, memory: Memory) -> int:
        table = f.let(f"add {WORD} %memory, 80")
        for plain, sink in ((False, 1), (True, 2)):
            memory.put(sink, memory.mapped(memory.get(0), Move(1, 0, sink, plain), table, 4))
        return 0

    function = made(write)
    for x in RANDOM:
        memory = np.zeros(20)
        memory[0], memory[10 + 4 + 2], memory[10 + 4 + 3] = x, 0.1, -0.3
        function(memory)
        assert memory[1:3].tolist() == [0.1 * x + -0.3, x]
