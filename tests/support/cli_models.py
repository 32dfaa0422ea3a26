"""Models that misbehave, for FMUs that a user of the command line might meet."""

from __future__ import annotations

import os
import time

from evcosim.models.base import Model, record, var


class Fragile(Model):
    """Counts its steps and fails in the step after the last one it can do."""

    @record
    class Parameters:
        """Where it breaks."""

        last: int = var(500, "", "Steps that it can do")

    @record
    class Inputs:
        """Nothing that matters."""

        push: float = var(0.0, "N", "A force without effect")

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
        return Fragile.State(0)

    @staticmethod
    def step(p, x, u, dt):
        if x.count >= p.last:
            raise ValueError(f"the chain came off after {x.count} steps")
        return Fragile.State(x.count + 1)

    @staticmethod
    def outputs(p, x):
        return Fragile.Outputs(float(x.count))


class Through(Model):
    """y = u + 1, at once."""

    @record
    class Parameters:
        """None."""

    @record
    class Inputs:
        """The number."""

        u: float = var(0.0, "m", "Input")

    @record
    class State:
        """Nothing."""

        nothing: float = var(0.0, "", "Nothing")

    @record
    class Outputs:
        """The number and one."""

        y: float = var(0.0, "m", "Input and 1 m", depends=("u",))

    @staticmethod
    def initial(p, u):
        return Through.State(0.0)

    @staticmethod
    def step(p, x, u, dt):
        return x

    @staticmethod
    def outputs(p, x, u):
        return Through.Outputs(u.u + 1.0)


class Poison(Model):
    """Gives a number that is none from its tenth step on."""

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
        """A quotient."""

        y: float = var(0.0, "m", "Not a number from the tenth step on")

    @staticmethod
    def initial(p, u):
        return Poison.State(0)

    @staticmethod
    def step(p, x, u, dt):
        return Poison.State(x.count + 1)

    @staticmethod
    def outputs(p, x):
        return Poison.Outputs(float("nan") if x.count >= 10 else 1.0)


class Stuck(Model):
    """Never comes back from its tenth step."""

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
        return Stuck.State(0)

    @staticmethod
    def step(p, x, u, dt):
        if x.count >= 10:
            if mark := os.environ.get("EVCOSIM_TEST_STUCK"):
                open(mark, "w").close()
            while True:
                time.sleep(0.01)
        return Stuck.State(x.count + 1)

    @staticmethod
    def outputs(p, x):
        return Stuck.Outputs(float(x.count))
