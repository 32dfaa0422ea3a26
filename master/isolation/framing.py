"""Frames over the socket between the master and a child: a length and as many bytes.

Requests are pickled, answers are JSON: the child runs foreign code, and the master executes nothing that it
sends. A frame of no bytes is a bell: it wakes a side that sleeps until a number stands in the shared memory
(see `handover`).
"""

from __future__ import annotations

import socket
import struct
from collections.abc import Callable

_LENGTH = struct.Struct("<I")
BELL = _LENGTH.pack(0)
LONGEST = 1 << 20
"""The most bytes of an answer."""

LOADING = "loading"
"""The file in the child's working folder with the arguments of its first request, pickled."""

LOST = 76
"""The exit code of a child whose socket fails (EX_PROTOCOL): where the master lives, the FMU closed it."""

Impatience = Callable[[], None]
"""Called from time to time while nothing moves; it raises the error that ends the wait."""


def nothing() -> None:
    """Wait on."""


def send(connection: socket.socket, content: bytes, impatience: Impatience = nothing) -> None:
    """Send a frame. Raises OSError when the other side has gone, and the errors of `impatience`."""
    left = memoryview(_LENGTH.pack(len(content)) + content)
    while left:
        try:
            left = left[connection.send(left) :]
        except TimeoutError:
            impatience()


def receive(connection: socket.socket, most: int = LONGEST, impatience: Impatience = nothing) -> bytes:
    """Receive a frame of at most `most` bytes.

    Raises EOFError when the other side has gone or sends anything but a frame, OSError, and the errors of
    `impatience`.
    """
    (length,) = _LENGTH.unpack(_exactly(connection, _LENGTH.size, impatience))
    if length > most:
        raise EOFError(f"{length} bytes are no frame")
    return _exactly(connection, length, impatience) if length else b""


def _exactly(connection: socket.socket, count: int, impatience: Impatience) -> bytes:
    content = b""
    while len(content) < count:
        try:
            part = connection.recv(min(count - len(content), LONGEST))
        except TimeoutError:
            part = None
        if part == b"":
            raise EOFError("the connection ended")
        content += part or b""
        if len(content) < count:
            impatience()
    return content
