"""Two in-wheel motors and an electronic differential: MIMO-PID against PID, and a table of contradictions."""

from __future__ import annotations

from typing import Any

from ...cosim.interface import Value
from ...cosim.results.results import Results
from ...models import multi_drive_analysis as analysis
from ...models.constants import KMH
from ...models.wheel_speed_controller import WheelSpeedController
from ..simulation import simulate
from ..studies.parallel import Task
from . import multi_drive_cases as cases
from . import multi_drive_numbers as numbers
from .multi_drive_numbers import DENSITY, FINE_STEPS, largest, launch, maneuver, of_print
from .multi_drive_pictures import Effect, pictures
from .page import Findings, Found, Page, Paper, Picture, at_most, holds, near, page
from .sampling import sampled

_FAIR = "the published comparison rewards the gain and not the coupling"
_LAST_EVENT = 5.0  # s
_PID: dict[str, Value] = {"controller.coupling": 0.0}
_IDEAL: dict[str, Value] = {"left_drive.ideal": True, "right_drive.ideal": True}
_COUPLINGS = (0.0, 0.25, 0.5, 0.75, 0.9, 1.0)


def _runs() -> tuple[Task[Any], ...]:
    controllers: dict[str, dict[str, Value]] = {"mimo": {}, "pid": _PID, "stronger": _gains(1.5)}
    two = {name: controllers[name] for name in ("mimo", "pid")}
    return (
        *(_run(name, change) for name, change in controllers.items()),
        *(_run(f"launch {name}", change, "launch") for name, change in two.items()),
        *(_run(f"{name}, ideal drives", change | _IDEAL) for name, change in two.items()),
        *(_run(f"{name}, late", change, algorithm="jacobi") for name, change in two.items()),
        _run("density", {"vehicle.air_density": DENSITY}, stop_time=0.01),
        _run("derivative", _IDEAL | {"controller.derivative_gain": of_print("derivative gain")}),
        *(Task(f"derivative {step:g} s", _dip_at, (step,)) for step in FINE_STEPS),
        _run("reciprocal", _IDEAL | {"controller.reciprocal_integral": True}),
        _run("machine 3 ms", {}, ideal=True),
        *(_run(f"ideal {ms} ms", _lag(ms) | _IDEAL, ideal=True) for ms in (1, 3, 6)),
        *(Task(f"coupling {kappa}", _with_coupling, (kappa,)) for kappa in _COUPLINGS),
        *cases.tasks(),
    )


def _run(
    name: str, parameters: dict[str, Value], scenario: str = "curve_and_slope", **options: Any
) -> Task[Any]:
    return Task(name, simulate, ("multi_drive", scenario), {"parameters": parameters, **options})


def _lag(milliseconds: int) -> dict[str, Value]:
    return {f"{side}_drive.time_constant": 1e-3 * milliseconds for side in ("left", "right")}


def _gains(factor: float) -> dict[str, Value]:
    """Return the parameters of PIDs with `factor` times the published gains."""
    p = WheelSpeedController.Parameters()
    gains = {"proportional_gain": p.proportional_gain, "integral_gain": p.integral_gain}
    return _PID | {f"controller.{name}": factor * gain for name, gain in gains.items()}


def _with_coupling(kappa: float) -> tuple[Effect, Effect]:
    """Return the effect of the MIMO-PID with a coupling, and that of PIDs with 1 + kappa times the gain."""
    changes: tuple[dict[str, Value], ...] = ({"controller.coupling": kappa}, _gains(1.0 + kappa))
    mimo, pid = (_effect(simulate("multi_drive", parameters=change | _IDEAL)) for change in changes)
    return mimo, pid


def _effect(results: Results) -> Effect:
    found = maneuver(results)
    return Effect(
        found.dip, found.error, largest(results["left_drive.torque"], results["right_drive.torque"])
    )


def _dip_at(step_size: float) -> float:
    """Return the dip [km/h] up to the last event with the printed K_d, sampled each `step_size` [s]."""
    parameters = _IDEAL | {"controller.derivative_gain": of_print("derivative gain")}
    system = sampled("multi_drive", step_size)
    return maneuver(simulate(system, parameters=parameters, ideal=True, stop_time=_LAST_EVENT)).dip


def _pictures(found: dict[str, Any]) -> tuple[Picture, ...]:
    return pictures(found, {kappa: found[f"coupling {kappa}"] for kappa in _COUPLINGS})


def _page(found: dict[str, Any]) -> Page:
    return page(
        "multi_drive",
        title="Electronic differential and MIMO-PID for two in-wheel induction motors",
        about=(
            "A car of 3904 kg with an induction motor at each rear wheel drives 60 km/h through a right-hand "
            "curve, up a slope of 10 %, then through a left-hand curve downhill. An electronic differential "
            "gives each wheel its reference; PIDs, or one MIMO-PID that also sees the other wheel's error "
            "(κ = 0.5), hold them over a bus at 100 Hz. The paper prints parameters, equations and a table, "
            "but neither tires, nor steering angle, nor what the cross error is: these are chosen. Of its "
            "Figs. 4 to 19 no numbers are printed but two maxima, so they can be compared with the pictures "
            "below by eye only. K_d is 0 in place of the printed 2500."
        ),
        found={
            **numbers.inputs(found["mimo"]),
            **numbers.differential(found["mimo"]),
            **numbers.torques(found),
            **numbers.comparison(found),
            **numbers.contradictions(found),
            **cases.findings(found),
            "launch torque": near(
                float(found["launch mimo"]["left_drive.motor_torque"].max()),
                of_print("launch torque"),
                0.1,
                "N·m",
            ),
        },
        own=_own(found),
        pictures=_pictures(found),
        commands=(
            "evcosim run multi_drive",
            "evcosim run multi_drive --set controller.coupling=0",
            "evcosim run multi_drive --set controller.coupling=0 --set controller.proportional_gain=1800"
            " --set controller.integral_gain=600",
            "evcosim run multi_drive --set left_drive.ideal=true --set right_drive.ideal=true",
            "evcosim run multi_drive --set vehicle.air_density=1.164",
            "evcosim run multi_drive -s slope",
            "evcosim run multi_drive -s right_curve",
            "evcosim run multi_drive -s battery",
            "evcosim run multi_drive -s launch",
        ),
    )


