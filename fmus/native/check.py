"""Comparison of a native FMU with the model in Python that it was made of: every value, to the last bit.

Both run with random parameters, inputs, start times and step sizes. The model in Python is called directly:
its functions are what the FMU of Python calls, and the messages of failures are made by the same module.
"""

from __future__ import annotations

import dataclasses
import random
import re
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...models.base import Model, Variable, violations
from ..interface import exposed
from ..messages import Refused, message, told
from .library import NativeUnit

STEPS = 1000
_RUN = 50  # steps with one set of parameters
_STEP_SIZES = (0.001, 0.01, 0.0173, 0.1)  # s
_STARTS = (0.0, 0.0, 5.0, 123.456)  # s


@dataclasses.dataclass
class Counts:
    """The calls and values of a comparison that were found to be the same."""

    steps: int = 0
    values: int = 0
    refusals: int = 0


def first_difference(
    model: type[Model],
    library: Path,
    token: str,
    steps: int = STEPS,
    seed: int = 0,
    counts: Counts | None = None,
) -> str:
    """Return a sentence on the first value or message in which both differ within so many steps, or "".

    `library` is the FMU's for this machine, `token` its guid; `counts` are raised by what was compared.
    Raises OSError and RuntimeError, as NativeUnit.
    """
    counts = counts or Counts()
    draw = random.Random(f"{model.__name__} {seed}")
    with NativeUnit(library, model, token) as unit:
        for run in range(-(-steps // _RUN)):
            if run and not unit.reset():
                return f"fmi2Reset fails: {unit.messages[-1]}"
            del unit.messages[:]
            if said := _compare_run(model, unit, draw, min(_RUN, steps - run * _RUN), run > 0, counts):
                return said
    return ""


def _compare_run(
    model: type[Model], unit: NativeUnit, draw: random.Random, steps: int, varied: bool, counts: Counts
) -> str:
    """Return the first difference of one initialization and some steps."""
    twin = _Twin(model)
    time = draw.choice(_STARTS) if varied else 0.0
    values = dict(_drawn(model, draw, ("parameter", "input"))) if varied else {}
    twin.set(values)
    went, started = unit.start(time, values), twin.start(time)
    if said := _unlike(f"the initialization at t = {time} s with {values}", went, started, unit, twin):
        return said
    _count(counts, 0, started, twin)
    if not started:
        return ""
    dt = draw.choice(_STEP_SIZES)
    for k in range(steps):
        if k:  # the first step has the inputs of the initialization
            held = dict(_drawn(model, draw, ("input",))) if varied or k % 10 == 0 else {}
            twin.set(held)
            unit.set(held)
        at = f"the step from t = {time} s of {dt} s"
        went, stepped = unit.step(time, dt), twin.step(time, dt)
        if said := _unlike(at, went, stepped, unit, twin):
            return said
        _count(counts, 1, stepped, twin)
        if not stepped:
            return ""
        time += dt
    return ""


def _count(counts: Counts, steps: int, went: bool, twin: _Twin) -> None:
    counts.steps += steps
    counts.values += len(twin.shown) if went else 0
    counts.refusals += not went


def _unlike(at: str, native: bool, python: bool, unit: NativeUnit, twin: _Twin) -> str:
    """Return how the two are unlike after a call, in its outcome, messages or outputs, or ""."""
    if native != python or _in_short(unit.messages) != _in_short(twin.messages):
        words = {True: "done", False: "refused"}
        return f"{at}: native {words[native]} {unit.messages}, in Python {words[python]} {twin.messages}"
    if not native:
        return ""
    for v, a, b in zip(twin.outputs, unit.get(twin.references), twin.shown, strict=True):
        if _bits(a) != _bits(b):
            return f"{at}: {v.name} is {a!r}, in Python {b!r}"
    return ""


def _in_short(messages: list[str]) -> list[str]:
    """Return messages in which the place of a failure has no folder: within an FMU files have another one."""
    return [re.sub(r"\([^()]*?([^()/\\]+\.py:\d+)\)$", r"(\1)", text) for text in messages]


def _bits(value: float | int | bool) -> bytes | int:
    """Return what makes two values the same: the bits of a float (any NaN is one NaN), else the number."""
    if isinstance(value, float):
        return b"nan" if value != value else struct.pack("<d", value)
    return int(value)


class _Twin:
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
        self._values.update(values)

    def start(self, time: float) -> bool:
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


def _drawn(
    model: type[Model], draw: random.Random, causalities: tuple[str, ...]
) -> Iterator[tuple[int, Any]]:
    """Return references and random values of some of the variables of these causalities."""
    for reference, causality, v in exposed(model):
        if causality in causalities and draw.random() < (0.3 if causality == "parameter" else 0.7):
            yield reference, _value(v, draw)


def _value(v: Variable, draw: random.Random) -> Any:
    """Return a random value of a variable, within its range, often near its start."""
    if v.enumeration is not None:
        return draw.choice(list(v.enumeration))
    if v.type == "Boolean":
        return draw.random() < 0.5
    least = -1e6 if v.min is None else v.min
    most = 1e6 if v.max is None else v.max
    if v.type == "Integer":
        return draw.randint(int(max(least, v.start - 5)), int(min(most, v.start + 5)))
    size = max(abs(v.start), v.nominal or 0.0) or 1.0
    near, far = v.start + size * draw.gauss(0.0, 0.2), size * draw.gauss(0.0, 2.0)
    value = draw.choice((v.start, near, far, draw.choice((0.0, -0.0))))
    return min(most, max(least, value))
