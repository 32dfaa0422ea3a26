"""A CAN log as a stimulus, as a scenario describes it."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Field

from .system import Identifier, VariableName
from .toml import FiniteModel, text_type


def _signal(text: str) -> str:
    message, dot, signal = text.partition(".")
    if not (message and dot and signal):
        raise ValueError("a signal of the bus is written as message.signal")
    return text


_BusSignal = Annotated[str, AfterValidator(_signal), text_type("message.signal", r"^[^.]+\.[^\n]+$")]


class CanLogEntry(FiniteModel):
    """A CAN log that is replayed: the frames of nodes that are not simulated drive what receives them."""

    can_log: str = Field(examples=["drive.blf"])
    """The file, beside this one: .log (candump -L), .asc, .blf, .mf4, .pcapng, .trc or .csv (python-can)."""

    bus: Identifier = Field(examples=["can0"])
    """The bus of the system whose frames it has; its database decodes them."""

    time_offset: float | None = None
    """Time of the log in s, as the file counts it, at which the run's clock shows 0 s; without it that of the
    first frame."""

    channel: Annotated[int, Field(ge=0, le=0xFFFF)] | str | None = None
    """The interface whose frames are replayed, as the file names or numbers it; without it the only one, or
    that of the bus' name."""

    messages: list[str] | None = None
    """The messages that are replayed; without it all that a unit receives and no unit sends."""

    to: dict[VariableName, _BusSignal] = Field(
        default={}, examples=[{"controller.speed": "EMD_Status.EMD_VehicleSpeed"}]
    )
    """Free inputs and the signals that drive them, as message.signal; beside the receivers of connections
    whose sender takes no part."""


def is_log(entry: Any) -> bool:
    """Return True for a table of a scenario, or what was made of one, that is a CAN log."""
    return isinstance(entry, CanLogEntry) or (isinstance(entry, dict) and "can_log" in entry)
