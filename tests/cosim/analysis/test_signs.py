"""How outputs react to inputs, and which signs to turn."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.analysis.signs import alike, direction, turned

COURSE = np.array([0.0, 1.0, 3.0, 2.0])


@pytest.mark.parametrize("factor", [1.0, 3.6, -1.0, -0.01, 1e-200, 1e200])
def test_a_multiple_is_known_by_its_factor_and_agrees(factor: float) -> None:
    ratio, agreement = alike(factor * COURSE, COURSE)
    assert ratio == pytest.approx(factor)
    assert agreement == pytest.approx(np.sign(factor))


def test_another_course_and_none() -> None:
    assert alike(np.array([1.0, -1.0]), np.array([1.0, 1.0])) == pytest.approx((0.0, 0.0))
    assert alike(0.0 * COURSE, COURSE) == alike(COURSE, 0.0 * COURSE) == (0.0, 0.0)


def test_a_direction_is_that_of_most_of_the_change() -> None:
    assert (direction(COURSE), direction(-COURSE), direction(0.0 * COURSE)) == (1, -1, 0)
    assert direction(np.array([3.0, -0.5])) == 1
    assert direction(np.array([2.0, -1.0])) == 0


SIGNS = st.sampled_from([-1, 1])


@given(st.dictionaries(st.tuples(st.sampled_from("abc"), st.sampled_from("xyz")), SIGNS, min_size=1))
def test_turning_makes_all_signs_right_by_the_fewest_turns(signs: dict[tuple[str, str], int]) -> None:
    """Beside the trial of all choices."""

    def right(inputs: set[str], outputs: set[str]) -> bool:
        return all(s * (-1) ** ((u in inputs) + (y in outputs)) == 1 for (u, y), s in signs.items())

    def subsets(names: str) -> list[set[str]]:
        return [set(c) for n in range(len(names) + 1) for c in itertools.combinations(names, n)]

    ways = [(u, y) for u in subsets("abc") for y in subsets("xyz") if right(u, y)]
    found = turned(signs)
    if not ways:
        assert found is None
        return
    assert found is not None
    assert right(*found)
    assert len(found[0]) + len(found[1]) == min(len(u) + len(y) for u, y in ways)


def test_one_pair_turns_the_input() -> None:
    assert turned({("brake", "speed"): -1}) == ({"brake"}, set())
    assert turned({("front", "y"): -1, ("rear", "y"): -1, ("front", "psi"): 1}) == (set(), {"y"})
