"""Optimal lane keeping control of a 4WS electric vehicle: matrices, poles, the step, and what delay does."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...cosim.results.results import Results
from ...cosim.row_store import Array
from ...models import lane_keeping_analysis as analysis
from ...models import lane_keeping_limits as limits
from ...models.lane_keeping_controller import LaneKeepingController
from ..simulation import Simulation, simulate
from ..studies.parallel import Task
from . import printed
from .lane_keeping_pictures import STEERING, pictures
from .page import Finding, Findings, Found, Page, Paper, apart, at_most, holds, near, page

_P = LaneKeepingController.Parameters()
_TARGET = 0.3  # m
_STEP = 200  # the reference steps at 2 s
_AXLES = ("front", "rear")
_HALF_A_DIGIT = 5e-5  # of numbers printed with four decimals
_BEST_FRICTION = 1.3  # of a dry road
_STATE = ("lateral_velocity", "heading_angle", "yaw_rate", "displacement")
_WEIGHTS = {"four": 1.0, "two": 1e6}  # of the rear angle: two steered wheels are four of which two cost much
_DISTURBANCES = ("crosswind", "blowout")
_OUTPUTS = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))  # y' and theta, those of the text
_ROOM = 0.85  # m: half of what a lane of 3.5 m leaves beside a car of 1.8 m


def _runs() -> tuple[Task[Any], ...]:
    one_late = {"parameters": {"controller.delay_steps": 1}}
    return (
        Task("bus", simulate, ("lane_keeping", "step"), {"stop_time": 26.0}),
        Task("ideal", simulate, ("lane_keeping", "step"), {"ideal": True}),
        Task("one", simulate, ("lane_keeping", "step"), {"ideal": True} | one_late),
        Task("two", simulate, ("lane_keeping", "delayed"), {"ideal": True}),
        Task("step two", simulate, ("lane_keeping", "two_wheel_steering"), {"ideal": True}),
        *(
            Task(
                f"{scenario} {steering}",
                simulate,
                ("lane_keeping", scenario),
                {"parameters": {"controller.rear_steering_weight": weight}},
            )
            for scenario in _DISTURBANCES
            for steering, weight in _WEIGHTS.items()
        ),
        *(Task(f"{scenario} none", _unsteered, (scenario,)) for scenario in _DISTURBANCES),
    )


def _unsteered(scenario: str) -> float:
    """Return how far [m] the vehicle gets from its lane in a scenario when its wheels stay straight."""
    with Simulation("lane_keeping", scenario) as sim:
        for axle in ("front", "rear"):
            sim.override(f"vehicle.{axle}_steering_angle", 0.0)
        sim.run()
        return _farthest(sim.results)


def _farthest(results: Results) -> float:
    return float(np.abs(results["vehicle.displacement"]).max())


def _page(found: dict[str, Any]) -> Page:
    return page(
        "lane_keeping",
        title="Lane keeping of a four-wheel-steered vehicle",
        about=(
            "An LQ controller steers front and rear axle from lateral velocity, heading, yaw rate and "
            "lateral displacement. Gain and prefilter are computed from the vehicle's data, with the 1380 kg "
            "of the paper's listing in place of the 1280 of its list of data, which does not give the "
            "printed A and B. The reference of the displacement steps to 0.3 m at 2 s."
        ),
        found={**_models(), **_matrices(), **_run(found), **_steering(found)},
        own=_own(found),
        pictures=pictures(found),
        commands=(
            "evcosim run lane_keeping",
            "evcosim run lane_keeping --ideal",
            "evcosim run lane_keeping --scenario two_wheel_steering --ideal",
            "evcosim run lane_keeping --scenario crosswind",
            "evcosim run lane_keeping --scenario blowout",
            "evcosim run lane_keeping --scenario blowout --set controller.rear_steering_weight=1e6",
            "evcosim run lane_keeping --scenario delayed --ideal",
        ),
    )


def _printed(by: str) -> Array:
    """Return what the paper prints, as an array of the shape of its matrix."""
    return np.array(printed.row("lane_keeping", by).value, dtype=float)


def _four_digits(by: str, ours: Any) -> Found:
    return apart(float(np.abs(np.array(ours) - _printed(by)).max()), _HALF_A_DIGIT, digits=2)


def _models() -> dict[str, Found]:
    """Return what the equations give: rows of A and B, the misprints, and the controller's design."""
    a, b = _P.a, _P.b
    rows = {"lateral motion": 0, "yaw motion": 2}
    equations = {
        by: holds(
            f"{a[i][0]:.4f}, {a[i][2]:.4f}; {b[i][0]:.4f}, {b[i][1]:.4f}",
            bool(np.abs(np.append(a[i], b[i]) - np.append(_printed("A")[i], _printed("B")[i])).max() <= 5e-5),
            "the printed entries ± 5e-05",
        )
        for by, i in rows.items()
    }
    light = analysis.Parameters(mass=printed.row("lane_keeping", "other mass").number)
    off = max(float(np.abs(light.a - _printed("A")).max()), float(np.abs(light.b - _printed("B")).max()))
    literal = _P.speed + (_P.speed + a[0][2]), a[2][0]  # (12) as it is printed
    smallest = analysis.smallest_eigenvalue(_P)
    return equations | {
        "a13": _contradiction(literal[0], _printed("A")[0, 2], f"; {a[0][2]:.4f} with the minus"),
        "a33": _contradiction(literal[1], _printed("A")[2, 2], f"; {a[2][2]:.4f} by (8)"),
        "other mass": holds(f"{off:.2f} with 1280 kg", off > _HALF_A_DIGIT),
        "definite": holds(f"{smallest:.2g}", smallest > 0.0, "above 0"),
        "riccati": at_most(analysis.riccati_residual(_P), 1e-9, digits=2),
        "cost": _cost(),
    }