def _own(found: dict[str, Any]) -> Findings:
    results = found["mimo"]
    left, right = (float(results[f"differential.{side}_reference"][-1]) for side in ("left", "right"))
    turning = "at 1.5° to the left and 60 km/h"
    return {
        f"ω₁ {turning}": near(left, 45.933, 5e-4, "rad/s", digits=5),
        f"ω₂ {turning}": near(right, 46.660, 5e-4, "rad/s", digits=5),
        "torque of the air at 60 km/h and 1.2 kg/m³": near(
            float(results["vehicle.aerodynamic_torque"][0]), 96.05, 5e-3, "N·m"
        ),
        "torque of rolling at 60 km/h": near(float(results["vehicle.rolling_torque"][0]), 137.9, 0.05, "N·m"),
        "torque of a slope of 10 %": near(float(results["vehicle.slope_torque"].max()), 1372.0, 0.5, "N·m"),
        **_controllers(found),
        **cases.own(found),
        **_launches(found),
        **_drives(found),
    }


def _controllers(found: dict[str, Any]) -> Findings:
    runs = {"MIMO-PID": "mimo", "PIDs": "pid", "PIDs with gains x 1.5": "stronger"}
    mimo, stronger = maneuver(found["mimo"]), maneuver(found["stronger"])
    dip, error = "dip of the speed on the slope", "rms error of the left wheel's speed, from 2 s on"
    left = "MIMO-PID below PIDs with gains x 1.5"
    return {
        dip: [
            near(maneuver(found[run]).dip, expected, 5e-3, "km/h", digits=3, of=of)
            for (of, run), expected in zip(runs.items(), (0.91, 1.09, 0.91), strict=True)
        ],
        error: [
            near(maneuver(found[run]).error, expected, 5e-4, "rad/s", digits=3, of=of)
            for (of, run), expected in zip(runs.items(), (0.266, 0.396, 0.267), strict=True)
        ],
        left: [
            at_most(100.0 * analysis.improvement(a, b), 1.0, "%", digits=2, of=of, reason=_FAIR)
            for of, a, b in (("dip", mimo.dip, stronger.dip), ("rms error", mimo.error, stronger.error))
        ],
        "distance in 10 s": [
            near(maneuver(found[run]).distance, 167.0, 1.0, "m", of=of) for of, run in list(runs.items())[:2]
        ],
    }


def _launches(found: dict[str, Any]) -> Findings:
    seconds = {of: launch(found[f"launch {run}"]).time for of, run in (("MIMO-PID", "mimo"), ("PIDs", "pid"))}
    return {
        "0 to 60 km/h (99 %)": [
            holds(f"{time:.2f} s", 5.3 <= time <= 6.5, "5.3 to 6.5 s", of=of) for of, time in seconds.items()
        ]
    }


def _drives(found: dict[str, Any]) -> Findings:
    variants = (("ideal drives", "ideal drives", 5e-3), ("late", "one more sample late", 1e-2))
    dips = {
        f"dip, {label}": [
            near(maneuver(found[f"{run}, {variant}"]).dip, dip, reach, "km/h", digits=3, of=of)
            for run, of, dip in (("mimo", "MIMO-PID", 0.91), ("pid", "PIDs", 1.09))
        ]
        for variant, label, reach in variants
    }
    return dips | _machine(found["machine 3 ms"], {ms: found[f"ideal {ms} ms"] for ms in (1, 3, 6)})


def _machine(machine: Results, ideal: dict[int, Results]) -> dict[str, list[Found]]:
    """Compare the dq machine with the ideal drive of its bandwidth, and two bandwidths with each other."""

    def apart(a: Results, b: Results) -> float:
        return max(
            largest(a[f"{side}_drive.torque"], b[f"{side}_drive.torque"]) for side in ("left", "right")
        )

    faster, slower = apart(ideal[1], ideal[3]), apart(ideal[6], ideal[3])
    reason = f"15 % of what a lag of 1 ms in place of 3 makes, {faster:.0f} N·m; 6 ms make {slower:.0f} N·m"
    speed = KMH * largest(machine["vehicle.speed"], ideal[3]["vehicle.speed"])
    return {
        "dq machine and ideal drive, without the bus, differ by": [
            at_most(apart(machine, ideal[3]), 0.15 * faster, "N·m", digits=2, of="torque", reason=reason),
            at_most(speed, 1e-3, "km/h", digits=2, of="speed"),
        ]
    }


PAPER = Paper("multi_drive", _runs, _page, _pictures)
