"""The two cases of the paper's section 6 alone, the slips of the wheels, and battery and inverter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from ...cosim.interface import Value
from ...cosim.results.results import Results
from ...cosim.row_store import Array
from ...models import multi_drive_analysis as analysis
from ...models.constants import KMH
from ...models.two_motor_vehicle import TwoMotorVehicle
from ..simulation import simulate
from ..studies.parallel import Task
from .multi_drive_numbers import largest, maneuver
from .page import Findings, Found, Picture, at_most, holds, near

_CONTROLLERS: dict[str, dict[str, Value]] = {"pid": {"controller.coupling": 0.0}, "mimo": {}}
_LABELS = {"pid": "PIDs", "mimo": "MIMO-PID"}
_CASES = {"slope": "slope alone", "right_curve": "right-hand curve alone"}
_IDEAL: dict[str, Value] = {"left_drive.ideal": True, "right_drive.ideal": True}
_SIDES = ("left", "right")
_ROOM = 0.06  # of the range of a panel, above and below


def tasks() -> tuple[Task[Any], ...]:
    """Return the runs, all over the bus and with drives that are a lag."""
    cases = [(f"{name}, {case}", case, change) for case in _CASES for name, change in _CONTROLLERS.items()]
    return tuple(
        Task(name, simulate, ("multi_drive", scenario), {"parameters": change | _IDEAL})
        for name, scenario, change in (*cases, ("battery", "battery", {}))
    )


def findings(found: Mapping[str, Any]) -> Findings:
    """Return what the paper says of slips, of the slope alone, and of what feeds the motors."""
    peak = 100.0 * analysis.peak_slip(TwoMotorVehicle.Parameters())
    slope = found["mimo, slope"]
    return {
        "slip range": [
            at_most(100.0 * _largest_slip(found[name]), peak, "%", digits=3, of=_LABELS[name])
            for name in _CONTROLLERS
        ],
        "slope alone": at_most(
            largest(*(slope[f"vehicle.{side}_wheel_speed"] for side in _SIDES)), 1e-9, "rad/s", digits=2
        ),
        "battery": _balance(found["battery"]),
    }


def _largest_slip(results: Results) -> float:
    return max(float(np.abs(results[f"vehicle.{side}_slip"]).max()) for side in _SIDES)


def _balance(results: Results) -> Found:
    terminals, motors, lost = (
        float(results[name][-1])
        for name in ("battery.energy", "inverter.motor_energy", "inverter.loss_energy")
    )
    return holds(
        f"battery {terminals:.2f} Wh = motors {motors:.2f} Wh + inverters {lost:.2f} Wh",
        abs(terminals - motors - lost) < 1e-9,
        "equal",
    )


def own(found: Mapping[str, Any]) -> Findings:
    """Return numbers of the cases alone, and of the battery."""
    runs = {_LABELS[name]: found[f"{name}, slope"] for name in _CONTROLLERS}
    turns = {_LABELS[name]: found[f"{name}, right_curve"] for name in _CONTROLLERS}
    power = found["battery"]["inverter.power"]
    return {
        "slope alone: dip of the speed": [
            near(maneuver(run).dip, dip, 5e-3, "km/h", digits=3, of=of)
            for (of, run), dip in zip(runs.items(), (1.09, 0.907), strict=True)
        ],
        "right-hand curve alone: rms error of the left wheel, from 2 s on": [
            near(maneuver(run).error, error, 5e-4, "rad/s", digits=3, of=of)
            for (of, run), error in zip(turns.items(), (0.0204, 0.0186), strict=True)
        ],
        "battery: largest power uphill and downhill": [
            near(float(power.max()) / 1e3, 88.1, 0.1, "kW", digits=3),
            near(float(power.min()) / 1e3, -46.9, 0.1, "kW", digits=3),
        ],
    }


def pictures(found: Mapping[str, Any]) -> tuple[Picture, ...]:
    """Return the pictures of these runs."""
    return (
        Picture.over_time(
            "battery",
            "Fig. 2: its batteries and inverters in the maneuver; their numbers are chosen",
            found["battery"],
            found["battery"].figure.model_copy(update={"title": "Two-motor car: battery and inverters"}),
        ),
        Picture(
            "slips",
            "For the abstract: slips of the driving wheels; more slip gives more force up to 17 %",
            lambda: _columns("Two-motor car: slips", [("", "slip [%]", found, _slips)]),
        ),
        Picture(
            "cases",
            "Of section 6: a slope on a straight road, and a right-hand curve on a level one, each alone",
            lambda: _columns(
                "Two-motor car: slope alone, curve alone",
                [
                    (", slope", "slope alone:\nspeed [km/h]", found, _speed),
                    (", slope", "slope alone:\nmotor torque [N·m]", found, _torques),
                    (", right_curve", "curve alone:\nwheel speed [rad/s]", found, _wheels),
                    (", right_curve", "curve alone:\nmotor torque [N·m]", found, _torques),
                ],
            ),
        ),
    )


Lines = dict[str, Array]


def _slips(results: Results) -> Lines:
    return {side: 100.0 * results[f"vehicle.{side}_slip"] for side in _SIDES}


def _speed(results: Results) -> Lines:
    return {"car": KMH * results["vehicle.speed"], "reference": results["differential.speed_reference"]}


def _torques(results: Results) -> Lines:
    return {side: results[f"{side}_drive.motor_torque"] for side in _SIDES}


def _wheels(results: Results) -> Lines:
    return {side: results[f"vehicle.{side}_wheel_speed"] for side in _SIDES}


def _columns(title: str, rows: list[tuple[str, str, Mapping[str, Any], Any]]) -> Any:
    """Draw a column for each controller, with one range in each row."""
    with figures.canvas(len(rows), 2, height=2.0 if len(rows) > 1 else 2.8, title=title, share_x=True) as (
        figure,
        axes,
    ):
        for i, (case, label, found, lines_of) in enumerate(rows):
            ends = []
            for j, name in enumerate(_CONTROLLERS):
                results, panel = found[name + case], axes[i, j]
                for k, (text, values) in enumerate(lines_of(results).items()):
                    panel.plot(
                        results.time, values, label=text, **figures.look(k) | {"linewidth": 1.9 - 0.5 * k}
                    )
                    ends += [float(values.min()), float(values.max())]
                if i == 0:
                    panel.set_title(_LABELS[name])
            space = _ROOM * (max(ends) - min(ends))
            for j in range(2):
                axes[i, j].set_ylim(min(ends) - space, max(ends) + space)
            axes[i, 0].set_ylabel(label)
            axes[i, 1].legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
        for panel in axes[-1]:
            panel.set(xlabel="time [s]", xlim=(0.0, 10.0))
        figure.align_ylabels(axes[:, 0])
    return figure
