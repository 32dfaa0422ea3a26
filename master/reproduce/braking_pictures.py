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
from .braking_runs import CONTROLLED, NOMINAL, critical, locking, stop_of
from .page import Picture

_SHORT = {"known_speed": "(a)", "front_only": "(c)", "front_compensated": "(d)"}
_MANEUVERS = {
    "known_speed": "(a) full slip control, speed measured",
    "estimated_speed": "(b) full slip control, speed estimated",
    "front_only": "(c) front brake only",
    "front_compensated": "(d) front brake, rear wheel compensated",
}
_ABOUT_PSI = (
    "Fig. 3: Psi, the torque that keeps a wheel at its slip. Above on a dry road over both slips; below on "
    "four roads with the other wheel at 0.22, and the torque of a controller with 1.05 k-bar: on each road "
    "it meets Psi once"
)
_ABOUT_PROPOSITIONS = (
    "Propositions 3.1 and 3.2 on a dry road: with the true speed every start ends at one point, with the "
    "fastest wheel's speed every start ends with both wheels locked"
)
_ABOUT_VEHICLE = (
    "Beyond the paper: stopping distance over the height of the center of mass and the inertia of the wheels "
    "(ideal signals). Half the inertia doubles the gain of the slip loop, for which 100 Hz is too slow"
)
_ABOUT_DELAY = "Beyond the paper: brakes later than the published 10 ms (ideal signals)"
_SLIPS = np.linspace(0.0, 1.0, 201)


def pictures(
    found: dict[str, Any], extra: Sequence[float], heights: Sequence[float], inertias: Sequence[float]
) -> tuple[Picture, ...]:
    """Return all pictures; the runs have delays `extra` [s], and `heights` and `inertias` as shares."""
    return (
        Picture("friction", "Fig. 2: friction by Burckhardt's formula on four roads", _friction()),
        Picture("psi", _ABOUT_PSI, _psi()),
        Picture("propositions", _ABOUT_PROPOSITIONS, _portraits()),
        *(
            Picture(f"fig{i}", f"Fig. {i}: {text}", _maneuver(found[name], name))
            for i, (name, text) in enumerate(_MANEUVERS.items(), 4)
        ),
        Picture("lock", "Fig. 5 enlarged: the first half second", _lock(found["estimated_speed"])),
        Picture("vehicle", _ABOUT_VEHICLE, _vehicle(found, heights, inertias)),
        Picture("delay", _ABOUT_DELAY, _delay(found, extra)),
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


def _psi() -> Any:
    side = np.linspace(0.0, 1.0, 81)
    front, rear = np.meshgrid(side, side)
    at = analysis.reduced(NOMINAL, front, rear)
    gains = critical(1.05)
    with figures.canvas(2, 2, height=3.4, title="Braking: Psi of both wheels") as (figure, axes):
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
        figure.legend(*axes[1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def _cut(road: Road, wheel: int) -> Array:
    """Return Psi [N.m] of a wheel (0 front, 1 rear) over its own slip, the other one at the set point."""
    p = dataclasses.replace(NOMINAL, road=road)
    other = np.full_like(_SLIPS, analysis.TARGET_SLIP)
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


def _maneuver(results: Results, name: str) -> Any:
    spec = results.figure
    if spec is not None and name == "estimated_speed":
        spec = spec.model_copy(update={"note": None})  # it is about wheels that roll to the end
    return figures.draw(results, spec, title=f"Braking: {_MANEUVERS[name]}")


def _lock(results: Results) -> Any:
    figure = _maneuver(results, "estimated_speed")
    figure.axes[0].set_xlim(0.0, 0.5)  # all panels share it
    return figure


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
