"""The end of a figure's time axis, before that of the run."""

from __future__ import annotations

from ..results.results import Results
from ..system.figure_spec import EndSpec
from .check import panel_conversion


def until(results: Results, spec: EndSpec | None) -> Results:
    """Return the rows before the one in which the signal is first at or below its value; all if it never is.

    A run that begins there, or comes there in its first step, has no stretch of time before it: all of it is
    returned too. Raises ConfigError as
    `panel_conversion` does.
    """
    if spec is None:
        return results
    variable = results.variable(spec.signal)
    scaled = panel_conversion(variable, spec.unit or variable.unit, "figure.until")
    low = scaled.scale * results.column(spec.signal) + scaled.offset <= spec.below
    end = int(low.argmax())
    if not low.any() or end < 2:
        return results
    return results.part(slice(0, end), [*results.names, *results.texts])
