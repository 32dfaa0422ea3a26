"""The figure of a system that names none: signals that measure the same quantity together."""

from __future__ import annotations

import math

import numpy as np

from ..errors import ConfigError
from ..interface import Value
from ..results.results import Results, ResultVariable
from ..system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from ..units.definition import defined
from .check import panel_conversion
from .text import pretty

# Quantities that the units of this field measure, for axes that nobody has named.
_QUANTITIES = {
    "m/s": "speed",
    "km/h": "speed",
    "m/s2": "acceleration",
    "rad/s": "angular speed",
    "rpm": "angular speed",
    "rad": "angle",
    "deg": "angle",
    "rad/s2": "angular acceleration",
    "m": "distance",
    "km": "distance",
    "N": "force",
    "N.m": "torque",
    "W": "power",
    "kW": "power",
    "J": "energy",
    "Wh": "energy",
    "V": "voltage",
    "A": "current",
    "A.h": "charge",
    "K": "temperature",
    "degC": "temperature",
    "s": "time",
    "Hz": "frequency",
    "ohm": "resistance",
}

MAX_PANELS = 6
MAX_SIGNALS = 8
_BESIDE = 20.0  # how much larger than the others of its panel a constant may be


def default_spec(results: Results) -> FigureSpec:
    """Return a figure for any results: signals that measure the same quantity together.

    Inputs that repeat an output are left out (see `_repeats`), and the note has those of `_constant`. The
    enumeration that changes first shades the panels, the others have a panel. Of more than six panels or
    eight signals in one, those that change stay, outputs first, and the note names the others. Raises
    ConfigError without a variable.
    """
    shade = _shading(results)
    distinct = [v for v in _distinct(results) if v is not shade]
    constant = _constant(results, distinct)
    shown = [v for v in distinct if v not in constant]
    groups: dict[object, list[ResultVariable]] = {}
    for v in shown:
        groups.setdefault(_group(results, v), []).append(v)
    ranked = {
        key: sorted(group, key=lambda v: (not _changes(results, v), v.causality == "input"))
        for key, group in groups.items()
    }
    moving = sorted(ranked, key=lambda key: not _changes(results, ranked[key][0]))[:MAX_PANELS]
    chosen = [_panel(group[:MAX_SIGNALS]) for key, group in ranked.items() if key in moving]
    if not chosen and shade is not None:
        chosen, shade = [_panel([shade])], None
    if not chosen:
        texts = ": texts are not drawn" if results.texts else ""
        raise ConfigError(f"the results have no variable to draw{texts}")
    drawn = {signal.name for panel in chosen for signal in panel.signals}
    left_out = [v.name for v in shown if v.name not in drawn]
    final = results.final()
    note = _note("Constant", [_with_value(v, final[v.name]) for v in constant]), _note("Not shown", left_out)
    return FigureSpec(
        shade=shade.name if shade else None, panels=chosen, note="; ".join(filter(None, note)) or None
    )


def title_of(results: Results) -> str:
    """Return the names of the system and the scenario of a run, as far as its manifest says them."""
    parts = [results.manifest.get(key) for key in ("system", "scenario")]
    return " · ".join(part for part in parts if isinstance(part, str) and part)


def _note(about: str, texts: list[str]) -> str:
    """Return the texts, eight at most, with what they are about; "" for none."""
    more = f" and {len(texts) - 8} more" if len(texts) > 8 else ""
    return f"{about}: {', '.join(texts[:8])}{more}" if texts else ""


def _constant(results: Results, variables: list[ResultVariable]) -> list[ResultVariable]:
    """Return the inputs that never change and say no more than their value; none if all are such.

    One that stands beside something of the same quantity, as a bound beside a speed, is no such input: where
    it is not 0, and not so large that the other would be a line at 0.
    """
    still = [v for v in variables if v.causality == "input" and not _changes(results, v)]
    moving = [v for v in variables if v not in still]
    sizes: dict[object, float] = {}
    for v in moving if still else []:
        key = _group(results, v)
        sizes[key] = max(sizes.get(key, 0.0), _size(results, v))
    return [
        v
        for v in still
        if moving and not 0.0 < _size(results, v) <= _BESIDE * sizes.get(_group(results, v), 0.0)
    ]


