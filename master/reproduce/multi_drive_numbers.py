"""The numbers of the two-motor car for what the paper prints, each a function of the results of runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ...cosim.results.results import Results
from ...cosim.row_store import Array
from ...models import multi_drive_analysis as analysis
from ...models.constants import GRAVITY, KMH
from ...models.electronic_differential import ElectronicDifferential
from ...models.induction_motor_drive import InductionMotorDrive
from ...models.two_motor_vehicle import TwoMotorVehicle
from ...models.wheel_speed_controller import TORQUE_LIMIT
from . import printed
from .page import Findings, Found, at_least, at_most, holds, near

SPEED = 60.0 / KMH  # m/s
DENSITY = 1.164  # kg/m3, at which the air gives the printed torque
FINE_STEPS = (1e-3, 1e-4)  # s, of controllers at 1 and 10 kHz

_CAR = TwoMotorVehicle.Parameters()
_UPHILL_ENDS = 499  # the last row of the slope of +10 %, from 3 to 5 s
_JUMP_IS_OVER = 0.5  # s after the steering has jumped


def of_print(by: str) -> float:
    """Return the number of a row of the table."""
    return printed.row("multi_drive", by).number


def maneuver(results: Results) -> analysis.Maneuver:
    """Return dip, overshoot, error and distance of a run of the maneuver."""
    return analysis.maneuver(
        results.time,
        results["vehicle.speed"],
        SPEED,
        results["controller.left_error"],
        results["vehicle.distance"],
    )


def largest(a: Array, b: Array) -> float:
    """Return the largest difference of two arrays of one shape."""
    return float(np.abs(a - b).max())


def inputs(results: Results) -> Findings:
    """Return what drives the maneuver: speed, curves and slopes, as they stand in a run."""
    time, angle, grade = results.time, results["vehicle.steering_angle"], results["vehicle.road_grade"]
    right, left, up, down = angle < 0.0, angle > 0.0, grade > 0.0, grade < 0.0
    begins = {"right curve": right, "left curve": left, "slope begins": up, "slope inverts": down}
    instants = {by: float(time[where.argmax()]) for by, where in begins.items()}
    instants["right curve ends"] = float(time[right.argmax() + int((~right[right.argmax() :]).argmax())])
    speed, slope = float(results["differential.speed_reference"][0]), 100.0 * float(np.tan(grade.max()))
    return {
        **{by: _equal(value, by, "s") for by, value in instants.items()},
        "slope": near(slope, of_print("slope"), 1e-9, "%"),
        "speed": _equal(speed, "speed", "km/h"),
        "poles": _equal(2.0 * InductionMotorDrive.Parameters().pole_pairs, "poles", ""),
        "bearing friction": Found("no such parameter"),
        "motor friction": Found(f"{InductionMotorDrive.Parameters().friction:g} used"),
    }


def _equal(value: float, by: str, unit: str) -> Found:
    return holds(f"{value:g} {unit}".rstrip(), abs(value - of_print(by)) < 1e-9)


def differential(results: Results) -> Findings:
    """Return the references of the wheels in a run of the maneuver."""
    p = ElectronicDifferential.Parameters()
    angle = results["differential.steering_angle"]
    shift = 0.5 * p.track * np.tan(angle) / p.wheelbase
    left, right = (results[f"differential.{side}_reference"] for side in ("left", "right"))
    wheels = SPEED / p.wheel_radius
    error = max(largest(left, (1.0 - shift) * wheels), largest(right, (1.0 + shift) * wheels))
    speeds = [results[f"vehicle.{side}_wheel_speed"] for side in ("right", "left")]
    in_right, in_left = (int(np.flatnonzero(where)[-1]) for where in (angle < 0.0, angle > 0.0))
    turning = [speeds[0][in_right], speeds[1][in_right], speeds[1][in_left], speeds[0][in_left]]
    return {
        "differential": at_most(error, 1e-9, "rad/s"),
        "straight": at_most(largest(left[angle == 0.0], right[angle == 0.0]), 1e-12, "rad/s"),
        "curve": holds(
            "{:.2f} and {:.2f}, {:.2f} and {:.2f} rad/s".format(*turning),
            bool(0.0 < turning[0] < turning[1] and 0.0 < turning[2] < turning[3]),
            "the inner wheel slower, both forward",
        ),
    }


def torques(found: Mapping[str, Any]) -> Findings:
    """Return the torques of the resistances, as they are and as printed literally."""
    run = found["mimo"]
    air = {name: float(found[name]["vehicle.aerodynamic_torque"].max()) for name in ("mimo", "pid")}
    thin = float(found["density"]["vehicle.aerodynamic_torque"][0])
    loads = [
        sum(found[name][f"vehicle.{part}_torque"] for part in ("aerodynamic", "slope", "rolling"))
        for name in ("mimo", "pid")
    ]
    slope, rolling = float(run["vehicle.slope_torque"].max()), float(run["vehicle.rolling_torque"][0])
    weight = _CAR.mass * GRAVITY
    with_density = near(
        thin, of_print("air PIDs"), 0.05, "N·m", of=f"at {DENSITY} kg/m³",
        reason=f"{air['pid']:.2f} N·m at 1.2 kg/m³",
    )  # fmt: skip # one value
    same = holds(
        f"{air['mimo']:.2f} N·m, {air['pid']:.2f} N·m under the PIDs",
        abs(air["mimo"] / air["pid"] - 1.0) < 0.01,
    )
    area = holds(f"{_CAR.frontal_area:g} m² under both", True)
    return {
        "slope torque": _literal(weight * np.sin(run["vehicle.road_grade"].max()), slope),
        "rolling torque": _literal(weight * _CAR.rolling_coefficient, rolling),
        "air PIDs": with_density,
        "air PIDs, table": with_density,
        "air MIMO-PID": same,
        "air MIMO-PID, table": same,
        "load": holds(
            f"{largest(loads[0], loads[1]):.2f} N·m of up to {loads[0].max():.0f}",
            largest(loads[0], loads[1]) < 0.01 * loads[0].max(),
        ),
        "area": area,
        "area, text": area,
        "area, table": area,
        "area PIDs": holds("0 %", True),
        "area MIMO-PID": area,
    }


def _literal(force: float, torque: float) -> Found:
    return holds(f"{force:.0f} N; {torque:.1f} N·m with R", abs(force / torque - 1.0) > 0.01)


def comparison(found: Mapping[str, Any]) -> Findings:
    """Return what the paper says of the MIMO-PID against the PIDs, with the fair baseline beside it."""
    mimo, pid, stronger = (maneuver(found[name]) for name in ("mimo", "pid", "stronger"))
    dips = f"{mimo.dip:.3g} km/h"
    same = holds(dips, mimo.dip > 0.1, reason=f"{stronger.dip:.3g} km/h under those")
    settled = [after_jumps(found[name]) for name in ("mimo", "pid")]
    stable = at_most(largest_error(found["pid"]), 2.0, "rad/s", digits=2, reason="of 46 rad/s")
    return {
        "PIDs are stable": stable,
        "slope effect": same,
        "dip MIMO-PID": same,
        "dip PIDs": holds(f"{pid.dip:.3g} km/h", pid.dip > 0.1, "above 0.1 km/h"),
        "slope demand": _demand(found["mimo"]),
        "error": _saved(mimo.error, pid.error, "rad/s", stronger.error),
        "dip": _saved(mimo.dip, pid.dip, "km/h", stronger.dip),
        "curve error": holds(f"{largest_error(found['mimo']):.2f} rad/s", largest_error(found["mimo"]) > 0.1),
        "smooth": [
            at_most(error, 0.1, "rad/s", digits=2, of=of)
            for error, of in zip(settled, ("MIMO-PID", "PIDs"), strict=True)
        ],
    }


def _saved(mimo: float, pid: float, unit: str, stronger: float) -> Found:
    saved = 100.0 * analysis.improvement(mimo, pid)
    row = at_least(saved, 15.0, "% less", digits=2, reason=f"{stronger:.3g} {unit} with gains x 1.5")
    return Found(f"{mimo:.3g} and {pid:.3g} {unit}: {row.obtained}", row.reach, row.holds, row.reason)


def _demand(results: Results) -> Found:
    torque = float(results["left_drive.motor_torque"][300 : _UPHILL_ENDS + 1].max())
    return at_most(torque, InductionMotorDrive.Parameters().maximum_torque, "N·m")


def largest_error(results: Results) -> float:
    """Return the largest error of a wheel's speed [rad/s] while the car turns right, from 2 to 3 s."""
    rows = (results.time >= 2.0) & (results.time < 3.0)
    return max(float(np.abs(results[f"controller.{side}_error"][rows]).max()) for side in ("left", "right"))


