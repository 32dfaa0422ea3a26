"""The frames of a message: how they are made, sent and received, where values alone do not say it."""

from __future__ import annotations

import dataclasses

from ..errors import ConfigError
from .bus_settings import BusSettings
from .database import Message


@dataclasses.dataclass(frozen=True)
class Framing:
    """The settings of a message that is sent as the bytes of a frame."""


def framing_of(message: Message, settings: BusSettings) -> Framing | None:
    """Return how the frames of a message are made; None where its values alone say what receivers get."""
    return Framing() if settings.timing == "frame" else None


def check_jitter(message: Message, settings: BusSettings, cycle: float, place: str) -> None:
    """Raise ConfigError, which starts with `place`, where a frame could be queued after the next one.

    `cycle` [s] is the time between two of them.
    """
    own = settings.of_message(message.name).jitter
    jitter = settings.jitter if own is None else own
    if jitter >= cycle:
        raise ConfigError(
            f"{place}: message '{message.name}': jitter = {jitter} s is not less than its cycle time "
            f"{cycle} s: a frame would be queued after the next one"
        )
