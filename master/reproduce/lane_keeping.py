"""Optimal lane keeping control of a 4WS electric vehicle: matrices, poles, the step, and what delay does."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from ...cosim.system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from ...models import lane_keeping_analysis as analysis
from ...models.lane_keeping_controller import LaneKeepingController
from ..simulation import simulate
from ..studies.parallel import Task
from .page import Page, Paper, Picture, PublishedNumber, at_most, holds, near, not_reproducible

_P = LaneKeepingController.Parameters()
_TARGET = 0.3  # m
_STEP = 200  # the reference steps at 2 s
_SOURCE = "Optimal lane keeping control of a 4WS electric vehicle (2-DOF bicycle model, LQ controller)"


def _runs() -> tuple[Task[Any], ...]:
    one_late = {"parameters": {"controller.delay_steps": 1}}
    return (
        Task("bus", simulate, ("lane_keeping", "step"), {"stop_time": 26.0}),
        Task("ideal", simulate, ("lane_keeping", "step"), {"ideal": True}),
        Task("one", simulate, ("lane_keeping", "step"), {"ideal": True} | one_late),
        Task("two", simulate, ("lane_keeping", "delayed"), {"ideal": True}),
    )


def _page(found: dict[str, Any]) -> Page:
    return Page(
        name="lane_keeping",
        title="Lane keeping of a four-wheel-steered vehicle",
        source=_SOURCE,
        about=(
            "An LQ controller steers front and rear axle from lateral velocity, heading, yaw rate and "
            "lateral displacement. Gain and prefilter are computed from the vehicle's data, with 1380 kg in "
            "place of the printed 1280, which does not give the printed A and B. The reference of the "
            "displacement steps to 0.3 m at 2 s."
        ),
        rows=(*_matrix_rows(), *_step_rows(found), *_delay_rows(found), *_other_rows()),
        pictures=_pictures(found),
        commands=(
            "evcosim run lane_keeping",
            "evcosim run lane_keeping --ideal",
            "evcosim run lane_keeping --scenario delayed --ideal",
        ),
    )


def _matrix_rows() -> list[PublishedNumber]:
    published = analysis.PUBLISHED
    pairs = {
        "A": (_P.a, published.a),
        "B": (_P.b, published.b),
        "K": (_P.gain, published.gain),
        "S": (_P.prefilter, published.prefilter),
    }
    rows = [
        at_most(
            f"{name}: largest difference to the printed entries",
            "4 decimals",
            _difference(*pair),
            5e-5,
            digits=2,
        )
        for name, pair in pairs.items()
    ]
    poles = np.sort_complex(np.array(published.poles))
    error = float(np.abs(analysis.closed_loop_poles(_P) - poles).max())
    shown = "-55.9664 ± 6.7568i, -3.2296 ± 3.1087i"
    rows.append(at_most("closed-loop poles: largest difference", shown, error, 1e-4, "1/s", digits=2))
    rank = analysis.controllability_rank(_P)
    rows.append(holds("rank of the controllability matrix", "4", "4", str(rank), rank == 4))
    return rows


def _difference(ours: Any, printed: Any) -> float:
    return float(np.abs(np.array(ours) - np.array(printed)).max())


def _step_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    times, states = analysis.step_response(_P, _TARGET, 4.0)
    ideal, bus = found["ideal"], found["bus"]
    beta, late = ideal["vehicle.displacement"], bus["vehicle.displacement"][bus.time > 6.0]
    return [
        near("displacement at 6 s", "zero steady-state error", float(beta[-1]), _TARGET, 1e-4, "m", digits=7),
        near(
            "overshoot, continuous loop",
            "-",
            100.0 * analysis.overshoot(states[:, 3], _TARGET),
            3.8,
            0.1,
            "%",
        ),
        near("overshoot at 100 Hz", "-", 100.0 * analysis.overshoot(beta, _TARGET), 3.78, 0.1, "%"),
        near("2 % settling time", "-", analysis.settling_time(times, states[:, 3], _TARGET), 1.33, 0.02, "s"),
        near("δ_f just after the step", "-", _angle(ideal, "front"), -0.2820, 1e-4, "rad"),
        near("δ_r just after the step", "-", _angle(ideal, "rear"), 0.1023, 1e-4, "rad"),
        at_most("ripple of the displacement over the bus", "-", 1e3 * float(np.ptp(late)), 6.0, "mm"),
        at_most("mean error over the bus", "-", 1e3 * abs(float(late.mean()) - _TARGET), 3.0, "mm", digits=2),
    ]


def _angle(results: Any, axle: str) -> float:
    return float(results[f"controller.{axle}_steering_angle"][_STEP])


def _delay_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    one = 100.0 * analysis.overshoot(found["one"]["vehicle.displacement"], _TARGET)
    growth = float(np.abs(found["two"]["vehicle.displacement"]).max())
    radius = analysis.spectral_radius(_P, 2)
    return [
        near("one more step of delay: overshoot", "-", one, 3.7, 0.1, "%"),
        near("two more steps: spectral radius", "-", radius, 1.0225, 1e-4, digits=5),
        holds(
            "two more steps: the run", "-", "diverges", f"displacement up to {growth:.1f} m", growth > 10.0
        ),
    ]


def _other_rows() -> list[PublishedNumber]:
    norm = float(np.abs(np.array(_P.gain)).max())
    return [
        not_reproducible(
            "K-hat",
            "(0.1082 0.1279 1.1843 0.7593)",
            f"K with entries up to {norm:.2f}",
            "it contradicts the paper's own K, which comes out to four decimals",
        )
    ]


def _pictures(found: dict[str, Any]) -> tuple[Picture, ...]:
    ideal = found["ideal"]
    return (
        Picture("fig7", "Fig. 7: lateral velocity, heading and yaw rate", figures.draw(ideal, _STATES)),
        Picture("fig8", "Fig. 8: front and rear steering angle", figures.draw(ideal, _ANGLES)),
        Picture("fig9", "Fig. 9: lateral displacement", figures.draw(ideal, _DISPLACEMENT)),
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
_ANGLES = FigureSpec(
    title="Lane keeping: steering angles",
    panels=[
        _panel("Front", "deg", ("vehicle.front_steering_angle", "δ_f")),
        _panel("Rear", "deg", ("vehicle.rear_steering_angle", "δ_r")),
    ],
)
_DISPLACEMENT = FigureSpec(
    title="Lane keeping: lateral displacement",
    panels=[
        _panel(
            "Displacement",
            "m",
            ("controller.displacement_reference", "reference"),
            ("vehicle.displacement", "β"),
        )
    ],
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
