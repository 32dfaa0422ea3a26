"""The frames of a message: how they are made, sent and received, where values alone do not say it."""

from __future__ import annotations

import dataclasses


@dataclasses.dataclass(frozen=True)
class Framing:
    """The settings of a message that is sent as the bytes of a frame."""
