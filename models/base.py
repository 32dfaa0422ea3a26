"""Declaration of a model: four records of variables and pure functions over them.

A model is a difference equation with parameters p, inputs u, state x and outputs y. With the
communication points t_k = t_0 + k dt it reads

    x_0     = initial(p, u_0)
    x_{k+1} = step(p, x_k, u_k, dt)         the inputs are held over [t_k, t_k + dt)
    y_k     = outputs(p, x_k[, u_k])        the outputs at t_k

A model whose `outputs(p, x)` takes no `u` has no direct feedthrough. Where it takes `u`, each output that an
input reaches at the same instant names these inputs in `depends`.

A sampled model (`sampled = True`, a controller) computes in the step at t_k from the inputs at t_k, and
its outputs hold from t_k on: y = outputs(p, step(p, x_k, u_k, dt)). They are FMI variables of variability
`discrete`. The outputs of any other model are `continuous`: those after the step belong to t_k + dt.

A variable is declared once, on one line:

    mass: float = var(200.0, "kg", "Vehicle and rider", min=1.0)

A model may have a fourth function, `notice`, for what its user must know of though nothing failed.

The record in which it stands gives its causality, the type of its start value its FMI type. Everything else
that shows the variable (model description, tables, range checks) is generated from that line.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import inspect
import math
from collections.abc import Callable
from typing import Any, ClassVar, TypeVar, dataclass_transform

_KEY = "evcosim"
_HASH = "kept hash"  # a name that no field has
_T = TypeVar("_T")
_EnumType = type[enum.IntEnum]  # named here, because inside Variable the name `type` is a field


@dataclasses.dataclass(frozen=True)
class Variable:
    """One declared variable of a record.

    `type` is the FMI 2.0 type name: Real, Integer, Boolean or Enumeration. `unit` is a unit name of
    measure ("" where none applies). `depends` are the inputs that reach this output within one instant;
    `initially` those that reach it during initialization (None: the inputs that the model's `initial` reads).
    """

    name: str
    type: str
    start: Any
    unit: str
    description: str
    min: float | None = None
    max: float | None = None
    nominal: float | None = None
    depends: tuple[str, ...] = ()
    initially: tuple[str, ...] | None = None
    independent: bool = False

    @property
    def enumeration(self) -> _EnumType | None:
        """The enumeration type of an Enumeration variable, else None."""
        return self.start.__class__ if isinstance(self.start, enum.IntEnum) else None


def var(
    start: float | int | bool | enum.IntEnum,
    unit: str,
    description: str,
    *,
    min: float | None = None,
    max: float | None = None,
    nominal: float | None = None,
    depends: tuple[str, ...] = (),
    initially: tuple[str, ...] | None = None,
) -> Any:
    """Declare a variable: its start value, unit of measure ("" for none) and meaning, then its range."""
    about = {
        "unit": unit,
        "description": description,
        "min": min,
        "max": max,
        "nominal": nominal,
        "depends": depends,
        "initially": initially,
    }
    return dataclasses.field(default=start, metadata={_KEY: about})


def time() -> Any:
    """Declare the independent variable [s]: among the inputs, it holds t_k in the step that starts at t_k."""
    about = {"unit": "s", "description": "Time at the start of the step", "independent": True}
    return dataclasses.field(default=0.0, metadata={_KEY: about})


@dataclass_transform(frozen_default=True)
def record(cls: type[_T]) -> type[_T]:
    """Make a frozen record of declared variables, with slots.

    A record that extends another, or that has a cached property, as Parameters may, has no slots.
    """
    cached = any(isinstance(value, functools.cached_property) for value in vars(cls).values())
    if cached or cls.__bases__ != (object,):
        made = dataclasses.dataclass(frozen=True)(cls)
        _put_new(made, lambda cls, *_, **__: object.__new__(cls))
        _keep_hash(made)
        return made
    return _quick(dataclasses.dataclass(frozen=True, slots=True)(cls))


def _quick(made: type[_T]) -> type[_T]:
    """Return a slotted record class whose objects are made in 40 % of the time.

    The `__init__` of a frozen dataclass writes its fields by a call for each of them. Here `__new__` writes
    them to an object of a class that has the same slots and is not frozen, and then makes the object one of
    the record's class.
    """
    slow = vars(made)["__init__"]
    names = list(vars(made)["__dataclass_fields__"])
    lines = ["it = new(draft)", *(f"it.{name} = {name}" for name in names), "it.__class__ = cls", "return it"]
    scope: dict[str, Any] = {"new": object.__new__, "draft": type(made.__name__, (), {"__slots__": names})}
    exec(f"def __new__(cls, {', '.join(names)}):\n    " + "\n    ".join(lines), scope)
    functools.update_wrapper(scope["__new__"], slow)
    scope["__new__"].__defaults__ = slow.__defaults__
    _put_new(made, scope["__new__"])
    delattr(made, "__init__")
    return made


def _keep_hash(made: type) -> None:
    """Let each object keep its hash, as it keeps its cached properties: functions with `lru_cache` ask.

    It is not pickled, since in another process the hash of an enumeration is another. A record that extends
    one with slots has the state of a dataclass with slots: its fields.
    """
    compute = vars(made)["__hash__"]

    def kept(self: Any) -> int:
        values: dict[str, Any] = self.__dict__
        if _HASH not in values:
            values[_HASH] = compute(self)
        found: int = values[_HASH]
        return found

    def state(self: Any) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != _HASH}

    setattr(made, "__hash__", kept)  # noqa: B010 - mypy allows no assignment to a method
    if getattr(made, "__getstate__") is getattr(object, "__getstate__"):  # noqa: B009 - as above; else of fields
        setattr(made, "__getstate__", state)  # noqa: B010 - as above


def _put_new(made: type, function: Callable[..., Any]) -> None:
    setattr(made, "__new__", function)  # noqa: B010 - mypy allows no assignment to a method


def variables(record_type: type) -> tuple[Variable, ...]:
    """Return the declared variables of a record, in the order of their declaration.

    Raises TypeError for a field that `var` does not declare.
    """
    for f in dataclasses.fields(record_type):
        if _KEY not in f.metadata:
            raise TypeError(f"{record_type.__qualname__}.{f.name}: write var(start, unit, description)")
    return tuple(
        Variable(name=f.name, type=_fmi_type(f.default), start=f.default, **f.metadata[_KEY])
        for f in dataclasses.fields(record_type)
    )


def _fmi_type(start: Any) -> str:
    if isinstance(start, enum.IntEnum):
        return "Enumeration"
    if isinstance(start, bool):
        return "Boolean"
    if isinstance(start, int):
        return "Integer"
    if isinstance(start, float):
        return "Real"
    raise TypeError(f"a start value must be a float, int, bool or IntEnum, not {start!r}")


def violations(values: Any) -> list[str]:
    """Return a sentence for each variable of a record that is out of range: name, rule and values."""
    found = []
    for v in variables(type(values)):
        value = getattr(values, v.name)
        unit = f" {v.unit}" if v.unit else ""
        if not math.isfinite(value):
            found.append(f"{v.name} = {value} is not a finite number")
        elif v.min is not None and value < v.min:
            found.append(f"{v.name} = {value}{unit} is below its minimum {v.min}{unit}")
        elif v.max is not None and value > v.max:
            found.append(f"{v.name} = {value}{unit} is above its maximum {v.max}{unit}")
    return found


class Model:
    """Base of every model. A subclass writes the four records and the three functions.

    `sampled`: the outputs are those of a sampled controller (module docstring). `initial_inputs`: the
    inputs that `initial` reads, so that an importer knows what must be known before the start.
    Raises TypeError when a declaration contradicts itself.
    """

    sampled: ClassVar[bool] = False
    initial_inputs: ClassVar[tuple[str, ...]] = ()

    Parameters: ClassVar[type]
    Inputs: ClassVar[type]
    State: ClassVar[type]
    Outputs: ClassVar[type]

    initial: ClassVar[Callable[..., Any]]
    step: ClassVar[Callable[..., Any]]
    outputs: ClassVar[Callable[..., Any]]

    notice: ClassVar[Callable[..., str] | None] = None
    """`notice(p, x_k, x_{k+1}, u)` returns a sentence when a step met what its user must know of, else "".

    Each sentence is a warning in the importer's log, once, with the time of the end of the step."""

    def __init_subclass__(cls) -> None:
        _check_declaration(cls)

    @classmethod
    def feeds_through(cls) -> bool:
        """Return True if `outputs` takes the inputs: some output depends on an input at the same instant."""
        return len(inspect.signature(cls.outputs).parameters) == 3


_RECORDS = ("Parameters", "Inputs", "State", "Outputs")
_FUNCTIONS = ("initial(p, u)", "step(p, x, u, dt)", "outputs(p, x)")


def _check_parts(model: type[Model]) -> None:
    """Raise TypeError for a model that lacks a record or a function."""
    for part in _RECORDS:
        if not dataclasses.is_dataclass(getattr(model, part, None)):
            lacks = f"{part} lacks its '@record'" if hasattr(model, part) else f"there is no record {part}"
            raise TypeError(f"{model.__name__}: {lacks}; a record without variables says 'pass'")
    for function in _FUNCTIONS:
        if not hasattr(model, function.partition("(")[0]):
            raise TypeError(f"{model.__name__}: there is no function {function}")


def _check_declaration(model: type[Model]) -> None:
    _check_parts(model)
    names: dict[str, str] = {}
    for part in ("Parameters", "Inputs", "Outputs"):
        for v in variables(getattr(model, part)):
            if v.name in names:
                raise TypeError(
                    f"{model.__name__}: {v.name} is declared twice, in {names[v.name]} and in {part}: an FMU "
                    "has one variable of a name, parameter, input or output"
                )
            names[v.name] = part
    inputs = {v.name for v in variables(model.Inputs)}
    outputs = variables(model.Outputs)
    for v in outputs:
        for name in (*v.depends, *(v.initially or ())):
            if name not in inputs:
                raise TypeError(f"{model.__name__}.{v.name} depends on {name}, which is no input")
    if unknown := set(model.initial_inputs) - inputs:
        raise TypeError(f"{model.__name__}.initial_inputs names {sorted(unknown)}, which are no inputs")
    if model.feeds_through() != any(v.depends for v in outputs):
        raise TypeError(
            f"{model.__name__}: outputs() takes the inputs if, and only if, an output declares `depends`"
        )
