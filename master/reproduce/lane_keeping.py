"""Optimal lane keeping control of a 4WS electric vehicle: matrices, poles, the step, and what delay does."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from ...cosim.row_store import Array
from ...cosim.system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from ...models import lane_keeping_analysis as analysis
from ...models.constants import GRAVITY
from ...models.lane_keeping_controller import LaneKeepingController
from ..simulation import simulate
from ..studies.parallel import Task
from . import printed
from .page import Found, Page, Paper, Picture, at_most, holds, near, page

_P = LaneKeepingController.Parameters()
_TARGET = 0.3  # m
_STEP = 200  # the reference steps at 2 s
_HALF_A_DIGIT = 5e-5  # of numbers printed with four decimals
_BEST_FRICTION = 1.3  # of a dry road
_STATE = ("lateral_velocity", "heading_angle", "yaw_rate")


def _runs() -> tuple[Task[Any], ...]:
    one_late = {"parameters": {"controller.delay_steps": 1}}
    return (
        Task("bus", simulate, ("lane_keeping", "step"), {"stop_time": 26.0}),
        Task("ideal", simulate, ("lane_keeping", "step"), {"ideal": True}),
        Task("one", simulate, ("lane_keeping", "step"), {"ideal": True} | one_late),
        Task("two", simulate, ("lane_keeping", "delayed"), {"ideal": True}),
    )


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
        found=_models() | _matrices() | _run(found),
        own=_own(found),
        pictures=_pictures(found),
        commands=(
            "evcosim run lane_keeping",
            "evcosim run lane_keeping --ideal",
            "evcosim run lane_keeping --scenario delayed --ideal",
        ),
    )


def _printed(by: str) -> Array:
    """Return what the paper prints, as an array of the shape of its matrix."""
    return np.array(printed.row("lane_keeping", by).value, dtype=float)


def _four_digits(by: str, ours: Any) -> Found:
    return at_most(float(np.abs(np.array(ours) - _printed(by)).max()), _HALF_A_DIGIT, digits=2)


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
    apart = max(float(np.abs(light.a - _printed("A")).max()), float(np.abs(light.b - _printed("B")).max()))
    literal = _P.speed + (_P.speed + a[0][2]), a[2][0]  # (12) as it is printed
    return equations | {
        "a13": _contradiction(literal[0], _printed("A")[0, 2], f"; {a[0][2]:.4f} with the minus"),
        "a33": _contradiction(literal[1], _printed("A")[2, 2], f"; {a[2][2]:.4f} by (8)"),
        "other mass": holds(f"{apart:.2f} with 1280 kg", apart > _HALF_A_DIGIT),
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
    apart = np.abs(np.sort(np.abs(_P.gain), axis=1) - k_hat).max(axis=1).min()
    finals = analysis.final_states(_P, _printed("Bc"))[3] * _TARGET
    singular = analysis.smallest_singular_value(_P, ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)))
    return {
        "A": _four_digits("A", _P.a),
        "B": _four_digits("B", _P.b),
        "K": _four_digits("K", _P.gain),
        "S": _four_digits("S", _P.prefilter),
        "Q_r": _four_digits("Q_r", analysis.controllability_matrix(_P) / 1e4),
        "rank": holds(str(rank), rank == printed.row("lane_keeping", "rank").number, "4"),
        "K-hat": holds(f"the nearest row of K, sorted and without signs, is {apart:.2f} away", apart > 0.01),
        "Bc": holds(
            f"{1e3 * finals[0]:.1f} and {1e3 * finals[1]:.1f} mm", bool(np.abs(finals - _TARGET).min() > 0.01)
        ),
        "outputs": holds(f"there is none: C (A - B K)^-1 B is singular, to {singular:.0e}", singular < 1e-12),
        "stable": holds(
            f"largest real part {poles.real.max():.4f} 1/s", bool(poles.real.max() < 0.0), "below 0"
        ),
        **{
            by: at_most(
                float(np.abs(pair - [complex(re, -im), complex(re, im)]).max()), 1e-4, "1/s", digits=2
            )
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
    highest = [float(np.abs(ideal[f"vehicle.{name}"]).max()) for name in _STATE]
    force = 2.0 * _P.front_cornering_stiffness * abs(_angle(ideal, "front"))
    load = _P.mass * GRAVITY * _P.rear_axle_distance / (_P.front_axle_distance + _P.rear_axle_distance)
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
            bool(all(abs(ideal[f"vehicle.{name}"][-1]) < 1e-3 for name in _STATE)),
            "all back at 0 at 6 s",
        ),
        "demand": holds(
            f"{1e-3 * force:.1f} kN on an axle that carries {1e-3 * load:.1f} kN: μ = {force / load:.1f}",
            force / load > _BEST_FRICTION,
        ),
    }


def _own(found: dict[str, Any]) -> dict[str, Found]:
    times, states = analysis.step_response(_P, _TARGET, 4.0)
    beta, bus = found["ideal"]["vehicle.displacement"], found["bus"]
    late = bus["vehicle.displacement"][bus.time > 6.0]
    growth = float(np.abs(found["two"]["vehicle.displacement"]).max())
    return {
        "overshoot, continuous loop": near(100.0 * analysis.overshoot(states[:, 3], _TARGET), 3.8, 0.1, "%"),
        "overshoot at 100 Hz": near(100.0 * analysis.overshoot(beta, _TARGET), 3.78, 0.1, "%"),
        "2 % settling time": near(analysis.settling_time(times, states[:, 3], _TARGET), 1.33, 0.02, "s"),
        "δ_f just after the step": near(_angle(found["ideal"], "front"), -0.2820, 1e-4, "rad"),
        "δ_r just after the step": near(_angle(found["ideal"], "rear"), 0.1023, 1e-4, "rad"),
        "ripple of the displacement over the bus": at_most(1e3 * float(np.ptp(late)), 6.0, "mm"),
        "mean error over the bus": at_most(1e3 * abs(float(late.mean()) - _TARGET), 3.0, "mm", digits=2),
        "one more step of delay: overshoot": near(
            100.0 * analysis.overshoot(found["one"]["vehicle.displacement"], _TARGET), 3.7, 0.1, "%"
        ),
        "two more steps: spectral radius": near(analysis.spectral_radius(_P, 2), 1.0225, 1e-4, digits=5),
        "two more steps: the run": holds(f"displacement up to {growth:.1f} m", growth > 10.0, "diverges"),
    }


def _angle(results: Any, axle: str) -> float:
    return float(results[f"controller.{axle}_steering_angle"][_STEP])


def _pictures(found: dict[str, Any]) -> tuple[Picture, ...]:
    ideal = found["ideal"]
    return (
        Picture("fig7", "Fig. 7: desired lane and response of the vehicle", figures.draw(ideal, _LANE)),
        Picture("fig8", "Fig. 8: front steering angle", figures.draw(ideal, _FRONT)),
        Picture("fig9", "Fig. 9: rear steering angle", figures.draw(ideal, _REAR)),
        Picture(
            "states",
            "Beyond the paper: lateral velocity, heading and yaw rate",
            figures.draw(ideal, _STATES),
        ),
        Picture(
            "delay", "Beyond the paper: zero, one and two more steps of 10 ms of delay", _delay_figure(found)
        ),
    )


def _panel(label: str, unit: str, *signals: tuple[str, str]) -> PanelSpec:
    return PanelSpec(label=label, unit=unit, signals=[SignalSpec(name=n, label=text) for n, text in signals])


_STATES = FigureSpec(
    title="Lane keeping: lateral velocity, heading, yaw rate",
    panels=[
        _panel("Lateral velocity", "m/s", ("vehicle.lateral_velocity", "y'")),
        _panel("Heading", "deg", ("vehicle.heading_angle", "θ")),
        _panel("Yaw rate", "deg/s", ("vehicle.yaw_rate", "ω_z")),
    ],
)
_LANE = FigureSpec(
    title="Lane keeping: desired lane and response",
    panels=[
        _panel(
            "Displacement",
            "m",
            ("controller.displacement_reference", "desired lane"),
            ("vehicle.displacement", "vehicle"),
        )
    ],
)
_FRONT = FigureSpec(
    title="Lane keeping: front steering angle",
    panels=[_panel("Front", "deg", ("vehicle.front_steering_angle", "δ_f"))],
)
_REAR = FigureSpec(
    title="Lane keeping: rear steering angle",
    panels=[_panel("Rear", "deg", ("vehicle.rear_steering_angle", "δ_r"))],
)


def _delay_figure(found: dict[str, Any]) -> Any:
    with figures.canvas(2, height=2.6, title="Lane keeping: delay in the loop", share_x=True) as (
        figure,
        axes,
    ):
        for i, (name, label) in enumerate((("ideal", "none"), ("one", "one step"), ("two", "two steps"))):
            results = found[name]
            for row, limits in enumerate(((-0.05, 0.4), (-25.0, 25.0))):
                axes[row, 0].plot(
                    results.time, results["vehicle.displacement"], label=label, **figures.look(i)
                )
                axes[row, 0].set_ylim(*limits)
                axes[row, 0].set_ylabel("displacement [m]")
        axes[0, 0].legend(title="extra delay", loc="upper left", bbox_to_anchor=(1.01, 1.0))
        axes[1, 0].set_xlabel("time [s]")
        axes[1, 0].set_xlim(0.0, found["two"].time[-1])
    return figure


PAPER = Paper("lane_keeping", _runs, _page)
