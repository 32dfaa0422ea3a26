"""Figs. 4 to 7 of the braking paper: the slips of both wheels, true and estimated, of both plants."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from ...cosim.figures.end import until
from ...cosim.results.results import Results
from ...cosim.row_store import Array
from ...cosim.system.figure_spec import EndSpec, FigureSpec, PanelSpec, SignalSpec
from .page import Picture

CAPTIONS = {
    "known_speed": "(a) full slip control, speed measured",
    "estimated_speed": "(b) full slip control, speed estimated",
    "front_only": "(c) front brake only",
    "front_compensated": "(d) front brake, rear wheel compensated",
}
_PLANTS = {"": "equations (1) to (5)", ", detailed": "with suspensions and elastic tires"}
_END = EndSpec(signal="vehicle.speed", below=2.0)
_LINES = (("front", 0), ("rear", 1))
_ROOM = 0.05


def pictures(found: dict[str, Any]) -> tuple[Picture, ...]:
    """Return the pictures of the runs of each strategy with both plants, and of what carries the vehicle."""
    return (
        *(
            Picture(
                f"fig{number}",
                f"Fig. {number}: {text}; slips of the wheels, true and by (16), down to 2 m/s",
                functools.partial(
                    _slips, number, text, {label: found[name + plant] for plant, label in _PLANTS.items()}
                ),
            )
            for number, (name, text) in enumerate(CAPTIONS.items(), 4)
        ),
        Picture.over_time(
            "ride",
            "Beyond the paper: loads, pitch and springs in Fig. 4, of the plant that has suspensions",
            found["known_speed, detailed"],
            _RIDE,
        ),
    )


def estimated_slips(results: Results) -> tuple[Array, Array]:
    """Return the slips of both wheels that (16) estimates, each of shape (n,); 0 where both stand."""
    front, rear = (results[f"vehicle.{wheel}_wheel_speed"] for wheel, _ in _LINES)
    fastest = np.maximum(front, rear)
    turning = np.where(fastest > 0.0, fastest, 1.0)
    return (fastest - front) / turning, (fastest - rear) / turning


def _slips(number: int, text: str, runs: dict[str, Results]) -> Any:
    shown = {label: until(results, _END) for label, results in runs.items()}
    slips = {
        label: [results[f"vehicle.{wheel}_slip"] for wheel, _ in _LINES] + list(estimated_slips(results))
        for label, results in shown.items()
    }
    ends = [value for each in slips.values() for slip in each for value in (slip.min(), slip.max())]
    limits = (min(ends) - _ROOM, max(ends) + _ROOM)
    last = max(float(results.time[-1]) for results in shown.values())
    with figures.canvas(2, height=2.6, title=f"Braking: {text}", share_x=True) as (figure, axes):
        for panel, (label, results) in zip(axes[:, 0], shown.items(), strict=True):
            true, estimated = slips[label][:2], slips[label][2:]
            for (wheel, i), values in zip(_LINES, true, strict=True):
                panel.plot(results.time, values, label=wheel, **figures.look(i) | {"linewidth": 3.0})
            for (wheel, i), values in zip(_LINES, estimated, strict=True):
                panel.plot(
                    results.time, values, label=f"{wheel}, by (16)", drawstyle="steps-post",
                    **figures.look(3 if i == 0 else 2) | {"linewidth": 1.3},
                )  # fmt: skip # one line
            panel.set(ylabel="slip [1]", xlim=(0.0, last), ylim=limits)
            panel.set_title(label, fontsize=10)
        axes[0, 0].legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
        axes[1, 0].set_xlabel("time [s]")
        figure.align_ylabels(axes[:, 0])
    return figure


def _panel(label: str, unit: str, *signals: tuple[str, str]) -> PanelSpec:
    lines = [SignalSpec(name=f"vehicle.{name}", label=text) for name, text in signals]
    return PanelSpec(label=label, unit=unit, signals=lines)


_RIDE = FigureSpec(
    title="Braking: (a) on suspensions and elastic tires",
    panels=[
        _panel("Load of a tire", "N", ("front_load", "front"), ("rear_load", "rear")),
        _panel("Pitch", "deg", ("pitch", "forward")),
        _panel(
            "Spring and body", "mm", ("front_travel", "front suspension, compressed"),
            ("rear_travel", "rear suspension, compressed"), ("heave", "sprung mass, up"),
        ),
        _panel("Deceleration", "m/s2", ("deceleration", "vehicle")),
    ],
)  # fmt: skip # a line for each panel
