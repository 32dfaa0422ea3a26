"""Values that files and calls give to variables: each in the type of its variable, or refused.

Values of a run are kept as doubles, a text as its number in the run's table of texts: a whole number that no
double holds exactly is refused, never rounded.
"""

from __future__ import annotations

import math
import re
import sys
from typing import Any

import numpy as np

from ..errors import ConfigError, nearest
from ..interface import Value, VariableInfo
from ..texts import Texts
from .problems import brief

WHOLE = re.compile(r"[+-]?\d{1,400}")
"""A whole number as a text: of more digits Python makes no integer, and a double holds none either."""

_SHOWN_ITEMS = 12


def checked(value: Any, variable: VariableInfo, place: str) -> Value:
    """Return the value, given in the variable's unit, in the variable's type.

    Raises ConfigError, which starts with `place`, when it has another type or is out of range.
    """
    found = of_type(value, variable, place)
    if isinstance(found, bool | str):
        return found
    unit = f" {variable.unit}" if variable.unit else ""
    if variable.min is not None and found < variable.min:
        raise ConfigError(
            f"{place}: {value}{unit} is below the minimum {variable.min}{unit} of {variable.name}"
        )
    if variable.max is not None and found > variable.max:
        raise ConfigError(
            f"{place}: {value}{unit} is above the maximum {variable.max}{unit} of {variable.name}"
        )
    return found


def of_type(value: Any, variable: VariableInfo, place: str) -> Value:
    """Return the value in the variable's type; its minimum and maximum count for nothing.

    An enumeration takes the name of an item too. Raises ConfigError, which starts with `place`, for a value
    of another type, beyond its numbers, or that is no item.
    """
    name = variable.name
    value = value.item() if isinstance(value, np.generic) else value
    if variable.type == "String":
        if not isinstance(value, str):
            raise ConfigError(f"{place}: {name} is a String, not {brief(value)}: a text stands in quotes")
        if "\0" in value or any("\ud800" <= c <= "\udfff" for c in value):
            raise ConfigError(f"{place}: {name} = {brief(value)}: no C text holds a NUL or half a character")
        return value
    if variable.type == "Enumeration" and isinstance(value, str):
        return _item(value, variable, place)
    if variable.type == "Boolean":
        if isinstance(value, str) or value not in (True, False):
            raise ConfigError(f"{place}: {name} is a Boolean, true or false, not {brief(value)}")
        return bool(value)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
        raise ConfigError(f"{place}: {name} is a finite {variable.type} number, not {brief(value)}")
    if variable.type != "Real" and value != int(value):
        raise ConfigError(f"{place}: {name} is an {variable.type}, not {brief(value)}")
    found = float(value) if variable.type == "Real" else int(value)
    low, high = variable.limits or (-math.inf, math.inf)
    if not low <= found <= high:
        raise ConfigError(f"{place}: {brief(found)} is beyond the numbers of {name}, {low} to {high}")
    if variable.type == "Real" and isinstance(value, int):
        check_whole(value, variable, place)
    if variable.items and found not in [number for number, _ in variable.items]:
        raise ConfigError(f"{place}: {brief(found)} is no item of {name}: {_items(variable)}")
    return found


def check_whole(value: int, variable: VariableInfo, place: str) -> None:
    """Raise ConfigError, which starts with `place`, for a whole number that no value of a Real is.

    It names the two nearest. Of a decimal number, as 0.1, the nearest double is what is meant.
    """
    single = variable.limits is not None  # FMI 3.0's Float32: a double has no least and no greatest number
    held = float(np.float32(value)) if single else float(value)
    if int(held) != value:
        holder = "Float32" if single else "double"
        raise ConfigError(
            f"{place}: {variable.name} = {brief(value)} is no number that a {holder} holds exactly: "
            f"{_nearest(value, held, single)}"
        )


def _nearest(value: int, held: float, single: bool = False) -> str:
    """Return the two nearest numbers in words: `held`, and the one on the other side of `value`."""
    toward = math.inf if int(held) < value else -math.inf
    if single:
        other = float(np.nextafter(np.float32(held), np.float32(toward)))
    else:
        other = math.nextafter(held, toward)
    return f"the nearest are {' and '.join(brief(int(x)) for x in sorted((held, other)) if math.isfinite(x))}"


def _item(name: str, variable: VariableInfo, place: str) -> int:
    """Return the number of an enumeration's item. Raises ConfigError when there is no such item."""
    values = {text: number for number, text in variable.items}
    if name not in values:
        raise ConfigError(
            f"{place}: {variable.name} has no item '{name}'{nearest(name, values)}: {brief(list(values))}"
        )
    return values[name]


def _items(variable: VariableInfo) -> str:
    listed = [f"{number} {name}" for number, name in variable.items]
    return ", ".join([*listed[:_SHOWN_ITEMS], *(["..."] if len(listed) > _SHOWN_ITEMS else [])])


def as_double(variable: VariableInfo, value: Value, place: str, texts: Texts) -> float:
    """Return a value, in its variable's type, as the double in which a run keeps it: of a text, its number.

    Raises ConfigError, which starts with `place`, for a whole number beyond 2^53 that no double holds.
    """
    if isinstance(value, str):
        return texts.number(value)
    number = float(value)
    if isinstance(value, int) and int(number) != value:
        raise ConfigError(
            f"{place}: {variable.name} = {value} is more than a double, in which a run keeps its values, "
            f"holds exactly (2^53): {_nearest(value, number)}"
        )
    return number
