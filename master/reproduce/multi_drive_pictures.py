"""Pictures of the two-motor car: the paper's Figs. 4 to 19, those behind its Table 3, and those beyond it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ...cosim.figures import draw as figures
from ...cosim.results.results import Results, ResultVariable
from ...cosim.system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from ...models.constants import AIR_DENSITY
from ...models.induction_motor_drive import InductionMotorDrive
from . import multi_drive_cases, multi_drive_figures
from .multi_drive_figures import joined
from .multi_drive_numbers import DENSITY, of_print
from .page import Picture

_CONTROLLERS = {"mimo": "MIMO-PID", "pid": "PIDs", "stronger": "PIDs, gains x 1.5"}
_SLOPE = (2.98, 3.06)  # s, round its begin at 3 s
_JUMP = (1.95, 2.2)  # s, round that of the steering at 2 s
_FINE = 2e-4  # s: 34 points in a period of 147 Hz


class Effect(NamedTuple):
    """Dip of the speed [km/h], rms error of the left wheel [rad/s], largest parting of the torques [N.m]."""

    dip: float
    error: float
    parting: float


def pictures(found: Mapping[str, Any], coupled: Mapping[float, tuple[Effect, Effect]]) -> tuple[Picture, ...]:
    """Return all pictures: `found` are the runs, `coupled` the effects of couplings and of gains instead."""
    both = _beside({name: found[name] for name in _CONTROLLERS})
    launches = _beside({name: found[f"launch {name}"] for name in ("mimo", "pid")})
    return (
        *multi_drive_figures.pictures(found),
        *multi_drive_cases.pictures(found),
        Picture.over_time(
            "resistance",
            "Beyond the paper: torques of slope, rolling and air; 93.2 N·m need air of 1.164 kg/m³",
            _resistances(found["mimo"]),
            _RESISTANCE,
        ),
        Picture.over_time(
            "currents",
            "Beyond the paper: currents and power of the motors",
            found["mimo"],
            _CURRENTS,
        ),
        Picture.over_time(
            "phases",
            "Beyond the paper: phase currents where the slope begins, from those in the frame of the flux",
            phase_currents(found["mimo"], *_SLOPE),
            _PHASES,
        ),
        Picture.over_time("launch", "For Table 3: rise and overshoot from a standstill", launches, _LAUNCH),
        Picture.over_time(
            "baseline",
            "Beyond the paper: PIDs with gains x 1.5 do on the slope what the MIMO-PID does",
            both,
            _BASELINE,
        ),
        Picture.over_time(
            "jump",
            "Beyond the paper: when the steering jumps, the coupling asks less of the wheels' difference",
            _between(both, *_JUMP),
            _DIFFERENCE,
        ),
        Picture(
            "coupling",
            "Beyond the paper: coupling, and gain in its place. At κ = 1 both have twice the published gain "
            "for equal errors, which is more than the loop carries at 100 Hz",
            lambda: _coupling_figure(coupled),
        ),
        Picture.over_time(
            "machine",
            "Beyond the paper: what the dq machine changes, and what the bandwidth of the drive does",
            _machine_differences(found),
            _MACHINE,
        ),
    )


def _beside(runs: Mapping[str, Results]) -> Results:
    """Return runs of equal times as one, with variables `name/unit.variable`."""
    columns = [
        (dataclasses.replace(v, name=f"{name}/{v.name}"), run.column(v.name))
        for name, run in runs.items()
        for v in run.variables
    ]
    return joined(next(iter(runs.values())).time, columns)


def _between(results: Results, begin: float, end: float) -> Results:
    rows = (results.time > begin - 1e-9) & (results.time < end + 1e-9)
    return results.part(rows, results.names)


def _resistances(results: Results) -> Results:
    """Return the three torques, their sum, and the torque of thinner air, beside that which is printed."""
    slope, rolling, air = (results[f"vehicle.{n}_torque"] for n in ("slope", "rolling", "aerodynamic"))
    values = {
        "slope": slope,
        "rolling": rolling,
        "air": air,
        "all": slope + rolling + air,
        "thin air": air * (DENSITY / AIR_DENSITY),
        "printed": np.full(len(air), of_print("air PIDs")),
    }
    return joined(results.time, ((ResultVariable(n, "N.m"), v) for n, v in values.items()))


def phase_currents(results: Results, begin: float, end: float) -> Results:
    """Return the three currents [A] of the left motor between two times [s], on a grid of 0.2 ms.

    The recorded i_d and i_q, linear between the samples, are turned by the angle of the flux, which is the
    integral of w + L_m i_q/(T_r |psi|), equation (F4) of the drive; it is 0 at `begin`.
    """
    p = InductionMotorDrive.Parameters()
    time = np.linspace(begin, end, round((end - begin) / _FINE) + 1)
    i_d, i_q, flux, speed = (
        np.interp(time, results.time, results[name])
        for name in (
            "left_drive.current_d",
            "left_drive.current_q",
            "left_drive.flux",
            "vehicle.left_wheel_speed",
        )
    )
    rate = p.pole_pairs * p.gear_ratio * speed + p.machine.coupling * i_q / flux
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))))
    phases = []
    for k, name in enumerate("abc"):
        turned = angle - k * 2.0 * np.pi / 3.0
        phases.append((ResultVariable(name, "A"), i_d * np.cos(turned) - i_q * np.sin(turned)))
    return joined(time, [*phases, (ResultVariable("across", "A"), i_q), (ResultVariable("along", "A"), i_d)])


def _machine_differences(found: Mapping[str, Any]) -> Results:
    """Return the differences to the ideal drive of 3 ms, without the bus."""
    ideal = found["ideal 3 ms"]
    others = {"machine": "machine 3 ms", "faster": "ideal 1 ms", "slower": "ideal 6 ms"}
    columns = []
    for short, run in others.items():
        for what in ("right_drive.torque", "vehicle.speed"):
            variable = dataclasses.replace(ideal.variable(what), name=f"{short}/{what}")
            columns.append((variable, found[run][what] - ideal[what]))
    return joined(ideal.time, columns)


def _panel(label: str, unit: str, *signals: tuple[str, str], limits: Any = None) -> PanelSpec:
    return PanelSpec(
        label=label,
        unit=unit,
        signals=[SignalSpec(name=name, label=text) for name, text in signals],
        limits=limits,
    )


def _each(variable: str, *controllers: str) -> list[tuple[str, str]]:
    return [(f"{name}/{variable}", _CONTROLLERS[name]) for name in controllers]


_REFERENCE = ("mimo/differential.speed_reference", "reference")
_RESISTANCE = FigureSpec(
    title="Two-motor car: torques of the resistances",
    panels=[
        _panel("All", "N.m", ("all", "slope, rolling, air")),
        _panel("Slope", "N.m", ("slope", "slope")),
        _panel("Rolling", "N.m", ("rolling", "rolling"), limits=(0.0, 200.0)),
        _panel(
            "Air",
            "N.m",
            ("air", "1.2 kg/m³"),
            ("thin air", "1.164 kg/m³"),
            ("printed", "printed, at 60 km/h"),
        ),
    ],
)
_CURRENTS = FigureSpec(
    title="Two-motor car: currents and power of the motors, MIMO-PID",
    panels=[
        _panel(
            "Phase current, effective", "A", ("left_drive.current", "left"), ("right_drive.current", "right")
        ),
        _panel(
            "Left motor",
            "A",
            ("left_drive.current_d", "along the flux"),
            ("left_drive.current_q", "across the flux"),
        ),
        _panel(
            "Right motor",
            "A",
            ("right_drive.current_d", "along the flux"),
            ("right_drive.current_q", "across the flux"),
        ),
        _panel("Power", "kW", ("left_drive.power", "left"), ("right_drive.power", "right")),
    ],
)
_PHASES = FigureSpec(
    title="Two-motor car: phase currents of the left motor, MIMO-PID",
    panels=[
        _panel("Phase currents", "A", ("a", "a"), ("b", "b"), ("c", "c")),
        _panel("Flux frame", "A", ("along", "along the flux"), ("across", "across the flux")),
    ],
)
_LAUNCH = FigureSpec(
    title="Two-motor car: 0 to 60 km/h",
    panels=[
        _panel("Speed", "km/h", *_each("vehicle.speed", "mimo", "pid"), _REFERENCE),
        _panel(
            "Speed, enlarged", "km/h", *_each("vehicle.speed", "mimo", "pid"), _REFERENCE, limits=(59.0, 60.2)
        ),
        _panel("Left wheel", "N.m", *_each("left_drive.torque", "mimo", "pid")),
    ],
)
_FAIR = ("mimo", "stronger", "pid")  # two that cover each other, side by side: dashes on a wider line
_BASELINE = FigureSpec(
    title="Two-motor car: MIMO-PID, PIDs, and PIDs with gains x 1.5",
    panels=[
        _panel("Speed", "km/h", *_each("vehicle.speed", *_FAIR), _REFERENCE),
        _panel("Error of the left wheel", "rad/s", *_each("controller.left_error", *_FAIR)),
        _panel("Left wheel", "N.m", *_each("left_drive.torque", *_FAIR)),
    ],
)
_DIFFERENCE = FigureSpec(
    title="Two-motor car: a jump of the steering by 1.5 deg",
    panels=[
        *(
            _panel(f"{side.capitalize()} wheel", "N.m", *_each(f"{side}_drive.torque", *_FAIR))
            for side in ("left", "right")
        ),
        _panel("Error of the left wheel", "rad/s", *_each("controller.left_error", *_FAIR)),
    ],
)
_MACHINE = FigureSpec(
    title="Two-motor car: difference from an ideal drive of 3 ms, without the bus",
    panels=[
        _panel(
            f"{label}: {of}",
            unit,
            *((f"{short}/{name}", text) for short, text in lines),
        )
        for label, unit, name in (
            ("Right wheel", "N.m", "right_drive.torque"),
            ("Speed", "km/h", "vehicle.speed"),
        )
        for of, lines in (
            ("dq machine", (("machine", "dq machine, 3 ms"),)),
            ("lag", (("faster", "ideal, 1 ms"), ("slower", "ideal, 6 ms"))),
        )
    ],
)


def _coupling_figure(coupled: Mapping[float, tuple[Effect, Effect]]) -> Any:
    kappa = list(coupled)
    labels = (
        "dip of the speed\n[km/h]",
        "rms error of the\nleft wheel [rad/s]",
        "largest parting of the\ntorques [N·m]",
    )
    lines = ("MIMO-PID with κ", "PIDs, gains x (1 + κ)")
    with figures.canvas(3, height=2.2, title="Two-motor car: coupling or gain", share_x=True) as (
        figure,
        axes,
    ):
        for row, label in enumerate(labels):
            for i, (text, marker) in enumerate(zip(lines, "os", strict=True)):
                values = [coupled[k][i][row] for k in kappa]
                axes[row, 0].plot(kappa, values, label=text, marker=marker, markersize=4, **figures.look(i))
            axes[row, 0].set_ylabel(label)
            axes[row, 0].set_ylim(0.0, axes[row, 0].dataLim.y1 * 1.07)
        axes[0, 0].legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
        axes[2, 0].set_xlabel("κ")
        axes[2, 0].set_xlim(-0.02, 1.02)
        figure.align_ylabels(axes[:, 0])
    return figure
