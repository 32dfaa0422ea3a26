"""A toy controller whose output also takes the input of its sample."""

from __future__ import annotations

from evcosim.models.base import Model, record, var


class Sampled(Model):
    """Counts, and adds the input of the sample."""

    sampled = True

    @record
    class Parameters:
        """The step of the count."""

        by: float = var(1.0, "", "Added in each sample")

    @record
    class Inputs:
        """One number."""

        offset: float = var(0.0, "", "Added to what is shown")

    @record
    class State:
        """The count."""

        count: float = var(0.0, "", "Count")

    @record
    class Outputs:
        """Count and offset of the last sample."""

        shown: float = var(0.0, "", "Count and offset", depends=("offset",))

    @staticmethod
    def initial(p: Sampled.Parameters, u: Sampled.Inputs) -> Sampled.State:
        """Nothing counted."""
        return Sampled.State(0.0)

    @staticmethod
    def step(p: Sampled.Parameters, x: Sampled.State, u: Sampled.Inputs, dt: float) -> Sampled.State:
        """One more."""
        return Sampled.State(x.count + p.by)

    @staticmethod
    def outputs(p: Sampled.Parameters, x: Sampled.State, u: Sampled.Inputs) -> Sampled.Outputs:
        """What the sample shows."""
        return Sampled.Outputs(x.count + u.offset)
