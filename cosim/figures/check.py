"""Checks before a run that it records all that the figure and metrics of its system and scenario need."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..errors import ConfigError, nearest
from ..results import metrics
from ..results.results import ResultVariable
from ..system.figure_spec import FigureSpec
from ..system.scenario import Scenario
from ..system.selection import figure_spec, metric_specs
from ..system.system import System
from ..units.conversion import conversion
from ..units.definition import defined
from ..units.measure import Affine


def check(spec: FigureSpec, variables: Mapping[str, ResultVariable], place: str) -> None:
    """Check that a figure can be drawn from these variables; of a String there are no numbers.

    Raises ConfigError, which starts with `place`, that of the figure's table, and names the key.
    """
    for i, panel in enumerate(spec.panels, 1):
        for j, signal in enumerate(panel.signals, 1):
            here = f"{place}.panels {i}.signals {j}"
            panel_conversion(_known(signal.name, variables, here), panel.unit, here)
    if spec.until is not None:
        variable = _known(spec.until.signal, variables, f"{place}.until")
        panel_conversion(variable, spec.until.unit or variable.unit, f"{place}.until")
    if spec.shade is not None and not _known(spec.shade, variables, f"{place}.shade").items:
        raise ConfigError(f"{place}.shade: '{spec.shade}' is not an enumeration, so it has no states")


def _known(name: str, variables: Mapping[str, ResultVariable], place: str) -> ResultVariable:
    if name not in variables:
        raise ConfigError(f"{place}: no variable '{name}' is recorded{nearest(name, variables)}")
    if variables[name].type == "String":
        raise ConfigError(f"{place}: '{name}' is a String, which has no numbers to draw")
    return variables[name]


def panel_conversion(variable: ResultVariable, unit: str, place: str) -> Affine:
    """Return the map from the variable's unit to the panel's. Without a declared unit nothing is converted.

    Raises ConfigError naming `place` where they measure different quantities.
    """
    if variable.unit in ("", unit):
        return Affine()
    try:
        own = defined(variable.unit)
        difference = variable.difference or own.difference
        return conversion(own, defined(unit), (difference, difference))
    except ConfigError as error:
        signal = f"{place}: '{variable.name}' [{variable.unit}]"
        if not unit:
            raise ConfigError(f"{signal} stands in a panel without 'unit'") from error
        raise ConfigError(f"{signal} in [{unit}]: {error}") from error


def check_specs(system: System, scenario: Scenario, variables: Iterable[ResultVariable]) -> list[str]:
    """Check before the run what would be wrong after it: a figure or metric of what is not recorded.

    Return a sentence on what cannot be checked. Raises ConfigError naming the files.
    """
    recorded = {v.name: v for v in variables}
    places = [str(path) for path in (system.path, scenario.path) if path is not None]
    metrics.check(metric_specs(system, scenario), recorded, " with ".join(places))
    spec = figure_spec(system, scenario)
    if spec is not None:
        place = system.path if scenario.file.figure is None else scenario.path
        check(spec, recorded, f"{place}: figure")
        return _unit_unknown(spec, recorded, f"{place}: figure.until")
    return []


def _unit_unknown(spec: FigureSpec, recorded: Mapping[str, ResultVariable], place: str) -> list[str]:
    """Return a sentence on an end of the axis whose value has a unit of measure that its signal lacks."""
    end = spec.until
    if end is None or not end.unit or recorded[end.signal].unit:
        return []
    value = f"{end.below:g} {end.unit}"
    return [f"{place}: '{end.signal}' declares no unit of measure; {value} is compared with its bare numbers"]