def _contradiction(literal: float, entry: float, instead: str) -> Found:
    return holds(f"literally {literal:.4f}{instead}", abs(literal - entry) > _HALF_A_DIGIT)


def _cost() -> Found:
    by_value, by_integral = analysis.least_cost(_P, _TARGET), analysis.cost_of_step(_P, _TARGET)
    return holds(
        f"{by_value:.6f} and {by_integral:.6f}", abs(by_value - by_integral) <= 1e-6, "equal within 1e-06"
    )


def _matrices() -> dict[str, Found]:
    poles = analysis.closed_loop_poles(_P)
    pairs = {"fast poles": poles[:2], "slow poles": poles[2:]}
    rank = analysis.controllability_rank(_P)
    k_hat = np.sort(np.abs(_printed("K-hat")))
    off = np.abs(np.sort(np.abs(_P.gain), axis=1) - k_hat).max(axis=1).min()
    finals = analysis.final_states(_P, _printed("Bc"))[3] * _TARGET
    singular = analysis.smallest_singular_value(_P, _OUTPUTS)
    seen = limits.observability_rank(_P, _OUTPUTS)
    return {
        "A": _four_digits("A", _P.a),
        "B": _four_digits("B", _P.b),
        "K": _four_digits("K", _P.gain),
        "S": _four_digits("S", _P.prefilter),
        "Q_r": _four_digits("Q_r", analysis.controllability_matrix(_P) / 1e4),
        "rank": holds(str(rank), rank == printed.row("lane_keeping", "rank").number, "4"),
        "K-hat": holds(f"the nearest row of K, sorted and without signs, is {off:.2f} away", off > 0.01),
        "Bc": holds(
            f"{1e3 * finals[0]:.1f} and {1e3 * finals[1]:.1f} mm", bool(np.abs(finals - _TARGET).min() > 0.01)
        ),
        "outputs": holds(f"there is none: C (A - B K)^-1 B is singular, to {singular:.0e}", singular < 1e-12),
        "observability": holds(f"rank {seen} of 4", seen == 3),
        "stable": holds(
            f"largest real part {poles.real.max():.4f} 1/s", bool(poles.real.max() < 0.0), "below 0"
        ),
        **{
            by: apart(float(np.abs(pair - [complex(re, -im), complex(re, im)]).max()), 1e-4, "1/s", digits=2)
            for by, pair in pairs.items()
            for re, im in [_printed(by)]
        },
    }