def after_jumps(results: Results) -> float:
    """Return the largest error of a wheel's speed [rad/s] in that curve, once the jump is over."""
    rows = (results.time >= 2.0 + _JUMP_IS_OVER) & (results.time < 3.0)
    return max(float(np.abs(results[f"controller.{side}_error"][rows]).max()) for side in ("left", "right"))


class Launch(NamedTuple):
    """A launch: times [s] to 99 % and from 10 % to 90 % of the speed, overshoot [%], final error [km/h]."""

    time: float
    rise: float
    overshoot: float
    behind: float


def launch(results: Results) -> Launch:
    """Return the numbers of a launch to 60 km/h."""
    time, speed = results.time, results["vehicle.speed"]
    begin, end = (analysis.time_to_speed(time, speed, SPEED, share) for share in (0.1, 0.9))
    return Launch(
        analysis.time_to_speed(time, speed, SPEED),
        end - begin,
        100.0 * max(0.0, float(speed.max()) / SPEED - 1.0),
        KMH * float(SPEED - speed[-1]),
    )


def contradictions(found: Mapping[str, Any]) -> Findings:
    """Return what comes out in the place of the numbers that the paper's own data contradict."""
    rows: dict[str, Found] = {"reciprocal": _reciprocal(found), "derivative gain": _derivative(found)}
    able = analysis.grip_limit(_CAR, TORQUE_LIMIT)
    for name, label in (("mimo", "MIMO-PID"), ("pid", "PIDs")):
        run, start = maneuver(found[name]), launch(found[f"launch {name}"])
        rise = of_print(f"rise {label}")
        needed = analysis.acceleration_of_rise(SPEED, rise)
        end = KMH * float(SPEED - found[name]["vehicle.speed"][-1])
        rows |= {
            f"distance {label}": _distance(run.distance, f"distance {label}"),
            f"rise {label}": holds(
                f"{start.rise:.2f} s; {rise:.2f} s need {needed:.1f} g of {able:.2f} g", needed > able
            ),
            f"overshoot {label}": holds(
                f"{start.overshoot:.2f} %", start.overshoot < 0.1, "below 0.1 % from a standstill"
            ),
            f"speed error {label}": Found(
                f"{start.behind:.2f} km/h 8 s after a standstill; {end:.2f} km/h at 10 s, downhill"
            ),
        }
    text = "distance PIDs, text"
    rises = [launch(found[f"launch {name}"]).rise for name in ("mimo", "pid")]
    rows["rise"] = holds(f"{rises[0]:.2f} and {rises[1]:.2f} s", abs(rises[0] - rises[1]) < 0.01)
    return rows | {text: _distance(maneuver(found["pid"]).distance, text)}