def _size(results: Results, variable: ResultVariable) -> float:
    """Return the largest magnitude of a variable."""
    pieces = (values for _, values in results.pieces([variable.name]))
    return max((float(np.max(np.abs(values))) for values in pieces), default=0.0)


def _with_value(variable: ResultVariable, value: Value) -> str:
    items = (name for number, name in variable.items if number == value)
    shown = f"{value:g}" if isinstance(value, float) else next(items, str(value))
    return f"{variable.name} = {shown} {pretty(variable.unit)}".rstrip()


def _changes(results: Results, variable: ResultVariable) -> bool:
    pieces = (values for _, values in results.pieces([variable.name], overlap=1))
    return any(bool(np.any(values != values[0])) for values in pieces)


def _shading(results: Results) -> ResultVariable | None:
    candidates = [v for v in results.variables if v.items and _changes(results, v)]
    return min(candidates, key=lambda v: v.causality == "input", default=None)


def _distinct(results: Results) -> list[ResultVariable]:
    """Return all variables but parameters, the time, and inputs that repeat what another one shows."""
    wanted = [v for v in results.variables if "arameter" not in v.causality and v.causality != "independent"]
    kept = [v for v in wanted if v.causality != "input"]
    for v in wanted:
        if v.causality == "input" and not any(_repeats(results, v, other) for other in kept):
            kept.append(v)
    same_order = {v.name for v in kept}
    return [v for v in wanted if v.name in same_order and not _is_time(results, v)]


def _is_time(results: Results, variable: ResultVariable) -> bool:
    # an FMU may have added up its steps
    return variable.unit == "s" and all(
        np.allclose(values[:, 0], time, rtol=1e-12, atol=1e-9)
        for time, values in results.pieces([variable.name])
    )


def _repeats(results: Results, variable: ResultVariable, other: ResultVariable) -> bool:
    """Return whether two variables would draw the same line: they differ by 0.5 % (rms) of the range.

    The quantization of a throttle of 0.4 % is below that, that of a speed of 1 km/h above it.
    """
    if (variable.type == "Real") != (other.type == "Real") or variable.items != other.items:
        return False
    try:
        convert = panel_conversion(variable, other.unit, "figure")
    except ConfigError:
        return False
    low, high, equal, squares = math.inf, -math.inf, True, 0.0
    for _, values in results.pieces([variable.name, other.name]):
        with np.errstate(over="ignore", invalid="ignore"):  # infinite squares repeat nothing
            a, b = convert.scale * values[:, 0] + convert.offset, values[:, 1]
            low, high = min(low, float(np.min(b))), max(high, float(np.max(b)))
            equal = equal and np.array_equal(a, b)
            squares += float(np.sum((a - b) ** 2))
    return equal or (high > low and math.sqrt(squares / len(results)) <= 5e-3 * (high - low))


def _group(results: Results, variable: ResultVariable) -> object:
    """Return the key that variables in one panel share."""
    if variable.items:
        return variable.items
    if variable.type != "Real":
        return variable.type
    if variable.unit in ("", "1", "%"):
        # nothing says that bare numbers belong together, but a common size at least makes them readable
        size = _size(results, variable)
        decade = math.floor(math.log10(size)) if 0.0 < size < math.inf else 0
        return (variable.unit, decade if variable.unit == "" else 0)
    try:
        unit = defined(variable.unit)
    except ConfigError:
        return variable.unit
    return unit.exponents


def _panel(variables: list[ResultVariable]) -> PanelSpec:
    counts: dict[str, int] = {}
    for v in variables:
        counts[v.unit] = counts.get(v.unit, 0) + 1
    unit = max(counts, key=lambda name: counts[name])
    label = _QUANTITIES.get(unit, "")
    if not unit and len(variables) == 1:
        label = variables[0].name
    return PanelSpec(label=label, unit=unit, signals=[SignalSpec(name=v.name) for v in variables])
