"""The figures of the lane keeping paper, redrawn, and beyond it states, steering, disturbances and delay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from ...cosim.results.results import Results
from ...cosim.system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from .page import Picture

STEERING = {"four": "four wheels steer", "two": "two wheels steer"}
"""The runs of one maneuver by what steers, as they are named and as they are told."""

_SIGNALS = (
    ("displacement", "mm", 1e3),
    ("front_steering_angle", "deg", 180.0 / np.pi),
    ("rear_steering_angle", "deg", 180.0 / np.pi),
    ("yaw_rate", "deg/s", 180.0 / np.pi),
)
_HELD = ("front_steering_angle", "rear_steering_angle")  # from one sample to the next
_ANGLES = (-20.0, 10.0)  # deg, for Figs. 8 and 9 alike


def pictures(found: Mapping[str, Any]) -> tuple[Picture, ...]:
    """Return all pictures of the runs."""
    ideal = found["ideal"]
    steps = {"a step of 0.3 m": [ideal, found["step two"]]}
    disturbed = {
        text: [found[f"{name} {steering}"] for steering in STEERING]
        for name, text in (("crosswind", "crosswind of 15 m/s, 1 to 3 s"), ("blowout", "blow-out at 1 s"))
    }
    return (
        Picture.over_time("fig7", "Fig. 7: desired lane and response of the vehicle", ideal, _LANE),
        Picture.over_time("fig8", "Fig. 8: front steering angle", ideal, _angle("front")),
        Picture.over_time("fig9", "Fig. 9: rear steering angle", ideal, _angle("rear")),
        Picture.over_time("states", "Beyond the paper: lateral velocity, heading, yaw rate", ideal, _STATES),
        Picture(
            "steering",
            "Beyond the paper: the step with two and with four steered wheels",
            lambda: _compared("Lane keeping: two or four steered wheels", steps, 1.7),
        ),
        Picture(
            "disturbances",
            "Beyond the paper: crosswind, and a blow-out of the left front tire, over the bus",
            lambda: _compared("Lane keeping: crosswind, and a blown tire", disturbed, 1.9),
        ),
        Picture(
            "delay",
            "Beyond the paper: zero, one and two more steps of 10 ms of delay",
            lambda: _delay(found),
        ),
    )


def _panel(label: str, unit: str, *signals: tuple[str, str], **more: Any) -> PanelSpec:
    lines = [SignalSpec(name=name, label=text) for name, text in signals]
    return PanelSpec(label=label, unit=unit, signals=lines, **more)


_LANE = FigureSpec(
    title="Lane keeping: desired lane and response",
    panels=[
        _panel(
            "Displacement",
            "m",
            ("controller.displacement_reference", "desired lane"),
            ("vehicle.displacement", "displacement"),
        )
    ],
)
_STATES = FigureSpec(
    title="Lane keeping: lateral velocity, heading, yaw rate",
    panels=[
        _panel("Lateral velocity", "m/s", ("vehicle.lateral_velocity", "lateral velocity")),
        _panel("Heading", "deg", ("vehicle.heading_angle", "heading")),
        _panel("Yaw rate", "deg/s", ("vehicle.yaw_rate", "yaw rate")),
    ],
)


def _angle(axle: str) -> FigureSpec:
    return FigureSpec(
        title=f"Lane keeping: {axle} steering angle",
        panels=[_panel("Angle", "deg", (f"vehicle.{axle}_steering_angle", f"{axle} wheels"), limits=_ANGLES)],
    )


def _compared(title: str, maneuvers: Mapping[str, Sequence[Results]], height: float) -> Any:
    """Return a chart with a column for each maneuver; its runs are those of `STEERING`, in its order."""
    with figures.canvas(len(_SIGNALS), len(maneuvers), height=height, title=title, share_x=True) as (
        figure,
        axes,
    ):
        for row, (name, unit, scale) in enumerate(_SIGNALS):
            for column, (text, runs) in enumerate(maneuvers.items()):
                panel = axes[row, column]
                for i, (run, label) in enumerate(zip(runs, STEERING.values(), strict=True)):
                    drawn = {"drawstyle": "steps-post"} if name in _HELD else {}
                    panel.plot(
                        run.time, scale * run[f"vehicle.{name}"], label=label, **figures.look(i), **drawn
                    )
                if column == 0:
                    panel.set_ylabel(f"{name.replace('_', ' ')}\n[{unit}]")
                if row == 0:
                    panel.set_title(text)
            _equal_ranges(axes[row])
        for panel in axes[-1]:
            panel.set(xlabel="time [s]", xlim=(0.0, 6.0))
        figure.align_ylabels(axes[:, 0])
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _equal_ranges(panels: Sequence[Any]) -> None:
    low, high = zip(*(panel.get_ylim() for panel in panels), strict=True)
    for panel in panels:
        panel.set_ylim(min(low), max(high))


def _delay(found: Mapping[str, Any]) -> Any:
    with figures.canvas(2, height=2.6, title="Lane keeping: delay in the loop", share_x=True) as (
        figure,
        axes,
    ):
        for i, (name, label) in enumerate((("ideal", "none"), ("one", "one step"), ("two", "two steps"))):
            results = found[name]
            for row, (limits, text) in enumerate(
                (((-0.05, 0.4), "displacement"), ((-25.0, 25.0), "all of it"))
            ):
                axes[row, 0].plot(
                    results.time, results["vehicle.displacement"], label=label, **figures.look(i)
                )
                axes[row, 0].set_ylim(*limits)
                axes[row, 0].set_ylabel(f"{text} [m]")
        axes[0, 0].legend(title="extra delay", loc="upper left", bbox_to_anchor=(1.01, 1.0))
        axes[1, 0].set_xlabel("time [s]")
        axes[1, 0].set_xlim(0.0, found["two"].time[-1])
    return figure
