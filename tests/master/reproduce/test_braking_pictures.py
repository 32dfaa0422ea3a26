"""The pictures of the braking two-wheeler."""

from __future__ import annotations


def test_pictures(braking_page):
    maneuvers = ["known_speed", "estimated_speed", "front_only", "front_compensated"]
    stems = [picture.stem for picture in braking_page.pictures]
    assert stems == ["friction", "psi", "propositions", *maneuvers, "lock", "vehicle", "delay"]
