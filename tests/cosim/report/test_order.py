"""When an output reaches another unit: as the engines do it."""

from __future__ import annotations

import pytest

from evcosim import Simulation
from evcosim.cosim.report.order import AT_BEGIN, AT_ONCE, LATER, arrivals, reasons


def manifest(algorithm="gauss_seidel", **more):
    return {
        "order": ["ecu", "car", "meter"],
        "experiment": {"algorithm": algorithm},
        "units": {"ecu": {"sampled": ["throttle"]}, "car": {"sampled": []}, "meter": {"sampled": ["count"]}},
        "connect": [
            {"from": "ecu.throttle", "to": ["car.throttle"], "via": "can0.Request.Throttle"},
            {"from": "car.speed", "to": ["ecu.speed", "meter.speed"]},
            {"from": "car.power", "to": ["meter.power"], "via": "can0.Status.Power"},
            {"from": "meter.count", "to": ["ecu.count"]},
        ],
    } | more


def test_gauss_seidel():
    assert arrivals(manifest()) == [
        ("ecu.throttle", "car.throttle", "can0.Request.Throttle", AT_ONCE),
        ("car.speed", "ecu.speed", "", AT_BEGIN),
        ("car.speed", "meter.speed", "", AT_ONCE),
        ("car.power", "meter.power", "can0.Status.Power", AT_BEGIN),
        ("meter.count", "ecu.count", "", LATER),
    ]
    assert reasons(manifest()) == {
        "ecu": f"car ({AT_BEGIN}); meter ({LATER})",
        "car": f"ecu ({AT_ONCE})",
        "meter": f"car ({AT_ONCE}); car ({AT_BEGIN})",
    }


def test_jacobi_gives_nothing_at_once():
    assert {when for *_, when in arrivals(manifest("jacobi"))} == {AT_BEGIN, LATER}


def test_without_buses_a_connection_is_direct():
    found = {(a, b): (via, when) for a, b, via, when in arrivals(manifest(ideal=True))}
    assert found["car.power", "meter.power"] == ("", AT_ONCE)


@pytest.mark.parametrize(
    "about", [{}, {"connect": [{"to": 3}, 4]}, {"order": "x", "units": 3, "experiment": []}]
)
def test_any_manifest_is_taken(about):
    assert arrivals(about) == []


@pytest.mark.parametrize(("algorithm", "expected"), [("gauss_seidel", AT_ONCE), ("jacobi", LATER)])
def test_the_engine_agrees(algorithm, expected):
    """A throttle over a bus: row k shows what the vehicle received in step k, and what the ECU sent in it."""
    with Simulation("scooter", stop_time=3.0, algorithm=algorithm) as sim:
        sim.run()
        results = sim.results
    when = {(a, b): when for a, b, _, when in arrivals(results.manifest)}["ecu.throttle", "vehicle.throttle"]
    assert when == expected
    sent, received = (
        results["ecu.throttle"][:-1],
        results["vehicle.throttle"][:-1],
    )  # no step begins at the end
    rows = len(sent)
    half = 0.5 * 0.4 + 1e-9  # the resolution of the bus signal
    late = [k for k in (0, 1) if abs(sent[: rows - k] - received[k:]).max() <= half]
    assert late == ([0] if expected == AT_ONCE else [1])
