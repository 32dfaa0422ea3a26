"""A message as a bus sends it: what its database says, and what the settings of the bus say in its place."""

from __future__ import annotations

import dataclasses

from .bus_settings import BusSettings
from .database import Message

_CLASSIC = 8  # bytes


def as_sent(message: Message, settings: BusSettings) -> Message:
    """Return the message with the times and the kind of frame that it has on the bus.

    Its own entry in `messages` counts before the database, and that before the bus' `cycle_time` and `fd`.
    Where no setting says it, a message is a CAN FD frame if the database marks it as one or it has more than
    8 bytes; a parameter group of J1939 never is. The length becomes one that a frame can have: bytes that are
    added are 0, and no part of what a checksum protects.
    """
    own = settings.of_message(message.name)
    cycles = (own.cycle_time, message.cycle_time, settings.cycle_time)
    kinds = (own.fd, settings.fd, message.fd or message.length > _CLASSIC)
    made = dataclasses.replace(
        message,
        cycle_time=next((cycle for cycle in cycles if cycle is not None), None),
        start_delay=message.start_delay if own.start_delay is None else own.start_delay,
        fd=not message.j1939 and next(kind for kind in kinds if kind is not None),
        problem=message.problem or _too_long(message, own.fd, settings.fd),
    )
    added = made.frame_length > message.length
    return dataclasses.replace(
        made, length=made.frame_length, own_length=message.length if added else message.own_length
    )


def _too_long(message: Message, *choices: bool | None) -> str:
    """Return the problem of a message that a choice of the file makes a classic frame; "" for none."""
    choice = next((choice for choice in choices if choice is not None), None)
    if choice is not False or message.length <= _CLASSIC:
        return ""
    return f"the message has {message.length} bytes, and `fd = false` leaves it a classic frame of 8"
