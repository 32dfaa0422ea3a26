"""The braking two-wheeler's published and expected numbers, from real FMUs over the real bus.

Each limit is that of the paper's Table I (published) or of the design (chosen); docs/systems/braking.md lists
the values seen.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest

from evcosim import simulate
from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.results import metrics
from evcosim.cosim.system.scenario import load_scenario
from evcosim.cosim.system.system import load_system

ROADS = {"dry": 4.5, "wet": 8.0, "cobble": 7.0, "snow": 20.0}  # s that are enough to lock or stop
VARIANTS = {"bus": {}, "ideal": {"ideal": True}}
every_variant = pytest.mark.parametrize("variant", list(VARIANTS))


@functools.cache
def run(strategy, variant="bus", delay=0.01, algorithm="gauss_seidel", **vehicle):
    """Results of a strategy; they are shared, nobody writes into them."""
    parameters = {"front_brake.delay": delay, "rear_brake.delay": delay}
    parameters |= {f"vehicle.{name}": value for name, value in vehicle.items()}
    stop_time = ROADS[vehicle.get("road", "dry")]
    if "wheel_inertia" in vehicle:
        parameters |= {"controller.wheel_inertia": vehicle["wheel_inertia"]}
    return simulate(
        "braking",
        strategy,
        parameters=parameters,
        algorithm=algorithm,
        stop_time=stop_time,
        **VARIANTS[variant],
    )


def distance(*args, **kwargs):
    results = run(*args, **kwargs)
    assert results["vehicle.speed"][-1] == 0.0
    return results["vehicle.stopping_distance"][-1]


# -- Table I -----------------------------------------------------------------------------------------------


@every_variant
def test_known_speed(variant):
    assert distance("known_speed", variant) == pytest.approx(33.34, abs=0.3)


@every_variant
def test_front_only(variant):
    longer = distance("front_only", variant)
    assert longer == pytest.approx(51.32, abs=0.3)
    assert 100.0 * (longer / distance("known_speed", variant) - 1.0) == pytest.approx(54.0, abs=1.5)


@every_variant
def test_front_compensated(variant):
    longer = distance("front_compensated", variant)
    assert longer == pytest.approx(46.4, abs=0.5)
    assert 100.0 * (longer / distance("known_speed", variant) - 1.0) == pytest.approx(39.0, abs=1.5)


@every_variant
@pytest.mark.parametrize("road", list(ROADS))
def test_estimated_speed_locks_both_wheels(variant, road):
    """Published: the wheels lock. Here: both slips above 0.99 within 1 s, above 15 m/s, until the end."""
    results = run("estimated_speed", variant, road=road)
    v, front, rear = (results[f"vehicle.{name}"] for name in ("speed", "front_slip", "rear_slip"))
    locked = (front > 0.99) & (rear > 0.99)
    first = int(np.argmax(locked))
    assert locked[first]
    assert results.time[first] <= 1.0
    assert v[first] > 15.0
    assert locked[first:][v[first:] > 0.0].all()
    assert not results["controller.front_slip_estimate"][first + 1 : -1].any()  # it believes all is well
    assert results["controller.believed_speed"][first + 1] == 0.0


# -- the detailed plant ------------------------------------------------------------------------------------


def detailed(strategy, **vehicle):
    """Results with springs, elastic tires and relaxation in the place of the plain vehicle."""
    parameters = {f"vehicle.{name}": value for name, value in vehicle.items()}
    return simulate(
        "braking", strategy, fmus={"vehicle": "DetailedTwoWheeler"}, parameters=parameters, stop_time=5.0
    )


def test_table_i_with_the_detailed_plant():
    """The same controller; the height of the center of mass is calibrated for (c) and (d)."""
    a, c, d = (
        detailed(s)["vehicle.stopping_distance"][-1]
        for s in ("known_speed", "front_only", "front_compensated")
    )
    assert a == pytest.approx(33.34, abs=0.7)
    assert c == pytest.approx(51.32, abs=0.3)
    assert d == pytest.approx(46.4, abs=0.5)


def test_both_wheels_of_the_detailed_plant_lock_at_estimated_speed():
    results = detailed("estimated_speed")
    v = results["vehicle.speed"]
    locked = (results["vehicle.front_slip"] > 0.99) & (results["vehicle.rear_slip"] > 0.99)
    first = int(np.argmax(locked))
    assert 0.0 < results.time[first] <= 1.0
    assert v[first] > 15.0
    assert results["vehicle.front_slip"][first:][v[first:] > 0.0].min() > 0.99
    turning = ~locked[first:] & (v[first:] > 0.0)  # the rear wheel, as it lands from its hop
    assert 0.01 * turning.sum() <= 0.1


def test_relaxation_hardly_moves_a_stop():
    """A length of 0.1 to 0.3 m changes the distance by less than 0.15 m."""
    short, long = (
        detailed("front_only", relaxation_length=x)["vehicle.stopping_distance"][-1] for x in (0.1, 0.3)
    )
    assert 0.0 < abs(long - short) < 0.15


# -- delay -------------------------------------------------------------------------------------------------


@every_variant
def test_one_more_sample_of_delay_costs_half_a_meter(variant):
    assert distance("known_speed", variant, delay=0.02) == pytest.approx(33.85, abs=0.1)


@every_variant
def test_two_more_samples_of_delay_cost_three_meters(variant):
    assert distance("known_speed", variant, delay=0.03) == pytest.approx(36.3, abs=0.15)


@pytest.mark.parametrize("strategy", ["front_only", "front_compensated"])
def test_with_two_more_samples_of_delay_the_front_wheel_locks(strategy):
    """The slip swings far beyond its set point, and in the last two meters a second the wheel locks."""
    nominal, late = run(strategy, "ideal"), run(strategy, "ideal", delay=0.03)
    assert nominal["vehicle.front_slip"].max() < 0.25
    fast = late["vehicle.speed"] > 5.0
    assert late["vehicle.front_slip"][fast].max() > 0.5
    assert late["vehicle.front_slip"].max() > 0.99
    assert distance(strategy, "ideal", delay=0.03) > distance(strategy, "ideal") + 6.0


def test_jacobi_is_two_more_samples_of_delay():
    """One from controller to brake, one from brake to vehicle; (a) needs no estimator."""
    late, jacobi = run("known_speed", "ideal", delay=0.03), run("known_speed", "ideal", algorithm="jacobi")
    assert jacobi["vehicle.speed"] == pytest.approx(late["vehicle.speed"], abs=1e-9)
    assert distance("known_speed", "ideal", algorithm="jacobi") == pytest.approx(36.3, abs=0.15)


def test_the_scenario_delayed_is_that_run():
    results = simulate("braking", "delayed")
    assert results["vehicle.stopping_distance"][-1] == distance("known_speed", delay=0.03)


# -- sensitivities (ideal: the bus adds up to 0.15 m in the last two meters a second) -----------------------


@pytest.mark.parametrize(
    ("height", "expected"), [(1.1, (33.35, 47.80, 42.99)), (0.9, (33.33, 54.82, 49.88))], ids=["+10", "-10"]
)
def test_height_of_the_center_of_mass(height, expected):
    for strategy, meters in zip(("known_speed", "front_only", "front_compensated"), expected, strict=True):
        assert distance(strategy, "ideal", center_height=0.506 * height) == pytest.approx(meters, abs=0.05)


def test_half_the_inertia_of_the_wheels(tmp_path):
    """Twice the loop gain: at 100 Hz the slip swings; at 1 kHz (a) and (d) are as before."""
    expected = {"known_speed": 33.29, "front_only": 48.86, "front_compensated": 46.44}
    for strategy, meters in expected.items():
        fine = tmp_path / f"{strategy}.toml"
        fine.write_text(
            f"""
            [experiment]
            step_size = 0.001
            stop_time = 4.5
            [parameters.controller]
            strategy = "{strategy}"
            wheel_inertia = 0.395
            [parameters.vehicle]
            wheel_inertia = 0.395
            """
        )
        results = simulate("braking", fine, ideal=True)
        assert results["vehicle.stopping_distance"][-1] == pytest.approx(meters, abs=0.15)
    assert distance("known_speed", "ideal", wheel_inertia=0.395) == pytest.approx(34.2, abs=0.1)


# -- over the bus ------------------------------------------------------------------------------------------


def test_the_bus_quantizes_what_receivers_see():
    results = run("known_speed")
    for wheel in ("front", "rear"):
        sent, seen = results[f"vehicle.{wheel}_wheel_speed"], results[f"controller.{wheel}_wheel_speed"]
        assert np.abs(seen - sent)[:-1].max() <= 0.005 + 1e-12
        asked, got = results[f"controller.{wheel}_torque"], results[f"{wheel}_brake.torque_request"]
        assert np.abs(got - asked)[:-1].max() <= 0.25 + 1e-12
    assert np.abs(results["controller.speed"] - results["vehicle.speed"])[:-1].max() <= 0.005 + 1e-12


def test_the_slip_settles_at_its_set_point():
    results = run("known_speed")
    settled = (results.time > 0.6) & (results["vehicle.speed"] > 5.0)
    for wheel in ("front", "rear"):
        assert np.abs(results[f"vehicle.{wheel}_slip"][settled] - 0.22).max() < 0.005


def test_the_compensation_makes_the_estimate_right():
    """(d): the rear wheel runs without slip, so its speed is the vehicle's; in (c) it runs ahead."""
    errors = {}
    for strategy in ("front_only", "front_compensated"):
        results = run(strategy)
        fast = (results["vehicle.speed"] > 5.0) & (results.time > 0.5)
        error = results["estimator.speed"] / np.maximum(results["vehicle.speed"], 1.0) - 1.0
        errors[strategy] = np.abs(error[fast]).mean()
    assert errors["front_compensated"] < 0.2 * errors["front_only"]


