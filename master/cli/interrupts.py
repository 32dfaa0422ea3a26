"""Ctrl-C while units are stepping: the first is noted and looked at between steps, the second ends at once.

Python would raise KeyboardInterrupt wherever it happens to be, which can be inside a model that runs on
pythonfmu: its native library turns that into a failed step. Python's own handler also waits for a native
step to end; the thread here does not, since the signal writes into a socket by itself. While the master waits
for a unit in a process of its own, the first one breaks the wait off.
"""

from __future__ import annotations

import os
import signal
import socket
import threading
from types import FrameType, TracebackType
from typing import Any

from ..isolation.waiting import waits
from .failures import INTERRUPTED


class Interrupts:
    """A `with` block in which Ctrl-C is noted, and `check` raises KeyboardInterrupt after it.

    Outside the main thread, where Python allows no signal handlers, it does nothing.
    """

    def __init__(self) -> None:
        self._count = 0
        self._active = threading.current_thread() is threading.main_thread()

    def check(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C was noted."""
        if self._count:
            raise KeyboardInterrupt

    def __enter__(self) -> Interrupts:
        if self._active:
            self._reader, self._writer = socket.socketpair()
            self._writer.setblocking(False)
            self._handler: Any = signal.signal(signal.SIGINT, self._note)
            self._wakeup = signal.set_wakeup_fd(self._writer.fileno())
            threading.Thread(target=self._watch, args=(self._reader,), daemon=True).start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._active:
            signal.set_wakeup_fd(self._wakeup)
            signal.signal(signal.SIGINT, self._handler)
            self._writer.close()  # the thread reads the end of the stream and returns

    def _note(self, number: int, frame: FrameType | None) -> None:
        self._count += 1
        if waits():
            raise KeyboardInterrupt

    @staticmethod
    def _watch(reader: socket.socket) -> None:
        seen = 0
        with reader:
            while received := reader.recv(16):
                seen += received.count(signal.SIGINT)
                if seen > 1:
                    os._exit(INTERRUPTED)
