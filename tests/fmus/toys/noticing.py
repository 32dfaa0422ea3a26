"""A toy that counts, and says what a user must know of."""

from __future__ import annotations

from evcosim.models.base import Model, record, var


class Noticing(Model):
    """Counts its steps."""

    @record
    class Parameters:
        """Nothing to set but a limit."""

        limit: float = var(2.0, "", "Count from which on there is something to say")

    @record
    class Inputs:
        """One number."""

        silent: bool = var(False, "", "Say nothing")

    @record
    class State:
        """The count."""

        count: float = var(0.0, "", "Count")

    @record
    class Outputs:
        """The count."""

        shown: float = var(0.0, "", "Count")

    @staticmethod
    def initial(p: Noticing.Parameters, u: Noticing.Inputs) -> Noticing.State:
        """Nothing counted."""
        return Noticing.State(0.0)

    @staticmethod
    def step(p: Noticing.Parameters, x: Noticing.State, u: Noticing.Inputs, dt: float) -> Noticing.State:
        """One more."""
        return Noticing.State(x.count + 1.0)

    @staticmethod
    def outputs(p: Noticing.Parameters, x: Noticing.State) -> Noticing.Outputs:
        """The count."""
        return Noticing.Outputs(x.count)

    @staticmethod
    def notice(
        p: Noticing.Parameters, before: Noticing.State, after: Noticing.State, u: Noticing.Inputs
    ) -> str:
        """The limit that was passed, once or twice over."""
        if u.silent or after.count < p.limit:
            return ""
        return "100 % of the limit" if before.count < 2.0 * p.limit else "200 % of the limit"
