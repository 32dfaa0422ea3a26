"""The metrics of a file: which keys go together, and which signals a metric needs."""

from __future__ import annotations

from typing import get_args

import pytest
from pydantic import ValidationError

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.metric_spec import MetricSpec, Reduction
from evcosim.cosim.system.toml import validate

REDUCTIONS = get_args(Reduction.model_fields["reduce"].annotation)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"reduce": "share_above"}, "reduce = \"share_above\" needs 'threshold'"),
        ({"reduce": "max", "threshold": 1}, "reduce = \"max\" takes no 'threshold'"),
        ({"reduce": "time_equal"}, "reduce = \"time_equal\" needs 'value'"),
        ({"threshold_unit": "km/h"}, "'threshold_unit' stands without a 'threshold'"),
        ({"reduce": "maximum"}, "reduce: Input should be 'final', 'mean'"),
        ({"sginal": "x"}, r"sginal: unknown key \(did you mean 'signal'\?\)"),
    ],
)
def test_keys_that_do_not_go_together_are_named(keys: dict, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        validate({"name": "it", "signal": "ecu.state", **keys}, MetricSpec, "scooter.toml")


@pytest.mark.parametrize("reduce", REDUCTIONS)
def test_each_reduction_takes_a_threshold_or_a_value_or_neither(reduce: str) -> None:
    """Exactly one of the combinations of these two keys is right for each reduction."""
    right = []
    for keys in ({}, {"threshold": 1.0}, {"value": 1}, {"threshold": 1.0, "value": 1}):
        try:
            right.append(Reduction.model_validate({"signal": "a.x", "reduce": reduce} | keys))
        except ValidationError:
            continue
    assert len(right) == 1


def test_all_signals_are_those_of_both_reductions() -> None:
    spec = MetricSpec(name="m", signal="a.x", minus="a.y", per=Reduction(signal="b.x", minus="b.y"))
    assert spec.all_signals == [*spec.signals, *Reduction(signal="b.x", minus="b.y").signals]
    assert MetricSpec(name="m", signal="a.x").all_signals == ["a.x"]
    assert MetricSpec(name="m", signal="a.x").reductions == (MetricSpec(name="m", signal="a.x"),)


@pytest.mark.parametrize("value", [[1], {"a": 1}])
def test_a_value_is_no_list_or_table(value: object) -> None:
    keys = {"name": "m", "signal": "a.x", "reduce": "time_equal", "value": value}
    with pytest.raises(ConfigError, match=r"^f: value: a value is a number, true, false or a text"):
        validate(keys, MetricSpec, "f")
