"""A factor and an offset that a file writes."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from evcosim.cosim.system.scaling import Scaling
from evcosim.cosim.system.system import Connection, MapEntry
from evcosim.cosim.units.measure import Affine


def test_what_is_not_written_changes_nothing():
    assert not Scaling().written and Scaling().linear.identity and Scaling().in_words == ""


@pytest.mark.parametrize(
    ("keys", "linear", "words"),
    [
        ({"factor": 0.45}, Affine(0.45), "factor = 0.45"),
        ({"offset": -2}, Affine(1.0, -2.0), "offset = -2"),
        ({"convert": False}, Affine(), "convert = false"),
        (
            {"factor": -2, "offset": 1, "convert": True},
            Affine(-2.0, 1.0),
            "factor = -2, offset = 1, convert = true",
        ),
    ],
)
def test_what_is_written_is_a_linear_map(keys, linear, words):
    for scaling in (
        Scaling(**keys),
        Connection(**{"from": "a.y", "to": ["b.u"]}, **keys),
        MapEntry(variable="v", **keys),
    ):
        assert scaling.written and (scaling.linear, scaling.in_words) == (linear, words)


@pytest.mark.parametrize(
    "keys", [{"factor": 0.0}, {"factor": float("inf")}, {"offset": float("nan")}, {"factor": "2"}]
)
def test_what_is_no_scaling(keys):
    with pytest.raises(ValidationError):
        Scaling(**keys)


def test_a_mapping_has_one_sign():
    with pytest.raises(ValidationError, match="write a negative factor"):
        MapEntry(variable="v", invert=True, factor=2.0)
