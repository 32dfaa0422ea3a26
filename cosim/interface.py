"""The interface of a unit to the others: its variables, as an FMU's model description declares them."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Collection, Iterable
from fnmatch import fnmatchcase
from typing import Literal

from .errors import ConfigError, nearest
from .units.measure import Affine, UnitOfMeasure

Value = bool | int | float | str
InterfaceType = Literal["co_simulation", "model_exchange"]


@dataclasses.dataclass(frozen=True)
class VariableInfo:
    """One variable of a unit.

    `type` is Real, Integer, Boolean, Enumeration or String; `start`, `min`, `max` are in `unit` (a name; ""
    where none is declared).
    `depends` are the names of the inputs (for `depends_initially` also parameters) that reach an output
    at the same instant; None: not declared, so every input may.
    `items` are the (value, name) pairs of an enumeration; `limits` the least and the greatest number of the
    variable's FMI type, None for one that has all of a double.
    `initial` is "exact" or "approx" where the value before the first step is given and not computed: that of
    the variable itself, or a guess of it.
    `declared` is the FMU's own name of a variable that the system knows under another one ("": the same);
    `inverted`: the system's value is the FMU's with the other sign.
    `scaling` is the map of a value on its way between the two, beside the sign.
    `sampled`: an output that the unit computes at t_k from the inputs at t_k, and that holds from t_k on.
    `difference`: it is one of two absolute quantities (FMI: relativeQuantity), so that no offset converts it.
    """

    name: str
    type: str = "Real"
    causality: str = "local"
    variability: str = "continuous"
    unit: str = ""
    start: float | int | bool | str | None = None
    min: float | None = None
    max: float | None = None
    description: str = ""
    items: tuple[tuple[int, str], ...] = ()
    limits: tuple[float, float] | None = None
    depends: tuple[str, ...] | None = ()
    depends_initially: tuple[str, ...] | None = ()
    initial: str = ""
    declared: str = ""
    inverted: bool = False
    difference: bool = False
    sampled: bool = False
    scaling: Affine = Affine()  # noqa: RUF009 - Affine is frozen, so a shared default is safe

    @property
    def declared_name(self) -> str:
        """The name that the FMU itself declares."""
        return self.declared or self.name

    @property
    def to_fmu(self) -> Affine:
        """The map from the system's value to the FMU's."""
        sign = -1.0 if self.inverted else 1.0
        map_ = self.scaling if self.causality in ("input", "parameter") else self.scaling.inverse()
        return Affine(sign) if self.scaling.identity else Affine(sign * map_.scale, sign * map_.offset)

    @property
    def from_fmu(self) -> Affine:
        """The map from the FMU's value to the system's."""
        sign = -1.0 if self.inverted else 1.0
        map_ = self.scaling.inverse() if self.causality in ("input", "parameter") else self.scaling
        return Affine(sign) if self.scaling.identity else Affine(sign * map_.scale, map_.offset)

    @functools.cached_property
    def choices(self) -> tuple[int, ...]:
        """The numbers that an enumeration may have, in order: its items', and its start; (): all whole ones.

        A start that is no item is a defect of the FMU, which takes it all the same.
        """
        if not self.items:
            return ()
        own = {self.start} if isinstance(self.start, int) else set()
        return tuple(sorted({number for number, _ in self.items} | own))

    @property
    def default(self) -> Value:
        """The start value, else 0, false, "" or the first item of an enumeration without 0."""
        if self.start is not None:
            return self.start
        if self.type == "String":
            return ""
        return 0 if not self.choices or 0 in self.choices else self.choices[0]

    @property
    def takes_start(self) -> bool:
        """True of an input, and of a local variable or output whose initial value, or a guess, is given."""
        given = self.initial in ("exact", "approx") and self.variability != "constant"
        return self.causality == "input" or (self.causality in ("local", "output") and given)


def fitting(pattern: str, names: Collection[str]) -> list[str]:
    """Return the names that a pattern fits, in their order: the one that it is, else those it describes.

    Brackets are choices of characters, or, where no name fits so, those of a name, as in `a.x[*]`.
    """
    if pattern in names:
        return [pattern]
    for each in (pattern, pattern.replace("[", "[[]")):
        if fits := [name for name in names if fnmatchcase(name, each)]:
            return fits
    return []


@dataclasses.dataclass(frozen=True)
class UnitInterface:
    """The variables of a unit by name, and the units of measure that it defines by name.

    `place` names the file of the description for error messages. `unusable` are declared variables that
    cannot be used, with the reason. `tells_sampled`: the description says which outputs are sampled; `ours`:
    evcosim built the FMU.
    """

    place: str
    variables: dict[str, VariableInfo]
    units_of_measure: dict[str, UnitOfMeasure] = dataclasses.field(default_factory=dict)
    unusable: dict[str, str] = dataclasses.field(default_factory=dict)
    tells_sampled: bool = False
    ours: bool = False

    def of_causality(self, *causalities: str) -> tuple[VariableInfo, ...]:
        """Return the variables of these causalities, in declared order."""
        return tuple(v for v in self.variables.values() if v.causality in causalities)

    def require(self, unit: str, name: str, causalities: Iterable[str], place: str) -> VariableInfo:
        """Return the variable `name`, which must be of one of the causalities.

        Raises ConfigError naming `place`, the unit and the nearest name there is.
        """
        wanted = tuple(causalities)
        if name in self.unusable:
            raise ConfigError(f"{place}: unit '{unit}': {name} {self.unusable[name]} ({self.place})")
        if name not in self.variables:
            offered = [v.name for v in self.of_causality(*wanted)]
            raise ConfigError(
                f"{place}: unit '{unit}' has no variable '{name}'{nearest(name, offered)}; "
                f"{'/'.join(wanted)} variables of {self.place}: {', '.join(offered) or 'none'}"
            )
        variable = self.variables[name]
        if variable.causality not in wanted:
            raise ConfigError(
                f"{place}: {unit}.{name} is of causality {variable.causality}, not {' or '.join(wanted)}"
            )
        return variable
