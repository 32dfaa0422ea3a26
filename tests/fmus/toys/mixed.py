"""A toy with a variable of every type, time, feedthrough, an array in its state and a module beside it."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from mixed_helper import SCALE

from evcosim.models.base import Model, record, time, var


class Gear(IntEnum):
    """Which way it goes."""

    REVERSE = -1
    NEUTRAL = 0
    FORWARD = 2


class Mixed(Model):
    """Sums what it is given.

    Not part of the description.
    """

    initial_inputs = ("speed", "clock")

    @record
    class Parameters:
        """All types."""

        weight: float = var(1.5, "kg", "A Real <parameter> & more", min=0.0, max=10.0)
        count: int = var(3, "", "An Integer parameter", min=0, max=9)
        active: bool = var(True, "", "A Boolean parameter")
        gear: Gear = var(Gear.FORWARD, "", "An Enumeration parameter")

    @record
    class Inputs:
        """All types, and time in between."""

        speed: float = var(0.0, "km/h", "A Real input")
        clock: float = time()
        steps: int = var(0, "", "An Integer input")
        on: bool = var(False, "", "A Boolean input")
        lever: Gear = var(Gear.NEUTRAL, "", "An Enumeration input")

    @record
    class State:
        """A sum, its record and the last gear."""

        total: float = var(0.0, "", "Sum")
        last: Gear = var(Gear.NEUTRAL, "", "Gear")
        history: np.ndarray = var(0.0, "", "The last three sums")

    @record
    class Outputs:
        """All types; some feed through."""

        total: float = var(0.0, "", "Sum")
        direct: float = var(0.0, "", "Sum, speed and time", depends=("speed", "clock"))
        steps_seen: int = var(0, "", "An Integer output", depends=("steps",), initially=("steps", "speed"))
        is_on: bool = var(False, "", "A Boolean output", depends=("on",))
        last_lever: Gear = var(Gear.NEUTRAL, "", "An Enumeration output")
        oldest: float = var(0.0, "", "The oldest of the record")

    @staticmethod
    def initial(p: Mixed.Parameters, u: Mixed.Inputs) -> Mixed.State:
        """Starts at speed and time."""
        return Mixed.State(u.speed + u.clock, Gear.NEUTRAL, np.zeros(3))

    @staticmethod
    def step(p: Mixed.Parameters, x: Mixed.State, u: Mixed.Inputs, dt: float) -> Mixed.State:
        """Adds, in an order that rounding remembers."""
        total = x.total + dt * (SCALE * u.speed + u.clock) / 3.0 + p.count * u.steps
        if p.active and u.on and u.lever is p.gear:
            total = total * 1.1 + p.weight
        return Mixed.State(total, u.lever, np.append(x.history[1:], total))

    @staticmethod
    def outputs(p: Mixed.Parameters, x: Mixed.State, u: Mixed.Inputs) -> Mixed.Outputs:
        """The oldest is a numpy number."""
        return Mixed.Outputs(x.total, x.total + u.speed + u.clock, u.steps + 1, u.on, x.last, x.history[0])
