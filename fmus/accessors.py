"""Access of the slave to the values of one model: readers, settable references, and maker of its records.

Value references count parameters, then inputs (time among them), then outputs. An instance of the slave
keeps the values in the lists `_settings` (parameters), `_given` (inputs without the time) and `_shown`
(outputs), and in `_time`. The functions that each step calls are compiled once from source text that names
every variable: a loop over names takes three times as long.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable
from typing import Any

from ..models.base import Model, Variable
from .interface import exposed
from .messages import Refused

_KINDS = ("Real", "Integer", "Boolean", "String")  # a model has no String, but an importer may ask
_MOST_LISTS = 256  # readers kept at most, so that an importer with ever new lists fills no memory
_CAUSALITIES = ("parameter", "input", "independent", "output")

Reader = Callable[[Any], list[Any]]
"""Returns from an instance the values of one list of references."""


class Accessors:
    """Tables and functions of one model's variables, made once: no call of the slave inspects the model.

    `record(given, time)` makes the record of the inputs, `listed(y)` the list of the outputs as plain Python
    numbers. `real_inputs` and `real_outputs` are the value references of all inputs (without the time) and of
    all outputs where all are Real, else None. `index` maps a value reference to its place in its list.
    """

    def __init__(self, model: type[Model]) -> None:
        variables = exposed(model)
        self.variables = [v for _, _, v in variables]
        self.causalities = [causality for _, causality, _ in variables]
        self.enumerations = {r: v.enumeration for r, _, v in variables if v.enumeration is not None}
        self.timed = "independent" in self.causalities
        parameters, inputs, outputs = (self._all(c) for c in ("parameter", "input", "output"))
        self.index = {r: i for group in (parameters, inputs, outputs) for i, r in enumerate(group)}
        self.first_input = len(parameters)
        self.outputs = [self.variables[r] for r in outputs]

        # one attribute for each FMI function: a step reads and writes several times
        self.read_real, self.read_integer = Readers(self, "Real"), Readers(self, "Integer")
        self.read_boolean, self.read_string = Readers(self, "Boolean"), Readers(self, "String")
        self.settable_first = {kind: self.of(kind, ("parameter", "input")) for kind in _KINDS}
        self.settable_later = {kind: self.of(kind, ("input",)) for kind in _KINDS}
        reals = self.of("Real")
        self.real_inputs = inputs if reals.issuperset(inputs) else None
        self.real_outputs = outputs if reals.issuperset(outputs) else None

        self.record = self._recorder(model.Inputs)
        self.listed = _lister(self.outputs)
        self.feeds_through = model.feeds_through()
        self.follows_inputs = self.feeds_through and not model.sampled

    def starts(self, causality: str) -> list[Any]:
        """Return the start values of all variables of a causality."""
        return [self.variables[r].start for r in self._all(causality)]

    def of(self, kind: str, causalities: Iterable[str] = _CAUSALITIES) -> frozenset[int]:
        """Return the value references with these causalities that the FMI functions of a type access."""
        found = enumerate(zip(self.variables, self.causalities, strict=True))
        return frozenset(r for r, (v, causality) in found if _storage(v) == kind and causality in causalities)

    def refusal(self, kind: str, references: Iterable[int], settable: frozenset[int]) -> Refused:
        """Return the exception for references of which not all are `settable`."""
        wrong = set(references) - settable
        if unknown := wrong - self.of(kind):
            return _unknown(kind, unknown)
        name = self.variables[min(wrong)].name
        if self.causalities[min(wrong)] == "parameter":
            return Refused(f"{name} is a fixed parameter: it cannot be set after the initialization")
        return Refused(f"{name} is neither parameter nor input: it cannot be set")

    def _all(self, causality: str) -> list[int]:
        return [r for r, c in enumerate(self.causalities) if c == causality]

    def _recorder(self, inputs: type) -> Callable[[list[Any], float], Any]:
        """Return `Inputs(given[0], time, given[1], ...)` as a function, in the order of the fields."""
        items = [
            "time" if causality == "independent" else f"given[{self.index[r]}]"
            for r, causality in enumerate(self.causalities)
            if causality in ("input", "independent")
        ]
        made: Callable[[list[Any], float], Any]
        made = eval(f"lambda given, time: Inputs({', '.join(items)})", {"Inputs": inputs})
        return made


class Readers(dict[tuple[int, ...], Reader]):
    """The readers of one FMI type, `kind`, by list of references; each is made at its first use.

    A look-up raises Refused for references that are not of that type.
    """

    _LISTS = {"parameter": "_settings", "input": "_given", "output": "_shown"}

    def __init__(self, accessors: Accessors, kind: str) -> None:
        super().__init__()
        self._accessors, self._kind, self._known = accessors, kind, accessors.of(kind)

    def __missing__(self, references: tuple[int, ...]) -> Reader:
        if not self._known.issuperset(references):
            raise _unknown(self._kind, set(references) - self._known)
        if len(self) >= _MOST_LISTS:
            self.clear()
        reader: Reader = eval(f"lambda slave: [{', '.join(map(self._place, references))}]")
        self[references] = reader
        return reader

    def _place(self, reference: int) -> str:
        causality = self._accessors.causalities[reference]
        if causality == "independent":
            return "slave._time"
        return f"slave.{self._LISTS[causality]}[{self._accessors.index[reference]}]"


def _unknown(kind: str, references: Iterable[int]) -> Refused:
    return Refused(
        f"there is no {kind} variable with value reference {', '.join(map(str, sorted(references)))}"
    )


def _storage(v: Variable) -> str:
    """Return the type of the FMI functions that access a variable: Integer for enumerations."""
    return "Integer" if v.type == "Enumeration" else v.type


def _int32(value: Any) -> int:
    number = operator.index(value)
    if not -(2**31) <= number < 2**31:
        raise OverflowError(f"{number} does not fit an FMI Integer")
    return number


# The native library reads plain Python numbers, and does not check that it got one.
_CONVERTERS: dict[str, Callable[[Any], Any]]
_CONVERTERS = {"Real": float, "Boolean": bool, "Integer": _int32, "Enumeration": _int32}


def _lister(outputs: list[Variable]) -> Callable[[Any], list[Any]]:
    """Return `[Real(y.speed), Enumeration(y.state), ...]` as a function; a type names its converter."""
    items = ", ".join(f"{v.type}(y.{v.name})" for v in outputs)
    listed: Callable[[Any], list[Any]] = eval(f"lambda y: [{items}]", dict(_CONVERTERS))
    return listed


def misfit(outputs: Iterable[Variable], y: Any) -> Refused:
    """Return the exception that names the output whose value in y its FMI type cannot hold."""
    for v in outputs:
        value = getattr(y, v.name)
        try:
            _CONVERTERS[v.type](value)
        except (TypeError, ValueError, OverflowError):
            return Refused(f"output {v.name} is {value!r}, which is no {v.type}")
    return Refused(f"{y!r} is no record of outputs")
