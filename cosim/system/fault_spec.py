"""Faults on buses, as a scenario gives them: a table `[[fault]]` for each, by its `action`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from ..can.flaws import GREATEST
from ..clock import LATEST
from .toml import FiniteModel


class _FaultRecord(FiniteModel):
    """Keys of all faults."""

    time: float = Field(ge=-LATEST, le=LATEST)
    """Time in s from which on it acts."""

    duration: float | None = Field(default=None, gt=0.0, le=LATEST)
    """Time in s for which it lasts; without it to the end."""


class _FrameFault(_FaultRecord):
    """Keys of the faults that hit frames, by the time at which those are sampled."""

    message: str | None = Field(default=None, examples=["can0.EMD_Status"])
    """The message, as "bus.message"."""

    node: str | None = Field(default=None, examples=["can0.EMD"])
    """The node whose messages are hit, as "bus.node"; a fault has a message or a node."""

    count: int | None = Field(default=None, ge=1, le=10**9)
    """Greatest number of frames that are hit; without it all."""

    every: int = Field(default=1, ge=1, le=10**9)
    """Every how many-th frame is hit."""

    probability: float = Field(default=1.0, ge=0.0, le=1.0)
    """Probability with which each of these is hit."""

    seed: int = Field(default=0, ge=0, lt=2**63)
    """Seed of the draws: equal ones give equal runs."""

    @model_validator(mode="after")
    def _one_target(self) -> _FrameFault:
        if (self.message is None) == (self.node is None):
            raise ValueError("a fault has a 'message' or a 'node', and not both")
        return self


class Lose(_FrameFault):
    """Frames are on the bus, but nobody receives them."""

    action: Literal["lose"]
    """The kind of fault."""


class Silence(_FrameFault):
    """Frames are not sent."""

    action: Literal["silence"]
    """The kind of fault."""


class Corrupt(_FrameFault):
    """Bits of a byte are flipped behind the sender's protection."""

    action: Literal["corrupt"]
    """The kind of fault."""

    byte: int = Field(ge=0, le=63)
    """The byte of which bits are flipped."""

    mask: int = Field(default=0xFF, ge=1, le=0xFF)
    """The bits that are flipped in it."""


class Freeze(_FrameFault):
    """The sender repeats its last payload."""

    action: Literal["freeze"]
    """The kind of fault."""

    counter: Literal["runs", "frozen"] = "runs"
    """The counter of a protected message goes on while it is frozen, with a right checksum, or stays too."""


class Delay(_FrameFault):
    """Frames reach their receivers later than they would, as behind a slow gateway."""

    action: Literal["delay"]
    """The kind of fault."""

    by: float = Field(gt=0.0, le=3600.0)
    """The time in s by which they are later."""


class BusOff(_FaultRecord):
    """A node is forced off the bus: it sends nothing, and what its unit would receive there is lost.

    After its duration it is back when it has heard 128 times 11 recessive bits.
    """

    action: Literal["bus_off"]
    """The kind of fault."""

    node: str = Field(examples=["can0.EMD"])
    """The node, as "bus.node"."""


class Babble(_FaultRecord):
    """A node sends an identifier of high priority all the time, on a bus with `timing = "frame"`."""

    action: Literal["babble"]
    """The kind of fault."""

    bus: str | None = Field(default=None, examples=["can0"])
    """The bus, where the node is none that sends something else."""

    node: str | None = Field(default=None, examples=["can0.EMD"])
    """The node that babbles, as "bus.node"; a fault has a bus or a node."""

    id: int = Field(default=0, ge=0, le=GREATEST[True])
    """The identifier, which no message that is sent has."""

    extended: bool = False
    """An identifier of 29 bits."""

    length: int = Field(default=8, ge=0, le=8)
    """Bytes of each frame, all of them 0."""

    period: float | None = Field(default=None, ge=1e-6, le=LATEST)
    """Time in s from one frame to the next; without it they follow each other back to back."""

    @model_validator(mode="after")
    def _fits(self) -> Babble:
        if (self.bus is None) == (self.node is None):
            raise ValueError("'babble' has a 'bus' or a 'node', and not both")
        if self.id > GREATEST[False] and not self.extended:
            raise ValueError(
                f"id = {self.id}: a standard one is {GREATEST[False]} (0x7FF) at most; extended = true"
            )
        return self


FrameFault = Lose | Silence | Corrupt | Freeze | Delay
"""The faults that hit frames."""
Fault = Annotated[FrameFault | BusOff | Babble, Field(discriminator="action")]
"""A fault, by its `action`."""


def target_of(fault: Fault) -> str:
    """Return what a fault acts on: "bus.message", "bus.node" or a bus."""
    match fault:
        case BusOff():
            return fault.node
        case Babble():
            return fault.node or fault.bus or ""
        case _:
            return fault.message or fault.node or ""
