"""The figures of the braking paper, redrawn, and three beyond it: phase portraits, vehicle, delay."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from ...cosim.results.results import Results
from ...cosim.row_store import Array
from ...models import braking_analysis as analysis
from ...models.road_friction import Road, friction_coefficient
from . import braking_maneuvers
from .braking_runs import CONTROLLED, NOMINAL, critical, locking, stop_of
from .page import Picture

_SHORT = {"known_speed": "(a)", "front_only": "(c)", "front_compensated": "(d)"}
_ABOUT_FIG_3 = (
    "Fig. 3: Ψ, the torque that keeps a wheel at its slip, over that slip, on a dry road: (a) front wheel, "
    "(b) rear wheel, for slips of the other wheel of 0.1 (solid), 0.5 (dashed) and 0.9 (dotted; printed as "
    "0.1 again, a misprint)"
)
_ABOUT_PSI = (
    "Beyond the paper: Ψ on a dry road over both slips, and on four roads with the other wheel at 0.22; "
    "the torque of a controller with 1.05 k̄ meets it once on each road"
)
_ABOUT_PROPOSITIONS = (
    "Beyond the paper: Propositions 3.1 and 3.2 on a dry road; with the true speed every start ends at one "
    "point, with the fastest wheel's speed every start ends with both wheels locked"
)
_ABOUT_VEHICLE = (
    "Beyond the paper: stopping distance over the height of the center of mass and the inertia of the wheels "
    "(ideal signals). Half the inertia doubles the gain of the slip loop, for which 100 Hz is too slow"
)
_ABOUT_DELAY = "Beyond the paper: brakes later than the published 10 ms (ideal signals)"
_OTHER_SLIPS = (0.1, 0.5, 0.9)  # the last is chosen for a misprint
_SLIPS = np.linspace(0.0, 1.0, 201)
_HALF_A_SECOND = 0.5


def pictures(
    found: dict[str, Any], extra: Sequence[float], heights: Sequence[float], inertias: Sequence[float]
) -> tuple[Picture, ...]:
    """Return all pictures; the runs have delays `extra` [s], and `heights` and `inertias` as shares."""
    return (
        Picture("friction", "Fig. 2: friction by Burckhardt's formula on four roads", _friction),
        Picture("psi", _ABOUT_FIG_3, _psi_lines),
        Picture("psi-roads", _ABOUT_PSI, _psi),
        Picture("propositions", _ABOUT_PROPOSITIONS, _portraits),
        *braking_maneuvers.pictures(found),
        _lock(found["estimated_speed"]),
        Picture("vehicle", _ABOUT_VEHICLE, lambda: _vehicle(found, heights, inertias)),
        Picture("delay", _ABOUT_DELAY, lambda: _delay(found, extra)),
    )


def _friction() -> Any:
    with figures.canvas(height=3.4, title="Friction of a tire") as (figure, axes):
        panel = axes[0, 0]
        for i, road in enumerate(Road):
            mu = [friction_coefficient(road, float(x)) for x in _SLIPS]
            panel.plot(_SLIPS, mu, label=road.name.lower(), **figures.look(i))
        panel.axvline(analysis.TARGET_SLIP, color="#7F7F7F", linewidth=0.9)
        panel.annotate(
            "set point", (analysis.TARGET_SLIP, 0.02), (4, 0), textcoords="offset points", fontsize=9
        )
        panel.set(xlabel="slip λ [1]", ylabel="friction μ [1]", xlim=(0.0, 1.0), ylim=(0.0, 1.3))
        panel.legend(title="road", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


def _psi_lines() -> Any:
    """Draw Psi of each wheel over its own slip, a line for each slip of the other one."""
    with figures.canvas(1, 2, height=3.6, title="Braking: Ψ of both wheels") as (figure, axes):
        for i, (wheel, other) in enumerate((("f", "r"), ("r", "f"))):
            panel = axes[0, i]
            for j, slip in enumerate(_OTHER_SLIPS):
                panel.plot(
                    _SLIPS, _cut(NOMINAL.road, i, slip), label=f"λ_{other} = {slip:g}", **figures.look(j)
                )
            panel.set(xlabel=f"slip λ_{wheel} [1]", ylabel=f"Ψ_{wheel} [N·m]", title=f"({'ab'[i]})")
            panel.set(xlim=(0.0, 1.0))
            panel.legend(title="other wheel", loc="upper right")
        _equal_ranges(axes[0])
    return figure


def _equal_ranges(panels: Sequence[Any]) -> None:
    """Give panels that stand side by side one range, from 0 on."""
    high = max(panel.get_ylim()[1] for panel in panels)
    for panel in panels:
        panel.set_ylim(0.0, high)


def _psi() -> Any:
    side = np.linspace(0.0, 1.0, 81)
    front, rear = np.meshgrid(side, side)
    at = analysis.reduced(NOMINAL, front, rear)
    gains = critical(1.05)
    with figures.canvas(2, 2, height=3.4, title="Braking: Ψ over both slips, and on four roads") as (
        figure,
        axes,
    ):
        for i, (psi, name) in enumerate(((at.psi_front, "f"), (at.psi_rear, "r"))):
            above, below = axes[0, i], axes[1, i]
            filled = above.contourf(front, rear, psi, 12, cmap="Greys", vmax=1.3 * float(psi.max()))
            above.contour(front, rear, psi, filled.levels, colors="black", linewidths=0.7)
            figure.colorbar(filled, ax=above, label=f"Ψ_{name} [N·m]")
            above.set(xlabel="front slip λ_f [1]", ylabel="rear slip λ_r [1]", title=f"Ψ_{name}, dry road")
            above.grid(visible=False)
            for j, road in enumerate(Road):
                below.plot(_SLIPS, _cut(road, i), label=road.name.lower(), **figures.look(j))
            torque = np.maximum(0.0, gains[i] * (analysis.TARGET_SLIP - _SLIPS))
            below.plot(
                _SLIPS, torque, label="torque of 1.05 k̄ (λ* - λ)", **figures.look(4) | {"linewidth": 2.4}
            )
            below.set(xlabel=f"slip λ_{name} [1]", ylabel=f"Ψ_{name} [N·m]", xlim=(0.0, 1.0))
        _equal_ranges(axes[1])
        figure.legend(*axes[1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def _cut(road: Road, wheel: int, other_slip: float = analysis.TARGET_SLIP) -> Array:
    """Return Psi [N.m] of a wheel (0 front, 1 rear) over its own slip, for a slip of the other one."""
    p = dataclasses.replace(NOMINAL, road=road)
    other = np.full_like(_SLIPS, other_slip)
    if wheel == 0:
        return analysis.psi_front(p, _SLIPS, other)
    return analysis.psi_rear(p, other, _SLIPS)


def _portraits() -> Any:
    side = np.linspace(0.0, 1.0, 101)
    front, rear = np.meshgrid(side, side)
    at = analysis.reduced(NOMINAL, front, rear)
    held, high = critical(10.0), locking(NOMINAL)
    (rest,) = analysis.equilibria(NOMINAL, held)
    laws = (
        ("3.1: 10 k̄, true speed", analysis.proportional(held), rest, "equilibrium"),
        (
            "3.2: k λ* = 1.5 max Ψ, fastest wheel",
            analysis.proportional_by_fastest_wheel(high),
            (1.0, 1.0),
            "lock",
        ),
    )
    with figures.canvas(1, 2, height=4.6, title="Braking: where the slips go") as (figure, axes):
        for panel, (title, law, end, name) in zip(axes[0], laws, strict=True):
            torque_f, torque_r = law(front, rear)
            panel.streamplot(
                side, side, torque_f - at.psi_front, torque_r - at.psi_rear, color="#0072B2", linewidth=0.9,
                density=1.3, arrowsize=1.1,
            )  # fmt: skip # two lines are enough
            panel.plot(*end, "o", color="black", markersize=9, clip_on=False, zorder=5, label=name)
            panel.set(xlabel="front slip λ_f [1]", ylabel="rear slip λ_r [1]", title=title, aspect="equal")
            panel.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
            panel.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14))
    return figure


def _lock(results: Results) -> Picture:
    rows = slice(int(np.searchsorted(results.time, _HALF_A_SECOND, "right")))
    begin = results.part(rows, results.names)
    title = "Braking: (b) full slip control, speed estimated"
    if results.figure is None:
        raise ValueError("the run has no figure")
    spec = results.figure.model_copy(update={"title": title, "until": None, "note": None})
    return Picture.over_time("lock", "Fig. 5 enlarged: the first half second", begin, spec)


def _vehicle(found: dict[str, Any], heights: Sequence[float], inertias: Sequence[float]) -> Any:
    columns = (
        ("height", heights, "h [share of 0.506 m]", "height of the center of mass"),
        ("inertia", inertias, "J [share of 0.79 kg·m²]", "wheels, controller at 100 Hz"),
        ("fine", inertias, "J [share of 0.79 kg·m²]", "wheels, controller at 1 kHz"),
    )
    with figures.canvas(1, 3, height=3.8, title="Braking: the vehicle behind the distance") as (figure, axes):
        for panel, (kind, shares, label, title) in zip(axes[0], columns, strict=True):
            for i, name in enumerate(CONTROLLED):
                distances = [stop.distance for stop in found[f"{kind} {name}"]]
                panel.plot(shares, distances, marker="os^"[i], label=_SHORT[name], **figures.look(i))
            panel.set(xlabel=label, title=title, xticks=shares, ylim=(30.0, 62.0))
        axes[0, 0].set_ylabel("stopping distance [m]")
        axes[0, -1].legend(title="strategy", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


def _delay(found: dict[str, Any], extra: Sequence[float]) -> Any:
    runs = (("known_speed, ideal", "none"), ("1 late", "10 ms"), ("2 late", "20 ms"))
    with figures.canvas(2, height=3.1, title="Braking: delay in the loop") as (figure, axes):
        upper, lower = axes[:, 0]
        for i, name in enumerate(CONTROLLED):
            distances = [stop.distance for stop in found[f"delay {name}"]]
            upper.plot(
                1e3 * np.array(extra), distances, marker="os^"[i], label=_SHORT[name], **figures.look(i)
            )
        upper.set(xlabel="extra delay of the brakes [ms]", ylabel="stopping distance [m]")
        upper.legend(title="strategy", loc="upper left", bbox_to_anchor=(1.01, 1.0))
        for i, (name, label) in enumerate(runs):
            results = found[name]
            text = f"{label}, {stop_of(results).distance:.2f} m"
            lower.plot(results.time, results["vehicle.front_slip"], label=text, **figures.look(i))
        lower.set(xlabel="time [s]", ylabel="front slip [1]", xlim=(0.0, 3.0), ylim=(-0.02, 1.05))
        lower.legend(title="(a), extra delay", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure
