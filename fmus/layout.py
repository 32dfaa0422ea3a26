"""The interface of one model as tables: which values are read, set, taken and converted, and how."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from ..models.base import Model, Variable
from .interface import exposed
from .messages import Refused

_KINDS = ("Real", "Integer", "Boolean", "String")  # a model has no String, but an importer may ask
_T = TypeVar("_T")
_MOST_PLACES = 256  # an importer asks for few lists of references; one that asks for many costs no memory
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
        self.timed = self.time is not None
        self.variables = [v for _, _, v in variables]

        self.causalities = [causality for _, causality, _ in variables]
        # one attribute for each FMI function: a step reads and writes several times
        self.read_real, self.read_integer = Readers(self, "Real"), Readers(self, "Integer")
        self.read_boolean, self.read_string = Readers(self, "Boolean"), Readers(self, "String")
        self.settable_first = {kind: Places(self, kind, ("parameter", "input")) for kind in _KINDS}
        self.settable_later = {kind: Places(self, kind, ("input",)) for kind in _KINDS}
        self.enumerations = {r: v.enumeration for r, _, v in variables if v.enumeration is not None}

        outputs = [v for _, causality, v in variables if causality == "output"]
        self.take = _taker([v.name for v in outputs])
        self.converters = [_converter(v) for v in outputs]
        self.all_real = all(v.type == "Real" for v in outputs)
        self.feeds_through = model.feeds_through()
        self.follows_inputs = self.feeds_through and not model.sampled

    def of(self, kind: str, causalities: Iterable[str] = _CAUSALITIES) -> frozenset[int]:
        """The value references that the FMI functions of a type and these causalities share."""
        found = enumerate(zip(self.variables, self.causalities, strict=True))
        return frozenset(r for r, (v, causality) in found if _storage(v) == kind and causality in causalities)


class Places(dict[tuple[int, ...], slice | None]):
    """Where the values of a call's references stand, looked up once for each list of references.

    A slice where they follow each other, as they do in the calls of a step; None where they do not.
    Raises Refused for references that are not of the FMI type `kind` and one of the `causalities`.
    """

    def __init__(self, layout: Layout, kind: str, causalities: tuple[str, ...]) -> None:
        super().__init__()
        self._layout, self._kind = layout, kind
        self._known = layout.of(kind, causalities)

    def __missing__(self, references: tuple[int, ...]) -> slice | None:
        if not self._known.issuperset(references):
            raise self._refusal(set(references) - self._known)
        return _remember(self, references, _slice(references))

    def _refusal(self, references: set[int]) -> Refused:
        if unknown := references - self._layout.of(self._kind):
            return _unknown(self._kind, unknown)
        reference = min(references)
        name = self._layout.variables[reference].name
        if self._layout.causalities[reference] == "parameter":
            return Refused(f"{name} is a fixed parameter: it cannot be set after the initialization")
        return Refused(f"{name} is neither parameter nor input: it cannot be set")


class Readers(dict[tuple[int, ...], Callable[[list[Any]], list[Any]]]):
    """What takes the values of a call's references from those of all variables, made once for each list of
    references. Raises Refused for references that are not of the FMI type `kind`."""

    def __init__(self, layout: Layout, kind: str) -> None:
        super().__init__()
        self._kind = kind
        self._known = layout.of(kind)

    def __missing__(self, references: tuple[int, ...]) -> Callable[[list[Any]], list[Any]]:
        if not self._known.issuperset(references):
            raise _unknown(self._kind, set(references) - self._known)
        place = _slice(references)
        take: Callable[[list[Any]], list[Any]] = (
            operator.itemgetter(place)
            if place is not None
            else lambda values: [values[r] for r in references]
        )
        return _remember(self, references, take)


def _slice(references: tuple[int, ...]) -> slice | None:
    first = references[0] if references else 0
    place = slice(first, first + len(references))
    return place if references == tuple(range(place.start, place.stop)) else None


def _remember(table: dict[tuple[int, ...], _T], references: tuple[int, ...], value: _T) -> _T:
    if len(table) >= _MOST_PLACES:
        table.clear()
    table[references] = value
    return value


def _unknown(kind: str, references: Iterable[int]) -> Refused:
    return Refused(
        f"there is no {kind} variable with value reference {', '.join(map(str, sorted(references)))}"
    )


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