def _run(found: dict[str, Any]) -> dict[str, Found]:
    """Return what the step gives, at 100 Hz and without the bus where nothing else is said."""
    ideal = found["ideal"]
    beta, reference = ideal["vehicle.displacement"], ideal["controller.displacement_reference"]
    times, states = analysis.step_response(_P, _TARGET, 4.0)
    settled = analysis.settling_time(times, states[:, 3], _TARGET)
    begin = float(ideal.time[np.flatnonzero(reference)[0]])
    moving = _STATE[:3]
    highest = [float(np.abs(ideal[f"vehicle.{name}"]).max()) for name in moving]
    return {
        "steady state": near(float(beta[-1]), _TARGET, 1e-4, "m", digits=7),
        "settling": at_most(settled, 2.0, "s"),
        "step time": holds(f"{begin:g} s", begin == printed.row("lane_keeping", "step time").number),
        "end": holds(f"{ideal.time[-1]:g} s", ideal.time[-1] == printed.row("lane_keeping", "end").number),
        "step": holds(f"{reference[-1]:g} m", reference[-1] == printed.row("lane_keeping", "step").number),
        "axes": holds(
            f"0 to {beta.max():.3f} m in {ideal.time[-1]:g} s",
            bool(beta.min() >= 0.0 and beta.max() <= 0.35),
            "0 to 0.35 m, 0 to 6 s",
        ),
        "limited": holds(
            f"{highest[0]:.3f} m/s, {highest[1]:.4f} rad, {highest[2]:.3f} rad/s",
            bool(all(abs(ideal[f"vehicle.{name}"][-1]) < 1e-3 for name in moving)),
            "all back at 0 at 6 s",
        ),
        "demand": _demand(ideal),
        "final state": holds(f"{beta[-1]:.4f} m", abs(float(beta[-1]) - _TARGET) < 1e-4),
        **{f"{axle} angle": _first_angle(ideal, axle) for axle in _AXLES},
    }


def _demand(results: Results) -> Found:
    """Return what the step asks of the front tires, and the lateral acceleration that it gives."""
    states = np.column_stack([results[f"vehicle.{name}"] for name in _STATE])
    angles = np.column_stack([results[f"vehicle.{axle}_steering_angle"] for axle in ("front", "rear")])
    forces = limits.side_forces(_P, states, angles)
    force, load = float(np.abs(forces[:, 0]).max()), float(limits.axle_loads(_P)[0])
    acceleration = float(np.abs(limits.lateral_acceleration(_P, forces)).max())
    return holds(
        f"{1e-3 * force:.1f} kN on an axle that carries {1e-3 * load:.1f} kN: μ = {force / load:.1f}; "
        f"lateral acceleration {acceleration:.1f} m/s²",
        force / load > _BEST_FRICTION,
    )


def _steering(found: dict[str, Any]) -> Findings:
    """Return what two and four steered wheels do, alone and where something disturbs the vehicle."""
    slow = {steering: _slow_pole(weight) for steering, weight in _WEIGHTS.items()}
    damping = {steering: -pole.real / abs(pole) for steering, pole in slow.items()}
    alone = found["step two"]["vehicle.displacement"]
    return {
        "two wheels": holds(
            f"{1e3 * abs(alone[-1] - _TARGET):.1f} mm left at 6 s, overshoot "
            f"{100.0 * analysis.overshoot(alone, _TARGET):.1f} %",
            abs(alone[-1] - _TARGET) < 2e-3 and analysis.overshoot(alone, _TARGET) < 0.1,
            "at most 2 mm, 10 %",
        ),
        "damping": [
            holds(
                f"{damping[steering]:.3f}, slow poles {_shown(slow[steering])} 1/s",
                better,
                "more by four, and faster",
                of=text,
            )
            for better in (damping["four"] > damping["two"] and slow["four"].real < slow["two"].real,)
            for steering, text in STEERING.items()
        ],
        "disturbances": [
            holds(
                f"{_farthest(found[f'{scenario} four']):.3f} m from the lane, "
                f"{found[f'{scenario} none']:.1f} m without steering",
                _farthest(found[f"{scenario} four"]) < _ROOM < found[f"{scenario} none"],
                f"at most {_ROOM} m, the room of a lane",
                of=scenario,
            )
            for scenario in _DISTURBANCES
        ],
    }


