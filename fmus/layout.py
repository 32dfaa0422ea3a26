"""The interface of one model as tables: which values are read, set, taken and converted, and how."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable
from typing import Any

from ..models.base import Model, Variable
from .interface import exposed
from .messages import Refused

_KINDS = ("Real", "Integer", "Boolean", "String")  # a model has no String, but an importer may ask
_CAUSALITIES = ("parameter", "input", "independent", "output")


class Layout:
    """What the slave of one model looks up instead of reflecting on each call."""

    def __init__(self, model: type[Model]) -> None:
        variables = exposed(model)
        self.starts = [v.start for _, _, v in variables]
        self.parameters = _span(r for r, causality, _ in variables if causality == "parameter")
        self.inputs = _span(r for r, causality, _ in variables if causality in ("input", "independent"))
        self.outputs = _span(r for r, causality, _ in variables if causality == "output")
        self.time = next((r for r, causality, _ in variables if causality == "independent"), None)
        self.variables = [v for _, _, v in variables]

        self.causalities = [causality for _, causality, _ in variables]
        self.readable = {kind: self._of(kind, *_CAUSALITIES) for kind in _KINDS}
        self.settable_first = {kind: self._of(kind, "parameter", "input") for kind in _KINDS}
        self.settable_later = {kind: self._of(kind, "input") for kind in _KINDS}
        self.enumerations = {r: v.enumeration for r, _, v in variables if v.enumeration is not None}

        outputs = [v for _, causality, v in variables if causality == "output"]
        self.take = _taker([v.name for v in outputs])
        self.converters = [_converter(v) for v in outputs]
        self.all_real = all(v.type == "Real" for v in outputs)
        self.feeds_through = model.feeds_through()
        self.follows_inputs = self.feeds_through and not model.sampled

    def _of(self, kind: str, *causalities: str) -> frozenset[int]:
        """The value references that the FMI functions of a type and these causalities share."""
        found = enumerate(zip(self.variables, self.causalities, strict=True))
        return frozenset(r for r, (v, causality) in found if _storage(v) == kind and causality in causalities)


def _span(references: Iterable[int]) -> slice:
    numbers = list(references)
    return slice(numbers[0], numbers[-1] + 1) if numbers else slice(0, 0)


def _storage(v: Variable) -> str:
    """The FMI functions that read and write a variable: enumerations are accessed as Integer."""
    return "Integer" if v.type == "Enumeration" else v.type


def _taker(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    if len(names) > 1:
        take: Callable[[Any], tuple[Any, ...]] = operator.attrgetter(*names)
        return take
    return lambda record: tuple(getattr(record, name) for name in names)


def _converter(v: Variable) -> Callable[[Any], Any]:
    """The native library reads plain Python numbers, and does not check that it got one."""
    converters: dict[str, Callable[[Any], Any]]
    converters = {"Real": float, "Boolean": bool, "Integer": _int32, "Enumeration": _int32}
    return converters[v.type]


def _int32(value: Any) -> int:
    number = operator.index(value)
    if not -(2**31) <= number < 2**31:
        raise OverflowError(f"{number} does not fit an FMI Integer")
    return number


def misfit(layout: Layout, values: tuple[Any, ...]) -> Refused:
    """The refusal that names which of the outputs has a value that its FMI type cannot hold."""
    outputs = layout.variables[layout.outputs]
    for v, convert, value in zip(outputs, layout.converters, values, strict=True):
        try:
            convert(value)
        except (TypeError, ValueError, OverflowError):
            return Refused(f"output {v.name} is {value!r}, which is no {v.type}")
    return Refused(f"the model gave {len(values)} outputs instead of {len(outputs)}")
