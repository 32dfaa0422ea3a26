"""Bounds for a light electric two-wheeled vehicle: its identification, and Figs. 8 and 9."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from ...cosim.figures import draw as figures
from ..simulation import simulate
from ..studies.parallel import Task
from . import scooter_numbers as numbers
from .page import Page, Paper, Picture, PublishedNumber, at_least, at_most, holds, near
from .scooter_identification import (
    PUBLISHED_ESR,
    PUBLISHED_GAIN,
    PUBLISHED_POLE,
    SPEEDS,
    ScooterIdentification,
    at_speed,
    at_working_point,
)

_MAP = "the drive's force map is chosen so that gain and pole at 30 km/h come out"
_CONTROLLER = "observer, crossover and tracking times, and the rider, are chosen"


def _runs() -> tuple[Task[Any], ...]:
    raw = {"parameters": {"ecu.use_observer": False}}
    return (
        Task("identification", at_working_point),
        *(Task(f"at {v:g} km/h", at_speed, (v,)) for v in SPEEDS),
        *(Task(f"fig8 {name}", simulate, ("scooter", "fig8"), o) for name, o in numbers.VARIANTS.items()),
        *(Task(f"fig9 {name}", simulate, ("scooter", "fig9"), o) for name, o in numbers.VARIANTS.items()),
        Task("fig8 raw", simulate, ("scooter", "fig8"), raw),
        *(Task(f"constant {v:g} km/h", numbers.estimate_error, (v,)) for v in numbers.CONSTANT_SPEEDS),
        *(Task(f"stop and go {on}", _stop_and_go, (on,)) for on in (True, False)),
        *(Task(f"{c} {on}", _cycle, (c, on)) for c in ("ece15", "udds") for on in (True, False)),
    )


def _stop_and_go(bounded: bool) -> tuple[float, float]:
    return numbers.energy_and_speed(numbers.stop_and_go(bounded))


def _cycle(name: str, bounded: bool) -> dict[str, float]:
    results = simulate("scooter", name, parameters={"ecu.enabled": bounded})
    return {metric.name: metric.value for metric in results.metrics()}


def _page(found: dict[str, Any]) -> Page:
    identified = ScooterIdentification(
        found["identification"], tuple(found[f"at {v:g} km/h"] for v in SPEEDS)
    )
    return Page(
        name="scooter",
        title="Speed and acceleration bounds for a light electric two-wheeler",
        source=(
            "A. Dardanelli, M. Tanelli, B. Picasso, S. M. Savaresi, O. di Tanna, M. Santucci: Speed and "
            "acceleration controllers for a light electric two-wheeled vehicle, IEEE CDC-ECC 2011"
        ),
        about=(
            "The ECU of an electric scooter keeps speed and acceleration inside bounds. It knows the speed "
            "from a CAN bus that rounds it to 1 km/h, so an observer estimates speed and acceleration. The "
            "paper identifies gain and pole from throttle to speed (Figs. 2-4) and shows the controllers at "
            "work (Figs. 8 and 9)."
        ),
        rows=(
            *_vehicle_rows(),
            *_identification_rows(identified),
            *_observer_rows(found),
            *_fig8_rows(found),
            *_fig9_rows(found),
            *_energy_rows(found),
        ),
        pictures=_pictures(found, identified),
        commands=(
            "evcosim identify scooter",
            "evcosim run scooter",
            "evcosim run scooter --set ecu.use_observer=false",
            "evcosim run scooter --scenario fig9",
            "evcosim run scooter --scenario udds --set ecu.enabled=false",
        ),
    )


def _vehicle_rows() -> list[PublishedNumber]:
    gain, pole = numbers.linearized(30.0)
    over_speed = [numbers.linearized(v) for v in SPEEDS]
    gains, poles = [g for g, _ in over_speed], [f for _, f in over_speed]
    shown = "/".join(f"{f:.4f}" for f in poles)
    falling = all(a > b for a, b in pairwise(poles))
    spread = 100.0 * max(abs(g / PUBLISHED_GAIN - 1.0) for g in gains)
    about = "0.46 km/h per %", "0.03 Hz"
    return [
        near("gain at 30 km/h, linearized", about[0], gain, 0.46, 0.0046, "km/h per %", calibrated=_MAP),
        near("pole at 30 km/h, linearized", about[1], pole, 0.03, 0.0003, "Hz", calibrated=_MAP),
        holds(
            "pole over 25-49 km/h",
            "Fig. 3: falls",
            "strictly falling",
            f"{shown} Hz",
            falling,
            calibrated=_MAP,
        ),
        at_most(
            "gain over 25-49 km/h: change", "Fig. 3: little", spread, 5.0, "%", digits=2, calibrated=_MAP
        ),
    ]


def _identification_rows(found: ScooterIdentification) -> list[PublishedNumber]:
    got, fit = found.numbers, found.measured.fit
    note = (
        f"{_MAP}; sweep chosen. In the paper's band only gain x pole is well conditioned "
        f"(±{100 * fit.product.relative:.1f} %, gain alone ±{100 * fit.gain.relative:.1f} %)"
    )
    ratio = got["gain x pole over published"]
    return [
        near(
            "identified gain, speed over the bus", "0.46 km/h per %", fit.gain.value, PUBLISHED_GAIN,
            0.05 * PUBLISHED_GAIN, "km/h per %", calibrated=note,
        ),
        near(
            "identified pole, speed over the bus", "0.03 Hz", fit.pole.value, PUBLISHED_POLE,
            0.05 * PUBLISHED_POLE, "Hz", calibrated=note,
        ),
        near("identified gain x pole / published", "1", ratio, 1.0, 0.03, calibrated=note),
        at_most("mean ESR, accelerating", "3.18 %", got["mean ESR [%]"], PUBLISHED_ESR, "%", calibrated=_MAP),
    ]  # fmt: skip # one number a row


def _observer_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    worst = max(found[f"constant {v:g} km/h"] for v in numbers.CONSTANT_SPEEDS)
    ratio = numbers.ripple(found["fig8 raw"]) / numbers.ripple(found["fig8 bus"])
    return [
        at_most(
            "abs(v_e - v) at constant v, 24-49 km/h, after 60 s", "≤ 0.5 km/h", worst, 0.5, "km/h", digits=3
        ),
        at_least(
            "rms(dg_e/dt), raw v_m over observer",
            '"minimized"',
            ratio,
            20.0,
            digits=3,
            calibrated=_CONTROLLER,
        ),
    ]


def _fig8_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    rows = []
    for name in numbers.VARIANTS:
        results = found[f"fig8 {name}"]
        where = {"bus": "", "ideal": ", without the bus", "jacobi": ", one step later (jacobi)"}[name]
        states = " ".join("DAV"[s] for s in numbers.switches(results)[1])
        spent = numbers.time_in_states(results)
        shown = " / ".join(f"{t:.2f}" for t in spent)
        close = all(abs(a - b) <= 0.1 for a, b in zip(spent, (10.9, 8.1, 21.1), strict=True))
        over, settled = float(numbers.over_bound(results).max()), numbers.settled_error(results)
        jump = numbers.largest_jump(results)
        rows += [
            holds(
                f"Fig. 8: states{where}",
                "D A V D",
                "D A V D",
                states,
                states == "D A V D",
                calibrated=_CONTROLLER,
            ),
            holds(f"Fig. 8: time in D / A / V [s]{where}", "-", "10.9 / 8.1 / 21.1 ± 0.1", shown, close),
            at_most(f"Fig. 8: overshoot over v_b{where}", "-", over, 1.5, "km/h", digits=3),
            at_most(f"Fig. 8: settled abs(v - v_b){where}", "-", settled, 0.55, "km/h", digits=3),
            at_most(
                f"Fig. 8: jump at a switch{where}",
                '"bumpless"',
                jump,
                1.0,
                "%",
                digits=2,
                calibrated=_CONTROLLER,
            ),
        ]
    return rows


def _fig9_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    rows = []
    for name in numbers.VARIANTS:
        results = found[f"fig9 {name}"]
        where = {"bus": "", "ideal": ", without the bus", "jacobi": ", one step later (jacobi)"}[name]
        late = (results["ecu.state"] == 2) & (numbers.since_switch(results) > 8.0)
        over, count = float(numbers.over_bound(results)[late].max()), len(numbers.switches(results)[0])
        rows += [
            holds(f"Fig. 9: switches{where}", "-", "9", str(count), count == 9),
            at_most(
                f"Fig. 9: v - v_b, 8 s after a switch{where}", "respected", over, 0.55, "km/h", digits=3,
                calibrated=_CONTROLLER,
            ),
        ]  # fmt: skip # one number a row
    return rows


def _energy_rows(found: dict[str, Any]) -> list[PublishedNumber]:
    rows = []
    for bounded, (consumption, speed) in ((True, (43.0, 24.1)), (False, (73.7, 39.7))):
        got = found[f"stop and go {bounded}"]
        what = f"stop and go, bounds {'on' if bounded else 'off'}"
        rows.append(
            near(f"{what}: consumption", "-", got[0], consumption, 0.02 * consumption, "Wh/km", digits=3)
        )
        rows.append(near(f"{what}: mean speed", "-", got[1], speed, 0.02 * speed, "km/h", digits=3))
    for cycle in ("ece15", "udds"):
        on, off = found[f"{cycle} True"], found[f"{cycle} False"]
        shown = ", ".join(
            f"{metrics['energy per distance']:.1f} Wh/km, {metrics['mean speed']:.1f} km/h, "
            f"{metrics['share of the distance not followed']:.1f} % not followed"
            for metrics in (on, off)
        )
        saves = on["energy per distance"] < off["energy per distance"]
        rows.append(holds(f"{cycle}, bounds on, then off", "-", "bounds save energy", shown, saves))
    return rows


def _pictures(found: dict[str, Any], identified: ScooterIdentification) -> tuple[Picture, ...]:
    captions = {
        "fig2": "Fig. 2: frequency response from throttle to measured speed, and the fitted model",
        "fig3": "Fig. 3: gain and pole over speed",
        "fig4": "Fig. 4: the identified model beside the scooter, and ESR(t)",
    }
    redrawn = [Picture(stem, captions[stem], figure) for stem, figure in identified.figures().items()]
    return (
        *redrawn,
        Picture("fig8", "Fig. 8: fixed bounds, 30 km/h and 1 m/s²", found["fig8 bus"].plot()),
        Picture(
            "fig9", "Fig. 9: bounds that depend on estimated speed and on time", found["fig9 bus"].plot()
        ),
        Picture(
            "raw",
            "Beyond the paper's text: the throttle without the observer, and with it",
            _raw_figure(found),
        ),
    )


def _raw_figure(found: dict[str, Any]) -> Any:
    with figures.canvas(2, height=2.4, title="scooter: what the observer is for", share_x=True) as (
        figure,
        axes,
    ):
        for row, (name, label) in enumerate((("fig8 raw", "raw v_m"), ("fig8 bus", "observer"))):
            results = found[name]
            axes[row, 0].plot(
                results.time, results["ecu.throttle"], drawstyle="steps-post", **figures.look(0)
            )
            axes[row, 0].set_ylabel(f"g_e [%]\n{label}")
            axes[row, 0].set_ylim(-5.0, 105.0)
        axes[1, 0].set_xlabel("time [s]")
        axes[1, 0].set_xlim(0.0, np.max(results.time))
    return figure


PAPER = Paper("scooter", _runs, _page)
