"""The variables that a model shows to FMI, in one fixed order: the index is the value reference.

Parameters come first, then inputs (the independent variable among them), then outputs, each as declared. The
slave and the model description both read this list, so they cannot disagree.
"""

from __future__ import annotations

from typing import NamedTuple

from ..models.base import Model, Variable, variables


class Exposed(NamedTuple):
    """A variable with its value reference; `causality` is FMI's word."""

    reference: int
    causality: str
    variable: Variable


def exposed(model: type[Model]) -> tuple[Exposed, ...]:
    """Return every parameter, input and output of a model; element k has value reference k."""
    declared = [("parameter", v) for v in variables(model.Parameters)]
    declared += [("independent" if v.independent else "input", v) for v in variables(model.Inputs)]
    declared += [("output", v) for v in variables(model.Outputs)]
    return tuple(Exposed(k, causality, v) for k, (causality, v) in enumerate(declared))
