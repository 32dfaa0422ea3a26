"""The metrics that a file names: tables `[[metrics]]`; `results.metrics` evaluates them."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field, model_validator

from .toml import FORBIDDEN_KEY, FileModel, FileValue

_TAKES = {
    "threshold": ("share_above", "time_above", "integral_above", "settling"),
    "value": ("share_equal", "time_equal"),
}


def _add_rules(schema: dict[str, Any]) -> None:
    """Write into a JSON schema which reductions need a key and which take none, as without `reduce`."""
    known = schema["properties"]["reduce"]["enum"]
    schema["dependentRequired"] = {"threshold_unit": ["threshold"]}
    schema["allOf"] = []
    for key, takes in _TAKES.items():
        given = {"properties": {"reduce": {"enum": list(takes)}}, "required": ["reduce"]}
        other = {"properties": {"reduce": {"enum": [name for name in known if name not in takes]}}}
        schema["allOf"] += [
            {"if": given, "then": {"required": [key]}},
            {"if": other, "then": {"properties": {key: FORBIDDEN_KEY}}},
        ]


class Reduction(FileModel):
    """A signal of a run, or the difference of two, reduced to one number."""

    signal: str = Field(examples=["vehicle.speed"])
    """The variable x, written `unit.variable`."""

    minus: str | None = None
    """A variable that is subtracted first: x is then the difference."""

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
    """The number that is made of x over the run; `range` is max - min, `settling` the time until x stays
    within the threshold."""

    threshold: float | None = Field(default=None, allow_inf_nan=False)
    """The level that `share_above`, `time_above`, `integral_above` and `settling` need; others take none."""

    threshold_unit: str | None = None
    """Unit of measure of `threshold`; without it the signal's own."""

    value: FileValue | None = None
    """The number, or the name of an enumeration's state, that `share_equal` and `time_equal` need."""

    after: float | None = Field(default=None, allow_inf_nan=False)
    """Only what lies at or behind this time in s counts; without it the whole run."""

    model_config = ConfigDict(json_schema_extra=_add_rules)

    @property
    def signals(self) -> list[str]:
        """The names of the signals that are reduced."""
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
    """A number of the run that is reported. Its unit follows from the signals and is converted."""

    name: str
    """The name under which it is reported; each name is there once."""

    unit: str = "1"
    """Unit of measure in which it is given."""

    per: Reduction | None = None
    """A second reduction by which it is divided, as in `per = { signal = "vehicle.distance" }`."""

    @property
    def reductions(self) -> tuple[Reduction, ...]:
        """The metric's own reduction, and `per` where it has one."""
        return (self, self.per) if self.per else (self,)

    @property
    def all_signals(self) -> list[str]:
        """The names of all signals that the metric needs."""
        return [name for part in self.reductions for name in part.signals]
