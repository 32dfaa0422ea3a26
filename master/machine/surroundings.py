"""The C functions that machine code calls: the clock, and what a handover needs."""

from __future__ import annotations

import ctypes
import sys
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import tables as L
from .hands import POSSIBLE

_FUTEX = 202  # asm/unistd_64.h
_NAP = 2e-3  # s

BELL = bytes(4)
"""A frame of no bytes (see `isolation.framing`)."""


class Surroundings:
    """The places of STATE and NUMBERS that say where these functions are, and the tables of their arguments.

    It must live as long as they are used. `locked`: the machine code holds Python's lock but while it sleeps.
    """

    def __init__(self, state: NDArray[np.int64], numbers: NDArray[np.float64], locked: bool = False) -> None:
        self._ticks = np.zeros(2, dtype=np.int64)
        self._nap = np.array([0, round(1e9 * _NAP)], dtype=np.int64)  # struct timespec
        self._bell = np.frombuffer(BELL, dtype=np.uint8)
        self._set_clock(state, numbers)
        if POSSIBLE:
            self._set_handover(state, numbers)
        if locked:
            python = ctypes.pythonapi
            state[[L.UNLOCK, L.LOCK]] = (
                address(python.PyEval_SaveThread),
                address(python.PyEval_RestoreThread),
            )

    @property
    def tables(self) -> dict[int, NDArray[Any]]:
        """The arrays by their place in the table of tables."""
        return {L.TICKS: self._ticks, L.NAP_TIME: self._nap, L.BELL: self._bell}

    def _set_clock(self, state: NDArray[np.int64], numbers: NDArray[np.float64]) -> None:
        """Set the address of the system's clock, its arguments, and the seconds of its ticks."""
        ticks = self._ticks.ctypes.data
        if sys.platform == "win32":
            frequency = ctypes.c_int64()
            ctypes.windll.kernel32.QueryPerformanceFrequency(ctypes.byref(frequency))
            function, arguments = ctypes.windll.kernel32.QueryPerformanceCounter, (ticks, 0)
            seconds = (1.0 / frequency.value, 0.0)
        else:
            function, arguments = ctypes.CDLL(None).clock_gettime, (time.CLOCK_MONOTONIC, ticks)
            seconds = (1.0, 1e-9)
        self._clock = function  # whose address is in the table
        state[L.CLOCK] = address(function)
        state[[L.CLOCK_A, L.CLOCK_B]] = arguments
        numbers[[L.TICK_0, L.TICK_1]] = seconds

    def _set_handover(self, state: NDArray[np.int64], numbers: NDArray[np.float64]) -> None:
        library = ctypes.CDLL(None)
        self._functions = [library.sched_yield, library.syscall, library.send]
        state[[L.YIELD, L.SYSCALL, L.SEND_BELL]] = [address(function) for function in self._functions]
        state[L.FUTEX] = _FUTEX
        numbers[L.NAP] = _NAP


def address(function: Any) -> int:
    """Return the address of a C function."""
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def wake(place: int) -> None:
    """Wake a side that sleeps on the word at this address."""
    ctypes.CDLL(None).syscall(_FUTEX, ctypes.c_void_p(place), 1, 1, None, None, 0)
