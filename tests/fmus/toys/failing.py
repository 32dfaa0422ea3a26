"""A toy that raises where it is told to."""

from __future__ import annotations

from evcosim.models.base import Model, record, var


class Failing(Model):
    """Raises in `initial`, `step` or `outputs`."""

    @record
    class Parameters:
        """When to raise."""

        in_initial: bool = var(False, "", "Raise in initial")
        in_step: bool = var(False, "", "Raise in step")
        interrupt: bool = var(False, "", "Raise KeyboardInterrupt in step")
        throttle: float = var(1.0, "%", "Any number", max=100.0)

    @record
    class Inputs:
        """When to raise in outputs."""

        command: float = var(0.0, "", "666 raises, 1 gives an output that is no number")

    @record
    class State:
        """A sum."""

        total: float = var(0.0, "", "Sum")

    @record
    class Outputs:
        """The sum."""

        total: float = var(0.0, "", "Sum", depends=("command",))

    @staticmethod
    def initial(p: Failing.Parameters, u: Failing.Inputs) -> Failing.State:
        """Raises a text that breaks what is careless with formats and encodings."""
        if p.in_initial:
            raise RuntimeError("100 % sure %s %n \u00fc \udc80 \0")
        return Failing.State(0.0)

    @staticmethod
    def step(p: Failing.Parameters, x: Failing.State, u: Failing.Inputs, dt: float) -> Failing.State:
        """Adds the command, or raises."""
        if p.in_step:
            raise ZeroDivisionError("no 100 % step")
        if p.interrupt:
            raise KeyboardInterrupt
        return Failing.State(x.total + u.command)

    @staticmethod
    def outputs(p: Failing.Parameters, x: Failing.State, u: Failing.Inputs) -> Failing.Outputs:
        """The sum, or what it must not be."""
        if u.command == 666.0:
            raise KeyError("command")
        return Failing.Outputs(None if u.command == 1.0 else x.total)
