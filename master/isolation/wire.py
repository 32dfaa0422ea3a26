"""What master and child say to each other over a socket, and how values stand in the memory that they share.

A frame is a length and as many bytes. Requests are pickled, answers are JSON: the child runs foreign code,
and the master must not execute what it sends. Values of a turn go through shared memory that belongs to this
unit alone, so that a unit that writes anywhere spoils nothing but its own values.
"""

from __future__ import annotations

import dataclasses
import socket
import struct

from ...cosim.plan import Block, UnitPlan

_LENGTH = struct.Struct("<I")
LONGEST = 1 << 20  # bytes of an answer

TURN = struct.Struct("<cddi")
"""A turn: what is asked for (see below), time [s], step size [s], number of steps."""
CALL, STEP, OUTPUTS, FEEDTHROUGH = b"c", b"s", b"o", b"f"
DONE = b"+"
"""The answer to a turn that went well; any other one is a frame of JSON."""


def send(connection: socket.socket, content: bytes) -> None:
    """Send a frame."""
    connection.sendall(_LENGTH.pack(len(content)) + content)


def receive(connection: socket.socket) -> bytes:
    """Receive a frame. Raises EOFError when the other side has gone, or sends what is no frame."""
    (length,) = _LENGTH.unpack(exactly(connection, _LENGTH.size))
    return exactly(connection, length)


def exactly(connection: socket.socket, count: int) -> bytes:
    """Receive `count` bytes. Raises EOFError."""
    if count > LONGEST:
        raise EOFError(f"{count} bytes are no answer")
    content = b""
    while len(content) < count:
        part = connection.recv(count - len(content))
        if not part:
            raise EOFError("the connection ended")
        content += part
    return content


def private(plan: UnitPlan) -> tuple[UnitPlan, int]:
    """The plan of a unit with its blocks at the start of a memory of their own, and that memory's size."""
    blocks, place = [], 0
    for block in plan.blocks:
        n = len(block.variables)
        latest = place + n if block.kind == "continuous" else -1
        blocks.append(dataclasses.replace(block, slot=place, latest=latest))
        place += 2 * n if block.kind == "continuous" else n
    return dataclasses.replace(plan, blocks=tuple(blocks), routes=()), place


def shown(block: Block) -> int:
    """The first slot into which a unit writes the outputs of a block after its step."""
    return block.latest if block.kind == "continuous" else block.slot
