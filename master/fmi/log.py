"""The log messages of FMI 2.0 units: one callback for the process, a queue for each unit."""

from __future__ import annotations

import collections
import ctypes
import itertools

from fmpy.fmi2 import addLoggerProxy, calloc, fmi2CallbackFunctions, free
from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as AllocateMemory
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as FreeMemory
from fmpy.fmi2 import fmi2CallbackLoggerTYPE as Logger

STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
_KEPT = 100
_queues: dict[int, UnitLog] = {}
_ids = itertools.count(1)


class UnitLog:
    """The last messages of one unit, and how many warnings it gave."""

    def __init__(self) -> None:
        self.id = next(_ids)
        self.messages: collections.deque[str] = collections.deque(maxlen=_KEPT)
        self.warnings = 0
        _queues[self.id] = self

    def callbacks(self) -> fmi2CallbackFunctions:
        """The callback structure to instantiate the unit with; keep it as long as the unit lives."""
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = _receive
        callbacks.allocateMemory = AllocateMemory(calloc)
        callbacks.freeMemory = FreeMemory(free)
        callbacks.componentEnvironment = self.id
        # FMPy's native proxy formats the variadic arguments, which ctypes cannot; it remembers one
        # logger for the whole process, hence the single callback and the queues by environment
        addLoggerProxy(ctypes.byref(callbacks))
        return callbacks

    def last(self, count: int = 3) -> str:
        """The last messages, one in a line; empty when there is none."""
        return "\n".join(list(self.messages)[-count:])

    def close(self) -> None:
        """Receive no more messages."""
        _queues.pop(self.id, None)


def _message(
    environment: int | None, _name: bytes, status: int, category: bytes | None, text: bytes | None
) -> None:
    queue = _queues.get(environment or 0)
    if queue is None:
        return
    word = STATUS[status] if 0 <= status < len(STATUS) else str(status)
    said = (text or b"").decode("utf-8", "replace").strip()
    if said.startswith("Fatal py exception encountered: "):  # pythonfmu's own words above the exception's
        said = said.partition("\n")[2] or said
    queue.messages.append(f"[{word}] {said}")
    queue.warnings += status == 1


_receive = Logger(_message)