def _slow_pole(rear_weight: float) -> complex:
    """Return the slowest pole [1/s] of the loop, the one above the real axis."""
    return complex(analysis.closed_loop_poles(analysis.Parameters(rear_steering_weight=rear_weight))[-1])


def _shown(pole: complex) -> str:
    return f"{pole.real:.2f} ± {pole.imag:.2f}i"


def _own(found: dict[str, Any]) -> dict[str, Finding]:
    times, states = analysis.step_response(_P, _TARGET, 4.0)
    beta, bus = found["ideal"]["vehicle.displacement"], found["bus"]
    late = bus["vehicle.displacement"][bus.time > 6.0]
    growth = float(np.abs(found["two"]["vehicle.displacement"]).max())
    return {
        "overshoot, continuous loop": near(100.0 * analysis.overshoot(states[:, 3], _TARGET), 3.8, 0.1, "%"),
        "overshoot at 100 Hz": near(100.0 * analysis.overshoot(beta, _TARGET), 3.78, 0.1, "%"),
        "2 % settling time": near(analysis.settling_time(times, states[:, 3], _TARGET), 1.33, 0.02, "s"),
        "ripple of the displacement over the bus": at_most(1e3 * float(np.ptp(late)), 6.0, "mm"),
        "mean error over the bus": at_most(1e3 * abs(float(late.mean()) - _TARGET), 3.0, "mm", digits=2),
        "one more step of delay: overshoot": near(
            100.0 * analysis.overshoot(found["one"]["vehicle.displacement"], _TARGET), 3.7, 0.1, "%"
        ),
        "two more steps: spectral radius": near(analysis.spectral_radius(_P, 2), 1.0225, 1e-4, digits=5),
        "two more steps: the run": holds(f"displacement up to {growth:.1f} m", growth > 10.0, "diverges"),
        **_own_steering(found),
    }


def _own_steering(found: dict[str, Any]) -> dict[str, Finding]:
    alone = found["step two"]
    beta, time = alone["vehicle.displacement"][_STEP:], alone.time[_STEP:] - alone.time[_STEP]
    poles = {"four": -3.2296 + 3.1087j, "two": -1.5468 + 1.6857j}
    widths = {"crosswind": (10.4, 104.1), "blowout": (9.9, 60.4)}  # mm, in the order of STEERING
    return {
        "slow poles": [
            holds(_shown(_slow_pole(_WEIGHTS[k])), abs(_slow_pole(_WEIGHTS[k]) - pole) < 1e-4, of=STEERING[k])
            for k, pole in poles.items()
        ],
        "two steered wheels: overshoot": near(100.0 * analysis.overshoot(beta, _TARGET), 5.02, 0.1, "%"),
        "two steered wheels: 2 % settling time": near(
            analysis.settling_time(time, beta, _TARGET), 2.70, 0.02, "s"
        ),
        **{
            f"{scenario}: displacement over the bus, peak to peak": [
                near(
                    1e3 * float(np.ptp(found[f"{scenario} {steering}"]["vehicle.displacement"])),
                    width,
                    0.02 * width,
                    "mm",
                    of=text,
                )
                for (steering, text), width in zip(STEERING.items(), both, strict=True)
            ]
            for scenario, both in widths.items()
        },
    }


def _first_angle(results: Results, axle: str) -> Found:
    """Return the angle just after the step, at which u = S r, with the S of the paper."""
    printed_angle = float(_printed("S")[_AXLES.index(axle), 1]) * _TARGET
    ours = float(results[f"controller.{axle}_steering_angle"][_STEP])
    return near(ours, printed_angle, _HALF_A_DIGIT * _TARGET, "rad", digits=5)


PAPER = Paper("lane_keeping", _runs, _page, pictures)
