"""Lane keeping's published and expected numbers, from real FMUs over the real bus.

The limits are those of the design (chosen: the paper prints "zero steady-state error" and curves); the values
seen are in docs/systems/lane_keeping.md.
"""

from __future__ import annotations

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from evcosim import Simulation, simulate
from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.system.toml import DATA
from evcosim.models import lane_keeping_analysis as analysis
from evcosim.models.lane_keeping_controller import LaneKeepingController
from evcosim.models.lateral_vehicle import LateralVehicle

P = LaneKeepingController.Parameters()
STEP = 200  # the reference steps at 2 s
TARGET = 0.3  # m
VARIANTS = {
    "bus": {},
    "ideal": {"ideal": True},
    "jacobi": {"algorithm": "jacobi"},
    "jacobi ideal": {"algorithm": "jacobi", "ideal": True},
}
STATES = ("lateral_velocity", "heading_angle", "yaw_rate", "displacement")


@pytest.fixture(scope="module")
def runs():
    """The scenario `step` in every variant."""
    return {name: simulate("lane_keeping", "step", **options) for name, options in VARIANTS.items()}


def numbers(results):
    """Overshoot [%] and settling time [s] of the displacement."""
    beta = results["vehicle.displacement"][STEP:]
    settled = analysis.settling_time(results.time[STEP:] - results.time[STEP], beta, TARGET)
    return 100.0 * analysis.overshoot(beta, TARGET), settled


@pytest.mark.parametrize("variant", VARIANTS)
def test_overshoot_and_settling(runs, variant):
    overshoot, settled = numbers(runs[variant])
    assert overshoot == pytest.approx(3.8, abs=0.1)
    assert settled == pytest.approx(1.33, abs=0.02)


def test_at_100_hz_the_overshoot_is_that_of_the_sampled_loop(runs):
    assert numbers(runs["ideal"])[0] == pytest.approx(3.78, abs=0.01)
    assert numbers(runs["jacobi ideal"])[0] == pytest.approx(3.7, abs=0.05)


@pytest.mark.parametrize("variant", ["ideal", "jacobi ideal"])
def test_there_is_no_steady_state_error(runs, variant):
    assert runs[variant]["vehicle.displacement"][-1] == pytest.approx(TARGET, abs=1e-4)
    for state in STATES[:3]:
        assert runs[variant][f"vehicle.{state}"][-1] == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("variant", ["bus", "ideal"])
def test_the_angles_just_after_the_step(runs, variant):
    """The measured state is still 0, so they are S r: the bus rounds none of it on the controller's side."""
    assert runs[variant]["controller.front_steering_angle"][STEP] == pytest.approx(-0.2820, abs=1e-4)
    assert runs[variant]["controller.rear_steering_angle"][STEP] == pytest.approx(0.1023, abs=1e-4)
    assert not runs[variant]["controller.front_steering_angle"][:STEP].any()


@pytest.mark.parametrize("variant", ["bus", "jacobi"])
def test_the_bus_leaves_a_ripple_of_millimeters(variant):
    late = simulate("lane_keeping", "step", stop_time=26.0, **VARIANTS[variant])
    beta = late["vehicle.displacement"][late.time > 6.0]
    assert np.ptp(beta) <= 6e-3
    assert abs(beta.mean() - TARGET) <= 3e-3
    assert late.manifest["saturations"] == {}


def test_the_run_is_the_sampled_loop_of_the_analysis(runs):
    """FMUs and master add nothing: the difference to the steady state decays as the loop's matrix says."""
    results = runs["ideal"]
    x = np.column_stack([results[f"vehicle.{state}"] for state in STATES])[STEP:]
    error = np.array([0.0, 0.0, 0.0, -TARGET])
    loop = analysis.sampled_loop(P)
    for row in x:
        assert row - [0.0, 0.0, 0.0, TARGET] == pytest.approx(error, abs=1e-12)
        error = loop @ error


