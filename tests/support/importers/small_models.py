"""Models between the scooter and its ECU where a system is made for another tool."""

from __future__ import annotations

from evcosim.models.base import Model, record, var


class Full(Model):
    """A throttle that is held at 100 %."""

    @record
    class Parameters:
        """The throttle."""

        held: float = var(100.0, "%", "Throttle")

    @record
    class Inputs:
        """None."""

    @record
    class State:
        """None."""

    @record
    class Outputs:
        """The throttle."""

        throttle: float = var(0.0, "%", "Throttle")

    @staticmethod
    def initial(p: Full.Parameters, u: Full.Inputs) -> Full.State:
        """Return no state."""
        return Full.State()

    @staticmethod
    def step(p: Full.Parameters, x: Full.State, u: Full.Inputs, dt: float) -> Full.State:
        """Return no state."""
        return x

    @staticmethod
    def outputs(p: Full.Parameters, x: Full.State) -> Full.Outputs:
        """Return the throttle."""
        return Full.Outputs(p.held)


class ToKmh(Model):
    """A speed in m/s as one in km/h, a step later."""

    @record
    class Parameters:
        """The factor."""

        factor: float = var(3.6, "1", "Factor")

    @record
    class Inputs:
        """The speed."""

        speed: float = var(0.0, "m/s", "Speed")

    @record
    class State:
        """The speed."""

        speed: float = var(0.0, "m/s", "Speed")

    @record
    class Outputs:
        """The speed."""

        converted: float = var(0.0, "km/h", "Speed")

    @staticmethod
    def initial(p: ToKmh.Parameters, u: ToKmh.Inputs) -> ToKmh.State:
        """Return the speed at the start."""
        return ToKmh.State(u.speed)

    @staticmethod
    def step(p: ToKmh.Parameters, x: ToKmh.State, u: ToKmh.Inputs, dt: float) -> ToKmh.State:
        """Return the speed."""
        return ToKmh.State(u.speed)

    @staticmethod
    def outputs(p: ToKmh.Parameters, x: ToKmh.State) -> ToKmh.Outputs:
        """Return the speed in km/h."""
        return ToKmh.Outputs(p.factor * x.speed)
