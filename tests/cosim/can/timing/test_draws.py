"""Draws depend on what they are for and on nothing else, and are spread evenly."""

from __future__ import annotations

import numpy as np

from evcosim.cosim.can.timing import draws
from evcosim.cosim.can.timing.draws import drawn, mixed
from support.compiled import in_machine_code


def sample(**changed: int) -> list[float]:
    given = {"seed": 3, "bus": 1, "message": 7, "purpose": 2} | changed
    return [drawn(instance=i, **given) for i in range(2000)]


def test_draws_fill_the_unit_interval_evenly() -> None:
    values = np.array(sample())
    assert values.min() >= 0.0 and values.max() < 1.0
    counts = np.histogram(values, bins=20, range=(0.0, 1.0))[0]
    # chi-square with 19 degrees of freedom: 43.8 is exceeded once in 1,000
    assert ((counts - 100.0) ** 2 / 100.0).sum() < 43.8


def test_anything_changed_gives_other_draws_that_are_not_correlated() -> None:
    first = np.array(sample())
    for changed in ({"seed": 4}, {"bus": 2}, {"message": 8}, {"purpose": 3}, {"seed": 3 + 2**40}):
        other = np.array(sample(**changed))
        assert abs(np.corrcoef(first, other)[0, 1]) < 0.08  # 3.5 standard deviations
        assert not (first == other).any()


def test_neighbours_are_not_correlated() -> None:
    values = np.array(sample())
    assert abs(np.corrcoef(values[:-1], values[1:])[0, 1]) < 0.08


def test_machine_code_draws_the_same() -> None:
    machine = in_machine_code(draws)["drawn"]
    for seed in (0, 1, 2**31, 2**62, -5):
        for instance in (0, 1, 10**9, 2**40):
            assert machine(seed, 0, 31, instance, 4) == drawn(seed, 0, 31, instance, 4)


def test_the_finalizer_is_that_of_murmurhash3() -> None:
    # fmix32 alone has known values; after it come the round's own product and sum
    def fmix32(h: int) -> int:
        h ^= h >> 16
        h = h * 0x85EBCA6B % 2**32
        h ^= h >> 13
        h = h * 0xC2B2AE35 % 2**32
        return h ^ h >> 16

    assert fmix32(1) == 0x514E28B7  # published test value
    state = (fmix32(9 ^ 1) * 5 + 0xE6546B64) % 2**32
    assert mixed(9, 1) == (fmix32(state) * 5 + 0xE6546B64) % 2**32
