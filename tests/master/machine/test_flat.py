"""Machine code as plain bytes does what numba's function does, and what needs more than bytes is refused."""

# mypy: disable-error-code="untyped-decorator"

from __future__ import annotations

import ctypes
import math

import pytest

from evcosim.master.machine.calling import inlined
from evcosim.master.machine.flat import NotFlatError, flat, linked
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.machine.loaded import Loaded

pytestmark = pytest.mark.skipif(not POSSIBLE, reason="an object file of another system has another format")


@inlined
def _chosen(number: int) -> float:
    """Choose among cases and constants, of which LLVM makes tables behind the code."""
    if number == 0:
        return 0.1
    if number == 1:
        return -7.25
    if number == 2:
        return 1e300
    if number == 3:
        return 3.5
    return 2.0 * number


def scaled(number: int) -> int:
    total = 0.0
    for i in range(number):
        total += _chosen(i % 6) if i % 6 != 2 else 1.5
    return int(1000.0 * total)


def test_code_with_constants_computes_what_python_computes() -> None:
    loaded = Loaded(flat(scaled))
    function = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(loaded.address)
    for number in (0, 1, 2, 5, 6, 100):
        total = sum((0.1, -7.25, 1.5, 3.5, 8.0, 10.0)[i % 6] for i in range(number))
        assert function(number) == int(1000.0 * total)


def compared(a: int, b: int, c: int, d: int) -> int:
    return -1 if a < b else 10 * c + d


def test_arguments_and_the_answer_are_those_of_the_signature() -> None:
    loaded = Loaded(flat(compared, "int32(int64, int64, int64, int64)"))
    function = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_int64] * 4)(loaded.address)
    assert [function(1, 2, 3, 4), function(2**40, 1, 3, 4)] == [-1, 34]


def wave(number: int) -> int:
    return int(1000.0 * math.sin(number))


def test_a_function_that_needs_a_library_is_refused() -> None:
    with pytest.raises(NotFlatError, match="sin"):
        flat(wave)


def test_a_function_that_is_not_where_the_code_begins_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = []
    monkeypatch.setattr("evcosim.master.machine.flat.linked", lambda content, entry: kept.append(content))
    flat(scaled)
    with pytest.raises(NotFlatError, match="other is not where the code begins"):
        linked(kept[0], "other")