def test_metrics_of_the_system():
    results = run("known_speed")
    specs = load_system("braking").file.metrics
    found = {m.name: m.value for m in metrics.evaluate(results, specs)}
    assert found["stopping distance"] == results["vehicle.stopping_distance"][-1]
    assert found["speed at the end"] == 0.0
    assert found["stopping time"] == pytest.approx(2.48, abs=0.02)
    assert found["rear wheel locked"] == 0.0


@pytest.mark.parametrize("road", ["dry", "wet", "cobble"])
def test_roads_keep_the_order_of_the_strategies(road):
    """Full slip control stops shortest; two locked wheels beat one controlled wheel, but do not steer."""
    a, b, d, c = (
        distance(s, road=road) for s in ("known_speed", "estimated_speed", "front_compensated", "front_only")
    )
    assert a < d < c
    assert a < b < c


# -- bad input ---------------------------------------------------------------------------------------------


def test_an_unknown_road_is_refused_by_name():
    with pytest.raises(ConfigError) as caught:
        simulate("braking", parameters={"vehicle.road": "mud"})
    for part in ("vehicle.road", "mud", "dry", "wet", "cobble", "snow"):
        assert part in str(caught.value)


def test_an_unknown_strategy_is_refused_by_name():
    with pytest.raises(ConfigError, match="front_compensated"):
        simulate("braking", parameters={"controller.strategy": "rear_only"})


def test_a_start_that_is_too_slow_is_refused_with_its_values():
    with pytest.raises(RunError, match=r"initial_speed = 3\.0 km/h must be above stop_speed = 1\.0 m/s"):
        simulate("braking", parameters={"vehicle.initial_speed": 3.0})


def test_every_scenario_names_its_strategy():
    system = load_system("braking")
    for name in ("known_speed", "estimated_speed", "front_only", "front_compensated"):
        assert load_scenario(system, name).file.parameters["controller"]["strategy"] == name
