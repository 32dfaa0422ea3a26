"""The handover of a turn between two processes: both look at a number in the shared memory, then sleep.

A request has a number, and the answer to it has the same. The side that waits looks at the other's number
for a short time and gives its core away between two looks, so that more processes than cores do not stop each
other. Then it sets the flag that it sleeps and reads from the socket; a side that writes a number rings the
bell of one that sleeps.

Where looking is in vain, since others want the cores too and a side that gives its core away gets it back
late, a side sleeps at once the next time, and 3, 7 ... times if it is in vain again: one that sleeps is woken
before those that compute.

Memory order: x86 makes the stores of one core visible in their order and does loads in theirs, so that
whoever sees a number sees what was written before it. A store may pass a later load, though: each side,
between writing (its number, or that it sleeps) and looking at what the other one wrote, takes a lock of
Python's, whose atomic exchange nothing passes on x86. Other machines promise less: there both sides only
sleep, and each number is followed by a bell, which the system hands over in order.
"""

from __future__ import annotations

import os
import socket
import threading
import time
from collections.abc import Callable

import numpy as np

from ..machine import slots as S
from ..machine.surroundings import wake
from . import framing

_ORDERED = os.name == "posix" and os.uname().machine in ("x86_64", "amd64", "AMD64", "i386", "i686")
_LOOKS = 20  # between two readings of the clock
_MOST_PAUSES = 127  # times that a side sleeps at once after it looked in vain
_give_way: Callable[[], None] = getattr(os, "sched_yield", lambda: time.sleep(0.0))  # macOS has none

SPIN = 300e-6
"""The time [s] that a side looks before it sleeps: a few times what sleeping and waking costs."""


def spin_time() -> float:
    """Return the time [s] that a side looks here; 0: it sleeps at once, and a bell follows each number."""
    return SPIN if _ORDERED else 0.0


class Side:
    """One of the two sides of the handover.

    `mine` are the slots of the number that this side writes and of the flag that it sleeps, `theirs` those of
    the other side. `spin` [s] is the same on both sides.
    """

    def __init__(
        self,
        connection: socket.socket,
        slots: memoryview[float],
        mine: tuple[int, int],
        theirs: tuple[int, int],
        spin: float,
    ) -> None:
        self._connection, self._slots, self._spin = connection, slots, spin
        self._mine, self._i_sleep = mine
        self._theirs, self._they_sleep = theirs
        self._lock = threading.Lock()
        self._pause = self._pauses = 0  # how often more, and how often after the last look, to sleep at once

    def post(self, number: float) -> None:
        """Write a number, when all that belongs to it stands in the memory. Raises OSError."""
        slots = self._slots
        slots[self._mine] = number
        self._exchange()
        if slots[self._they_sleep] == S.ON_WORD:
            wake(np.asarray(slots).ctypes.data + 8 * self._they_sleep + S.WORD)
        elif not self._spin or slots[self._they_sleep]:
            self._connection.sendall(framing.BELL)

    def _exchange(self) -> None:
        self._lock.acquire()
        self._lock.release()

    def comes(self, number: float) -> bool:
        """Look for a number, and return True if it came in the time."""
        slots, place, give_way = self._slots, self._theirs, _give_way
        if not self._spin:
            return False
        if slots[place] == number:
            return True
        if self._pause:  # looking was in vain lately
            self._pause -= 1
            return False
        clock = time.perf_counter
        end = clock() + self._spin
        while clock() < end:
            for _ in range(_LOOKS):
                give_way()
                if slots[place] == number:
                    self._judge(clock() < end)
                    return True
        self._judge(False)
        return False

    def _judge(self, in_time: bool) -> None:
        """Choose how often to sleep at once: 0 times after a look that was in time, else 1, 3, 7 ...."""
        self._pauses = 0 if in_time else min(2 * self._pauses + 1, _MOST_PAUSES)
        self._pause = self._pauses

    def sleep_until(
        self, number: float, most: int, impatience: framing.Impatience = framing.nothing
    ) -> bytes:
        """Sleep until a number is there, or return a frame that comes first. Raises as `framing.receive`."""
        slots, place = self._slots, self._theirs
        slots[self._i_sleep] = S.ON_SOCKET
        self._exchange()
        try:
            while not (self._spin and slots[place] == number):
                frame = framing.receive(self._connection, most, impatience)
                if frame or slots[place] == number:
                    return frame
                impatience()
            return b""
        finally:
            slots[self._i_sleep] = S.AWAKE

    def frame(self, most: int, impatience: framing.Impatience = framing.nothing) -> bytes:
        """Receive the next frame, passing over bells. Raises as `framing.receive`."""
        while not (frame := framing.receive(self._connection, most, impatience)):
            impatience()
        return frame