def test_jacobi_is_one_sample_of_delay(runs):
    late = simulate("lane_keeping", "step", ideal=True, parameters={"controller.delay_steps": 1})
    for state in STATES:
        assert np.array_equal(late[f"vehicle.{state}"], runs["jacobi ideal"][f"vehicle.{state}"])


def test_two_samples_of_delay_diverge():
    """Without limits the swings grow by the spectral radius of the loop in every step."""
    results = simulate("lane_keeping", "delayed", ideal=True)
    error = np.abs(results["vehicle.lateral_velocity"])
    per_second = [error[k : k + 100].max() for k in (300, 400, 500)]
    radius = analysis.spectral_radius(P, 2)
    assert radius == pytest.approx(1.0225, abs=5e-5)
    for before, after in pairwise(per_second):
        assert (after / before) ** 0.01 == pytest.approx(radius, abs=2e-3)
    assert np.abs(results["vehicle.displacement"]).max() > 10.0


def test_one_step_of_jacobi_and_one_of_the_controller_make_two():
    one = simulate(
        "lane_keeping", "step", ideal=True, algorithm="jacobi", parameters={"controller.delay_steps": 1}
    )
    two = simulate("lane_keeping", "delayed", ideal=True)
    assert one["vehicle.displacement"] == pytest.approx(two["vehicle.displacement"], rel=1e-9)


def test_over_the_bus_the_range_of_the_rear_steering_ends_the_growth():
    results = simulate("lane_keeping", "delayed")
    assert set(results.manifest["saturations"]) == {"can0.VCU_SteerRequest.VCU_SteerAngReqRear"}
    rear = np.rad2deg(results["vehicle.rear_steering_angle"])
    assert (rear[-100:].min(), rear[-100:].max()) == pytest.approx((-15.0, 15.0))
    swing = results["vehicle.lateral_velocity"]
    assert np.ptp(swing[-100:]) > 0.5
    assert np.ptp(swing[-100:]) == pytest.approx(np.ptp(swing[-200:-100]), rel=0.02)


@pytest.mark.parametrize(
    ("displacement", "heading", "ripple"), [(0.001, 0.01, 1.1e-3), (0.01, 0.01, 10.1e-3), (0.004, 0.05, 6e-3)]
)
def test_the_ripple_follows_the_resolution_of_the_lane_camera(tmp_path, displacement, heading, ripple):
    """The last one is that of series cameras: 4 mm and 0.05 deg."""
    dbc = (DATA / "can" / "ev.dbc").read_text()
    for signal, old, new in (
        ("CAM_LatDisplacement : 16|16@1- ", 0.001, displacement),
        ("CAM_HeadingAngle : 32|16@1- ", 0.01, heading),
    ):
        assert f"{signal}({old:g},0)" in dbc
        dbc = dbc.replace(f"{signal}({old:g},0)", f"{signal}({new:g},0)")
    (tmp_path / "coarse.dbc").write_text(dbc)
    system = (DATA / "systems" / "lane_keeping.toml").read_text().replace("can/ev.dbc", "coarse.dbc")
    (tmp_path / "lane_keeping.toml").write_text(system)
    results = simulate(tmp_path / "lane_keeping.toml", "step", stop_time=20.0)
    seen = np.ptp(results["vehicle.displacement"][results.time > 6.0])
    assert 0.5 * ripple < seen <= ripple


def test_what_receivers_see_is_rounded_to_the_signals():
    results = simulate("lane_keeping", "step")
    for name, step in {
        "controller.lateral_velocity": 0.001,
        "controller.displacement": 0.001,
        "controller.heading_angle": np.deg2rad(0.01),
        "controller.yaw_rate": np.deg2rad(0.01),
        "vehicle.front_steering_angle": np.deg2rad(0.01),
        "vehicle.rear_steering_angle": np.deg2rad(0.01),
    }.items():
        raw = results[name] / step
        assert np.abs(raw - np.round(raw)).max() < 1e-6
        assert len(np.unique(np.round(raw))) > 5


