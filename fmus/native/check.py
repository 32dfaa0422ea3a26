"""Comparison of a native FMU with the model in Python that it was made of: every value, to the last bit.

Both run with random parameters, inputs, start times and step sizes, and go back to states that were saved.
The model in Python is called directly: its functions are what the FMU of Python calls, and the messages of
failures are made by the same module. Where its parameters are any, a model may take millions of inner steps:
such runs are short.
"""

from __future__ import annotations

import dataclasses
import random
import re
import struct
from collections.abc import Iterator
from math import ceil
from pathlib import Path
from typing import Any

from ...models.base import Model, Variable
from ..interface import exposed
from .library import NativeUnit
from .twin import Twin

STEPS = 1000
_RUN = 50  # steps with one set of parameters, at most
_SPAN, _LEAST = 0.5, 5  # s that they last; steps at least
_WILD = 0.2  # of the runs have any parameters, and few steps
_REFUSED = 3  # steps that may be refused in one of them
_SAVES = 0.06  # of the steps are after a state was saved or restored
_STEP_SIZES = (0.001, 0.01, 0.0173, 0.1)  # s
_STARTS = (0.0, 0.0, 5.0, 123.456)  # s


@dataclasses.dataclass
class Counts:
    """The calls and values of a comparison that were found to be the same."""

    steps: int = 0
    values: int = 0
    refusals: int = 0
    restored: int = 0


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
    end = counts.steps + steps
    draw = random.Random(f"{model.__name__} {seed}")
    with NativeUnit(library, model, token) as unit:
        for run in range(steps):  # as many as there are steps where none can be taken
            if counts.steps >= end:
                break
            if run and not unit.reset():
                return f"fmi2Reset fails: {unit.messages[-1]}"
            del unit.messages[:]
            if said := _Run(model, unit, draw, counts).difference(end - counts.steps, varied=run > 0):
                return said
    return ""


class _Run:
    """One initialization and some steps of both."""

    def __init__(self, model: type[Model], unit: NativeUnit, draw: random.Random, counts: Counts) -> None:
        self.model, self.unit, self.draw, self.counts = model, unit, draw, counts
        self.twin = Twin(model)
        self.kept: tuple[float, tuple[Any, ...]] | None = None  # a time [s] and the twin's state there

    def difference(self, most: int, varied: bool) -> str:
        """Return the first difference, in at most so many steps; not `varied` is near the start values."""
        draw = self.draw
        dt = draw.choice((*_STEP_SIZES, 10.0 ** draw.uniform(-4.0, -1.0)))
        time = draw.choice((*_STARTS, draw.uniform(0.0, 1000.0))) if varied else 0.0
        wild = draw.random() < _WILD
        values = dict(_drawn(self.model, draw, ("parameter", "input"), wild)) if varied else {}
        self.twin.set(values)
        went, started = self.unit.start(time, values), self.twin.start(time)
        said = self._unlike(f"the initialization at t = {time} s with {values}", went, started)
        if said or not started:
            return said
        stepped, refused = True, 0
        for k in range(min(most, _LEAST if wild else _RUN, max(_LEAST, ceil(_SPAN / dt)))):
            if k and stepped and draw.random() < _SAVES:
                time, said = self._save_or_restore(time)
                if said:
                    return said
            if k:  # the first step has the inputs of the initialization
                held = dict(_drawn(self.model, draw, ("input",))) if varied or k % 10 == 0 else {}
                self.twin.set(held)
                self.unit.set(held)
            taken = dt if draw.random() < 0.9 else dt * draw.uniform(0.1, 1.0)
            went, stepped = self.unit.step(time, taken), self.twin.step(time, taken)
            self.counts.steps += 1
            if said := self._unlike(f"the step from t = {time} s of {taken} s", went, stepped):
                return said
            refused += not stepped
            if refused == _REFUSED:
                break
            time += taken if stepped else 0.0
        return ""

    def _save_or_restore(self, time: float) -> tuple[float, str]:
        """Save the states of both, or go back to saved ones; return the time [s] then and a difference."""
        if self.kept is None or self.draw.random() < 0.5:
            self.kept = time, self.twin.saved()
            return time, self._unlike(f"the state saved at t = {time} s", self.unit.save(), True)
        time, saved = self.kept
        self.twin.restore(saved)
        self.counts.restored += 1
        restored = self.unit.restore(through_bytes=self.draw.random() < 0.5)
        return time, self._unlike(f"the state restored at t = {time} s", restored, True)

    def _unlike(self, at: str, native: bool, python: bool) -> str:
        """Return how the two are unlike after a call, in its outcome, messages or outputs, or ""."""
        unit, twin = self.unit, self.twin
        if native != python or _in_short(unit.messages) != _in_short(twin.messages):
            words = {True: "done", False: "refused"}
            return f"{at}: native {words[native]} {unit.messages}, in Python {words[python]} {twin.messages}"
        if not native:
            self.counts.refusals += 1
            return ""
        for v, a, b in zip(twin.outputs, unit.get(twin.references), twin.shown, strict=True):
            if _bits(a) != _bits(b):
                return f"{at}: {v.name} is {a!r}, in Python {b!r}"
        self.counts.values += len(twin.shown)
        return ""


def _in_short(messages: list[str]) -> list[str]:
    """Return messages in which the place of a failure has no folder: within an FMU files have another one."""
    return [re.sub(r"\([^()]*?([^()/\\]+\.py:\d+)\)$", r"(\1)", text) for text in messages]


def _bits(value: float | int | bool) -> bytes | int:
    """Return what makes two values the same: the bits of a float (any NaN is one NaN), else the number."""
    if isinstance(value, float):
        return b"nan" if value != value else struct.pack("<d", value)
    return int(value)


def _drawn(
    model: type[Model], draw: random.Random, causalities: tuple[str, ...], wild: bool = True
) -> Iterator[tuple[int, Any]]:
    """Return references and random values of some of the variables of these causalities."""
    for reference, causality, v in exposed(model):
        if causality in causalities and draw.random() < (0.3 if causality == "parameter" else 0.7):
            yield reference, _value(v, draw, wild or causality != "parameter")


def _value(v: Variable, draw: random.Random, wild: bool) -> Any:
    """Return a random value of a variable, within its range, near its start unless it may be any."""
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
    other = v.start * 4.0 ** draw.uniform(-1.0, 1.0)
    value = draw.choice((v.start, near, far, draw.choice((0.0, -0.0))) if wild else (v.start, near, other))
    return min(most, max(least, value))
