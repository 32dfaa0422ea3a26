"""A model in Python as a native FMU runs it, to be compared with it."""

from __future__ import annotations

from typing import Any

from ...models.base import Model, Variable, violations
from ..interface import exposed
from ..messages import Refused, message, told


class Twin:
    """The model in Python, as `slave` runs it.

    `shown` are its outputs after each call, and `messages` those of its failures and of its `notice`.
    """

    def __init__(self, model: type[Model]) -> None:
        variables = exposed(model)
        self._model, self._variables = model, variables
        self._values = {e.reference: e.variable.start for e in variables}
        self.references = [e.reference for e in variables if e.causality == "output"]
        self.outputs = [e.variable for e in variables if e.causality == "output"]
        self.shown: list[Any] = []
        self.messages: list[str] = []
        self._said: set[str] = set()
        self._timed = any(e.causality == "independent" for e in variables)

    def set(self, values: dict[int, Any]) -> None:
        """Set values by reference."""
        self._values.update(values)

    def start(self, time: float) -> bool:
        """Initialize at a time [s]; False where that is refused."""
        try:
            self._time = time
            self._p = self._model.Parameters(*self._of("parameter"))
            if bad := violations(self._p):
                raise Refused("; ".join(bad))
            self._x = self._model.initial(self._p, self._inputs())
            self._show(self._x)
            return True
        except Exception as error:  # whatever a model raises, the FMU reports
            self._tell("fmi2ExitInitializationMode", error)
            return False

    def step(self, time: float, dt: float) -> bool:
        """Take a step of dt at a time, both in s; False where it is refused, which changes nothing."""
        try:
            self._time = time
            u = self._inputs()
            x = self._model.step(self._p, self._x, u, dt)
            notice = self._model.notice
            said = "" if notice is None else notice(self._p, self._x, x, u)
            if self._timed and self._model.feeds_through() and not self._model.sampled:
                self._time = time + dt
            self._show(x)
            self._x = x
        except Exception as error:  # the same
            self._tell(f"fmi2DoStep at t = {time} s", error)
            return False
        if said and said not in self._said:
            self._said.add(said)
            self.messages.append(told(f"first at t = {time + dt:.9g} s: {said}").replace("%%", "%"))
        return True

    def saved(self) -> tuple[Any, ...]:
        """Return all that distinguishes two instances, as `restore` takes it."""
        return dict(self._values), self._time, self._p, self._x, self.shown

    def restore(self, saved: tuple[Any, ...]) -> None:
        """Go back to what was saved."""
        values, self._time, self._p, self._x, self.shown = saved
        self._values = dict(values)

    def _show(self, x: Any) -> None:
        more = (self._inputs(),) if self._model.feeds_through() else ()
        y = self._model.outputs(self._p, x, *more)
        self.shown = [_as(v, getattr(y, v.name)) for v in self.outputs]

    def _inputs(self) -> Any:
        return self._model.Inputs(*self._of("input", "independent"))

    def _of(self, *causalities: str) -> list[Any]:
        return [
            self._time if e.causality == "independent" else self._values[e.reference]
            for e in self._variables
            if e.causality in causalities
        ]

    def _tell(self, call: str, error: Exception) -> None:
        self.messages.append(message(call, error).replace("%%", "%"))


def _as(v: Variable, value: Any) -> Any:
    return float(value) if v.type == "Real" else bool(value) if v.type == "Boolean" else int(value)
