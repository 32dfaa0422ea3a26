import dataclasses

import pytest

from evcosim.cosim.results.variable import ResultVariable


@pytest.mark.parametrize(
    ("changes", "held"),
    [
        ({}, False),
        ({"causality": "local"}, False),
        ({"causality": "input"}, True),
        ({"variability": "discrete"}, True),
        ({"variability": "fixed"}, True),
        ({"type": "Integer"}, True),
        ({"type": "Boolean"}, True),
        ({"type": "Enumeration"}, True),
    ],
)
def test_only_a_real_that_a_unit_changes_between_points_is_not_held(changes: dict, held: bool) -> None:
    assert dataclasses.replace(ResultVariable("a.x"), **changes).held is held