@pytest.mark.parametrize("speed", [8.0, 35.0])
def test_other_vehicles_and_speeds_are_kept_in_their_lane(speed):
    both = {"speed": speed, "mass": 1900.0, "yaw_inertia": 3000.0, "front_axle_distance": 1.5}
    parameters = {
        f"{unit}.{name}": value for unit in ("controller", "vehicle") for name, value in both.items()
    }
    results = simulate("lane_keeping", "step", ideal=True, parameters=parameters, stop_time=12.0)
    assert results["vehicle.displacement"][-1] == pytest.approx(TARGET, abs=1e-3)


def test_a_vehicle_beside_its_lane_comes_back():
    results = simulate(
        "lane_keeping", "step", parameters={"vehicle.initial_displacement": 1.0}, stop_time=2.0
    )
    assert abs(results["vehicle.displacement"][-1]) < 0.02


@pytest.mark.parametrize(
    ("parameter", "reason"),
    [
        ("rear_cornering_stiffness", r"\(A, B\) is not stabilizable.*rear_cornering_stiffness = 0"),
        ("tracked_displacement", r"there is no prefilter S.*tracked_displacement = 0"),
        ("displacement_weight", "there is no stabilizing gain K.*displacement_weight = 0"),
    ],
)
def test_a_controller_that_cannot_be_says_why_before_the_first_step(parameter, reason):
    with pytest.raises((ConfigError, RunError), match=f"(?s)controller.*{reason}"):
        Simulation("lane_keeping", parameters={f"controller.{parameter}": 0.0})


def test_metrics_are_the_numbers_of_the_table(runs):
    values = {m.name: m.value for m in runs["bus"].metrics()}
    overshoot, settled = numbers(runs["bus"])
    assert values["overshoot"] == pytest.approx(overshoot)
    assert values["settling time (2 % of 0.3 m)"] == pytest.approx(settled)
    assert values["front steering angle, lowest"] == pytest.approx(-0.2820, abs=1e-4)
    assert values["rear steering angle, highest"] == pytest.approx(0.1023, abs=1e-4)
    assert values["ripple of the displacement after 5 s"] <= 6.0


STEERING = {"four wheels": 1.0, "two wheels": 1e6}  # R: the weight of the rear angle


@pytest.fixture(scope="module", params=["crosswind", "blowout"])
def disturbed(request):
    """A disturbance, and the runs with four and with two steered wheels, without the bus."""
    runs = {
        steering: simulate(
            "lane_keeping", request.param, ideal=True, parameters={"controller.rear_steering_weight": weight}
        )
        for steering, weight in STEERING.items()
    }
    return request.param, runs


def test_two_steered_wheels_are_slower_and_damped_less():
    """The paper says so of the damping; it prints no numbers of two wheels."""
    slowest = {
        steering: analysis.closed_loop_poles(analysis.Parameters(rear_steering_weight=weight))[-1]
        for steering, weight in STEERING.items()
    }
    assert slowest["four wheels"] == pytest.approx(-3.2296 + 3.1087j, abs=1e-4)
    assert slowest["two wheels"] == pytest.approx(-1.5468 + 1.6857j, abs=1e-4)
    damping = {steering: -pole.real / abs(pole) for steering, pole in slowest.items()}
    assert damping["two wheels"] < damping["four wheels"] - 0.04


def test_the_step_with_two_steered_wheels(runs):
    results = simulate("lane_keeping", "two_wheel_steering")
    assert not results["vehicle.rear_steering_angle"].any()
    (more, later), (overshoot, settled) = numbers(results), numbers(runs["bus"])
    assert 1.2 * overshoot < more < 6.0
    assert 2.0 * settled < later < 3.0


def test_four_steered_wheels_hold_the_lane_far_better(disturbed):
    scenario, runs = disturbed
    worst = {steering: np.abs(each["vehicle.displacement"]).max() for steering, each in runs.items()}
    assert worst["four wheels"] < 0.011
    assert worst["two wheels"] / worst["four wheels"] > {"crosswind": 9.0, "blowout": 5.5}[scenario]


