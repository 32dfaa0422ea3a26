"""A part of tests/support/bus_campaign.py: no latency is above its bound, and some are near it."""

from __future__ import annotations

import pytest

from support.bus_campaign import SETS, best, traffic


@pytest.mark.parametrize("name", SETS)
def test_latencies_reach_their_bounds_and_pass_none(name):
    found = best(traffic(name, 500_000), range(9), steps=200)
    assert 0.8 <= max(found.values()) <= 1.0
