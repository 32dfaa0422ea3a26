"""What a metric is: the specification that stands in system and scenario files (see `results.metrics`)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from .toml import FileModel

_TAKES = {
    "threshold": ("share_above", "time_above", "integral_above", "settling"),
    "value": ("share_equal", "time_equal"),
}


class Reduction(FileModel):
    """A signal, `minus` another one if given, and how it is reduced to one number.

    `threshold` is in `threshold_unit`, or else in the unit of the signal. `value` is a number or the name
    of a state of an enumeration.
    """

    signal: str
    minus: str | None = None
    reduce: Literal[
        "final",
        "mean",
        "max",
        "min",
        "rms",
        "range",
        "integral",
        "integral_above",
        "share_above",
        "share_equal",
        "time_above",
        "time_equal",
        "changes",
        "settling",
    ] = "final"
    threshold: float | None = Field(default=None, allow_inf_nan=False)
    threshold_unit: str | None = None
    value: bool | int | float | str | None = None
    after: float | None = Field(default=None, allow_inf_nan=False)

    @property
    def signals(self) -> list[str]:
        """The names of the signals that it is of."""
        return [name for name in (self.signal, self.minus) if name is not None]

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> Reduction:
        for key, reductions in _TAKES.items():
            given, wanted = getattr(self, key) is not None, self.reduce in reductions
            if given != wanted:
                raise ValueError(f"reduce = \"{self.reduce}\" {'needs' if wanted else 'takes no'} '{key}'")
        if self.threshold_unit is not None and self.threshold is None:
            raise ValueError("'threshold_unit' stands without a 'threshold'")
        return self


class MetricSpec(Reduction):
    """A named number and the unit of measure that it is given in."""

    name: str
    unit: str = "1"
    per: Reduction | None = None

    @property
    def reductions(self) -> tuple[Reduction, ...]:
        """What is computed: itself, and `per`."""
        return (self, self.per) if self.per else (self,)

    @property
    def all_signals(self) -> list[str]:
        """The names of all signals that it needs."""
        return [name for part in self.reductions for name in part.signals]
