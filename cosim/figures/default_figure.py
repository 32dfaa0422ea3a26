"""The figure of a system that names none: signals that measure the same quantity together."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..errors import ConfigError
from ..interface import Value
from ..results.results import Results, ResultVariable
from ..system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from ..units.definition import defined
from .outlines import Outlines, kind
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

    Inputs that repeat an output are left out (see `Outlines.repeats`), and the note has those of `_constant`.
    The enumeration that changes first shades the panels, the others have a panel. Of more than six panels or
    eight signals in one, those that change stay, outputs first, and the note names the others. Raises
    ConfigError without a variable.
    """
    outlines = Outlines(results)
    shade = _shading(results, outlines)
    distinct = [v for v in _distinct(results, outlines) if v is not shade]
    constant = _constant(outlines, distinct)
    shown = [v for v in distinct if v not in constant]
    groups: dict[object, list[ResultVariable]] = {}
    for v in shown:
        groups.setdefault(_group(outlines, v), []).append(v)
    ranked = {
        key: sorted(group, key=lambda v: (not outlines.changes(v), v.causality == "input"))
        for key, group in groups.items()
    }
    moving = sorted(ranked, key=lambda key: not outlines.changes(ranked[key][0]))[:MAX_PANELS]
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


def _constant(outlines: Outlines, variables: list[ResultVariable]) -> list[ResultVariable]:
    """Return the inputs that never change and say no more than their value; none if all are such.

    One that stands beside something of the same quantity, as a bound beside a speed, is no such input: where
    it is not 0, and not so large that the other would be a line at 0.
    """
    still = [v for v in variables if v.causality == "input" and not outlines.changes(v)]
    moving = [v for v in variables if v not in still]
    sizes: dict[object, float] = {}
    for v in moving if still else []:
        key = _group(outlines, v)
        sizes[key] = max(sizes.get(key, 0.0), outlines.size(v))
    return [
        v
        for v in still
        if moving and not 0.0 < outlines.size(v) <= _BESIDE * sizes.get(_group(outlines, v), 0.0)
    ]


def _with_value(variable: ResultVariable, value: Value) -> str:
    items = (name for number, name in variable.items if number == value)
    shown = f"{value:g}" if isinstance(value, float) else next(items, str(value))
    return f"{variable.name} = {shown} {pretty(variable.unit)}".rstrip()


def _shading(results: Results, outlines: Outlines) -> ResultVariable | None:
    candidates = [v for v in results.variables if v.items and outlines.changes(v)]
    return min(candidates, key=lambda v: v.causality == "input", default=None)


def _distinct(results: Results, outlines: Outlines) -> list[ResultVariable]:
    """Return all variables but parameters, the time, and inputs that repeat what another one shows."""
    wanted = [v for v in results.variables if "arameter" not in v.causality and v.causality != "independent"]
    kept: dict[object, list[ResultVariable]] = {}
    for v in wanted:
        if v.causality != "input":
            kept.setdefault(kind(v), []).append(v)
    for v in wanted:
        alike = [some for some in kept.values() if kind(some[0])[:2] == kind(v)[:2]]
        if v.causality == "input" and not any(outlines.repeats(v, some) for some in alike):
            kept.setdefault(kind(v), []).append(v)
    same_order = {v.name for some in kept.values() for v in some}
    return [v for v in wanted if v.name in same_order and not _is_time(results, v)]


def _is_time(results: Results, variable: ResultVariable) -> bool:
    # an FMU may have added up its steps
    return variable.unit == "s" and all(
        np.allclose(values[:, 0], time, rtol=1e-12, atol=1e-9)
        for time, values in results.pieces([variable.name])
    )


def _group(outlines: Outlines, variable: ResultVariable) -> object:
    """Return the key that variables in one panel share."""
    if variable.items:
        return variable.items
    if variable.type != "Real":
        return variable.type
    if variable.unit in ("", "1", "%"):
        # nothing says that bare numbers belong together, but a common size at least makes them readable
        size = outlines.size(variable)
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


def spec_of(results: Results, names: Sequence[str]) -> FigureSpec:
    """Return a figure of some variables, all of them, those that measure the same quantity in one panel.

    Raises ConfigError without a name, and naming the nearest one for a name that there is not.
    """
    if not names:
        raise ConfigError("no signal to draw is named")
    outlines = Outlines(results)
    groups: dict[object, list[ResultVariable]] = {}
    for name in dict.fromkeys(names):
        variable = results.variable(name)
        groups.setdefault(_group(outlines, variable), []).append(variable)
    return FigureSpec(panels=[_panel(group) for group in groups.values()])