def test_a_lasting_disturbance_leaves_the_offset_of_the_closed_loop(disturbed):
    """(A - B K) x + E d = 0, with the weakened front axle in A and B; there is no integral of the error."""
    scenario, runs = disturbed
    vehicle = LateralVehicle.Parameters()
    if scenario == "crosswind":
        car, force, at = vehicle, 0.6 * 4.5 * np.arctan(15.0 / 21.3) * (21.3**2 + 15.0**2), 299
        disturbance = [force / car.mass, 0.0, 0.4 * force / car.yaw_inertia, 0.0]
    else:
        car, at = dataclasses.replace(vehicle, front_cornering_stiffness=0.625 * 30e3), -1
        drag = 0.3 * 1380.0 * 9.81 * 1.27 / 2.52 / 2.0
        disturbance = [0.0, 0.0, 0.75 * drag / car.yaw_inertia, 0.0]
    for steering, weight in STEERING.items():
        gain = np.array(analysis.Parameters(rear_steering_weight=weight).gain)
        left = -np.linalg.solve(np.array(car.a) - np.array(car.b) @ gain, disturbance)[3]
        close = 0.06 if steering == "two wheels" else 0.002
        assert runs[steering]["vehicle.displacement"][at] == pytest.approx(left, rel=close)


def test_without_steering_a_disturbance_takes_the_vehicle_out_of_its_lane():
    with Simulation("lane_keeping", "blowout") as sim:
        for angle in ("front_steering_angle", "rear_steering_angle"):
            sim.override(f"vehicle.{angle}", 0.0)
        sim.run()
        assert sim.results["vehicle.displacement"].min() < -10.0


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_controller_that_reads_the_status_of_the_camera_keeps_the_lane_without_it(engine):
    runs = {
        reads: simulate(
            "lane_keeping", "camera_corrupt", engine=engine, parameters={"controller.reads_status": reads}
        )
        for reads in (True, False)
    }
    sound = simulate("lane_keeping", "step", engine=engine)["vehicle.displacement"]
    read, unread = (runs[reads]["vehicle.displacement"] for reads in (True, False))
    blind = slice(150, 351)
    status = runs[True]["controller.camera_status"]
    assert set(status[150:350]) == {2.0}
    assert not status[1:150].any()
    assert status[350] == 32.0  # frames were lost before it
    assert not status[351:].any()
    assert np.array_equal(read[:151], sound[:151])
    assert np.abs(read - sound)[blind].max() < 0.02
    assert np.abs(unread - sound)[blind].max() > 5.0
    # what is received is the same: the bus holds the last values that were taken
    assert not runs[True]["controller.displacement"][150:350].any()
    counted = runs[True].manifest["frames"]["can0"]["messages"]["CAM_LaneStatus"]
    assert counted["statuses"]["wrong_crc"] == counted["rejected"] == 200


def test_an_fmu_that_cannot_read_the_status_runs_without_it(tmp_path):
    """`status_optional`: left out, with a warning; without it the FMU is refused."""
    text = (DATA / "systems" / "lane_keeping.toml").read_text()
    other = text.replace("controller.camera_status", "controller.camera_state").replace(
        '"!controller.camera_state"', '"!vehicle.crosswind"'
    )
    (tmp_path / "s.toml").write_text(other)
    results = simulate(tmp_path / "s.toml")
    said = "the status of can0.CAM_LaneStatus -> controller.camera_state"
    assert any(said in warning for warning in results.manifest["warnings"])
    assert np.array_equal(results["vehicle.displacement"], simulate("lane_keeping")["vehicle.displacement"])
    (tmp_path / "s.toml").write_text(other.replace("status_optional = true\n", ""))
    with pytest.raises(ConfigError, match=r"camera_state.*did you mean 'camera_status'"):
        simulate(tmp_path / "s.toml")
