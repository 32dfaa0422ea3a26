"""The log messages of units: one callback for the process and FMI version, a queue for each unit."""

from __future__ import annotations

import collections
import contextlib
import ctypes
import itertools
from collections.abc import Callable, Iterator
from typing import ClassVar

from ..warned import WarningKinds
from .callbacks import Callbacks2, CoSimulationCallbacks1, Logger, ModelExchangeCallbacks1, complete

STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
_KEPT = 100
_RECENT = 20
_LONGEST = 2000  # characters of a message that are kept
_queues: dict[int, UnitLog] = {}
# a unit of FMI 1.0 is known by its component, which there is only when instantiation ends
_instantiating: list[UnitLog] = []
_ids = itertools.count(1)


class UnitLog:
    """The last messages of one unit, and how many warnings it gave."""

    listener: ClassVar[Callable[[int, str], None] | None] = None
    """Called with each message at once, in the process of an isolated unit, which may end with it."""

    def __init__(self) -> None:
        self.id = next(_ids)
        self.messages: collections.deque[str] = collections.deque(maxlen=_KEPT)
        self.warnings = 0
        self.kinds = WarningKinds()
        self._keys = [self.id]
        _queues[self.id] = self

    def callbacks(self) -> Callbacks2:
        """Return FMI 2.0's callback structure for the instantiation; keep it as long as the unit lives."""
        callbacks = Callbacks2(componentEnvironment=self.id)
        complete(callbacks, _receive)  # a single one for the process, hence the queues by environment
        return callbacks

    def callbacks_1(self, steps: bool = True) -> CoSimulationCallbacks1 | ModelExchangeCallbacks1:
        """Return FMI 1.0's callback structure; keep it as long as the unit lives.

        `steps` is true for Co-Simulation; its structure, which is passed by value, has a member more.
        """
        callbacks = CoSimulationCallbacks1() if steps else ModelExchangeCallbacks1()
        complete(callbacks, _receive)
        return callbacks

    @contextlib.contextmanager
    def instantiating(self) -> Iterator[None]:
        """Take the messages of an FMI 1.0 unit without a component in the `with` block as this log's."""
        _instantiating.append(self)
        try:
            yield
        finally:
            _instantiating.remove(self)

    def belongs_to(self, component: int) -> None:
        """Receive the messages of the FMI 1.0 unit with this component."""
        self._keys.append(component)
        _queues[component] = self

    def add(self, status: int, text: str) -> None:
        """Keep a message; one of status Warning is counted."""
        word = STATUS[status] if 0 <= status < len(STATUS) else str(status)
        self.messages.append(f"[{word}] {text[:_LONGEST]}")
        if UnitLog.listener is not None:
            UnitLog.listener(status, text[:_LONGEST])
        if status == 1:
            self.warnings += 1
            self.kinds.add(text[:_LONGEST])

    def last(self, count: int = 3) -> str:
        """Return the last messages, one in a line; "" when there is none.

        Of the last 20 those that are not of status OK, where there are any: they are the reason.
        """
        recent = list(self.messages)[-_RECENT:]
        trouble = [text for text in recent if not text.startswith("[OK]")]
        return "\n".join((trouble or recent)[-count:])

    def ends_in_error(self) -> bool:
        """Return True where the last message is of status Error or Fatal."""
        return bool(self.messages) and self.messages[-1].startswith(("[Error]", "[Fatal]"))

    def close(self) -> None:
        """Receive no more messages."""
        for key in self._keys:
            _queues.pop(key, None)


def _message(
    environment: int | None, _name: bytes, status: int, category: bytes | None, text: bytes | None
) -> None:
    queue = _queues.get(environment or 0) or (_instantiating[-1] if _instantiating else None)
    if queue is None:
        return
    said = (text or b"").decode("utf-8", "replace").strip()
    if said.startswith("Fatal py exception encountered: "):  # pythonfmu's own words above the exception's
        said = said.partition("\n")[2] or said
    queue.add(status, said)


def _message_3(environment: int | None, status: int, category: bytes | None, text: bytes | None) -> None:
    _message(environment, b"", status, category, text)


_receive = Logger(_message)
LogMessage3 = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
receive_3 = LogMessage3(_message_3)
"""FMI 3.0's fmi3LogMessageCallback; the instance environment is `UnitLog.id`."""
