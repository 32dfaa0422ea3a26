"""The comparison of model parameters with what a paper prints."""

from __future__ import annotations

import dataclasses
import importlib
import math

from ...cosim.figures.text import pretty
from ...cosim.units.conversion import between
from ...models.base import variables
from .printed import Printed

_ROUNDING = 1e-12  # relative, of a conversion


@dataclasses.dataclass(frozen=True)
class Parameter:
    """The default of a model parameter, and its unit of measure ("" or "1" for none)."""

    name: str
    value: float
    unit: str


def parameter(path: str) -> Parameter:
    """Return the parameter "module.Model.name" of `evcosim.models`.

    Raises ImportError, AttributeError or KeyError where there is none.
    """
    module, model, name = path.split(".")
    record = getattr(importlib.import_module(f"...models.{module}", __package__), model).Parameters
    found = {variable.name: variable for variable in variables(record)}[name]
    return Parameter(f"{model}.{name}", float(found.start), found.unit)


def compared(path: str, row: Printed) -> tuple[str, str, bool]:
    """Return name and value, with unit, of a parameter, and True if it is what the row prints.

    A printed number without a unit is compared as it stands; others are converted.
    """
    found = parameter(path)
    value = _in(found, row.unit)
    unit = row.unit or found.unit
    shown = f"{value:.12g} {pretty(unit)}" if unit not in ("", "1") else f"{value:.12g}"
    return found.name, shown, any(math.isclose(value, number, rel_tol=_ROUNDING) for number in row.numbers)


def _in(found: Parameter, unit: str) -> float:
    if not unit or unit == found.unit:
        return found.value
    return between(found.unit, unit)(found.value)
