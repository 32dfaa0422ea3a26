"""Models for systems whose bus is varied until they break."""

from __future__ import annotations

import os

from evcosim.models.base import Model, record, var


class Clock(Model):
    """Goes one meter in each step."""

    @record
    class Parameters:
        """None."""

    @record
    class Inputs:
        """None."""

    @record
    class State:
        """The steps done."""

        count: int = var(0, "", "Steps done")

    @record
    class Outputs:
        """The steps done, as a length."""

        way: float = var(0.0, "m", "One meter for each step")

    @staticmethod
    def initial(p, u):
        return Clock.State(0)

    @staticmethod
    def step(p, x, u, dt):
        return Clock.State(x.count + 1)

    @staticmethod
    def outputs(p, x):
        return Clock.Outputs(float(x.count))


class Picky(Model):
    """Follows what it receives; fails at a jump, and takes its process along at a great one."""

    @record
    class Parameters:
        """What it bears."""

        fails: float = var(3.5, "m", "A larger jump is an error")
        dies: float = var(6.5, "m", "A larger jump ends the process")

    @record
    class Inputs:
        """What is sent."""

        way: float = var(0.0, "m", "Received")

    @record
    class State:
        """What was received last."""

        last: float = var(0.0, "m", "Received last")

    @record
    class Outputs:
        """The same."""

        seen: float = var(0.0, "m", "Received last")

    @staticmethod
    def initial(p, u):
        return Picky.State(0.0)

    @staticmethod
    def step(p, x, u, dt):
        jump = abs(u.way - x.last)
        if jump > p.dies:
            os._exit(7)
        if jump > p.fails:
            raise ValueError(f"a jump of {jump:g} m")
        return Picky.State(u.way)

    @staticmethod
    def outputs(p, x):
        return Picky.Outputs(x.last)