def _distance(distance: float, by: str) -> Found:
    takes = of_print(by) / SPEED
    return holds(f"{distance:.1f} m in 10 s; the printed one takes {takes:.1f} s", takes > 20.0)


def _reciprocal(found: Mapping[str, Any]) -> Found:
    behind = KMH * float(SPEED - found["reciprocal"]["vehicle.speed"][_UPHILL_ENDS])
    return holds(f"speed {behind:.1f} km/h low for as long as the slope lasts", behind > 0.5)


def _derivative(found: Mapping[str, Any]) -> Found:
    wild = found["derivative"]
    stuck = 100.0 * float(np.mean(np.abs(wild["controller.left_torque"]) >= TORQUE_LIMIT - 0.1))
    dips = [maneuver(wild).dip, *(found[f"derivative {step:g} s"] for step in FINE_STEPS)]
    plain = maneuver(found["pid"]).dip
    lag = InductionMotorDrive.Parameters().time_constant
    gain = of_print("derivative gain")
    growth = [analysis.derivative_growth(_CAR, gain, lag, step) for step in (0.01, *FINE_STEPS)]
    return holds(
        f"dip {dips[0]:.1f} km/h, torque at a limit in {stuck:.0f} % of the samples; dip {dips[1]:.1f} and "
        f"{dips[2]:.1f} km/h at 1 and 10 kHz",
        min(dips) > 3.0 * plain,
        reason="behind the drive's lag an error grows by {:.0f}, {:.0f} and {:.0f} a sample".format(*growth),
    )
