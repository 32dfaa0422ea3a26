"""`evcosim list` names systems, scenarios and FMUs."""

from __future__ import annotations


def test_list(evcosim):
    answer = evcosim("list")
    assert answer.code == 0
    for text in ("scooter", "fig8 *", "ece15", "udds", "BoundController", "Battery"):
        assert text in answer.out
    data = evcosim("list", "--json").json
    assert {"scooter"} <= {system["name"] for system in data["systems"]}
    assert data["systems"][0]["default"] in data["systems"][0]["scenarios"]
    assert all(data["fmus"].values())
