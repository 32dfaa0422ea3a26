"""Bounds for a light electric two-wheeled vehicle: its identification, and Figs. 8 and 9."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np

from ...cosim.results.results import Results
from ...models.bound_controller import TIME_CONSTANT, BoundController
from ..simulation import simulate
from ..studies.parallel import Task
from . import printed
from . import scooter_bounds as bounds
from . import scooter_numbers as numbers
from .page import Findings, Found, Page, Paper, Picture, at_least, at_most, holds, near, page
from .scooter_identification import (
    PUBLISHED_GAIN,
    PUBLISHED_POLE,
    SPEEDS,
    WORKING_POINT,
    ScooterIdentification,
    at_speed,
    at_working_point,
)
from .scooter_pictures import pictures

_VARIANTS = {"bus": "over the bus", "ideal": "without the bus", "jacobi": "one step later (jacobi)"}
_RELEASE = 30.0  # s: the rider of Fig. 8 closes the throttle
_QUANTIZER = (
    "at 30.0 km/h; what the quantizer makes of the sweep depends on the working point, by up to 8 %, which "
    "the confidence interval of the fit leaves out"
)


def _runs() -> tuple[Task[Any], ...]:
    raw = {"parameters": {"ecu.use_observer": False}}
    return (
        Task("identification", at_working_point),
        *(Task(f"at {v:g} km/h", at_speed, (v,)) for v in SPEEDS),
        *(Task(f"fig8 {name}", simulate, ("scooter", "fig8"), o) for name, o in numbers.VARIANTS.items()),
        *(Task(f"fig9 {name}", simulate, ("scooter", "fig9"), o) for name, o in numbers.VARIANTS.items()),
        Task("fig8 raw", simulate, ("scooter", "fig8"), raw),
        Task("fig8 wheels", simulate, ("scooter", "fig8_wheels")),
        *(Task(f"fig8 fine {on}", _ripple_of_fine_wheels, (on,)) for on in (True, False)),
        *bounds.tasks(),
        *(Task(f"constant {v:g} km/h", numbers.at_constant_speed, (v,)) for v in numbers.CONSTANT_SPEEDS),
        *(Task(f"stop and go {on}", _stop_and_go, (on,)) for on in (True, False)),
        *(Task(f"{c} {on}", _cycle, (c, on)) for c in ("ece15", "udds") for on in (True, False)),
    )


def _ripple_of_fine_wheels(observer: bool) -> float:
    """Return the rms of dg_e/dt [%/s] in Fig. 8 with the speed of the wheels as it is, not to 1 km/h."""
    fine = {"ecu.speed_resolution": 0.0, "ecu.use_observer": observer}
    return numbers.ripple(simulate("scooter", "fig8_wheels", parameters=fine))


def _stop_and_go(bounded: bool) -> tuple[float, float]:
    return numbers.energy_and_speed(numbers.stop_and_go(bounded))


def _cycle(name: str, bounded: bool) -> dict[str, float]:
    results = simulate("scooter", name, parameters={"ecu.enabled": bounded})
    return {metric.name: metric.value for metric in results.metrics}


def _identified(found: dict[str, Any]) -> ScooterIdentification:
    return ScooterIdentification(found["identification"], tuple(found[f"at {v:g} km/h"] for v in SPEEDS))


def _pictures(found: dict[str, Any]) -> tuple[Picture, ...]:
    return pictures(found, _identified(found))


def _page(found: dict[str, Any]) -> Page:
    identified = _identified(found)
    return page(
        "scooter",
        title="Speed and acceleration bounds for a light electric two-wheeler",
        about=(
            "The ECU of an electric scooter keeps speed and acceleration inside bounds. It knows the speed "
            "from a CAN bus that rounds it to 1 km/h, so an observer estimates speed and acceleration. The "
            "paper identifies gain and pole from throttle to speed (Figs. 2-4) and shows the controllers at "
            "work (Figs. 8 and 9)."
        ),
        found={
            **_bus(found),
            **_vehicle(),
            **_identification(identified),
            **_observer(found),
            **_supervisor(found),
            **_figure_8(found),
            **_figure_9(found),
            **_ranges(found),
            **_acceleration(found),
        },
        own=_own(found, identified),
        pictures=_pictures(found),
        commands=(
            "evcosim identify scooter",
            "evcosim run scooter",
            "evcosim run scooter --set ecu.use_observer=false",
            "evcosim run scooter --scenario fig8_wheels",
            "evcosim run scooter --set planner.acceleration_at_rest=4 --set ecu.dwell_time=0.5",
            "evcosim run scooter --scenario fig9",
            "evcosim run scooter --scenario udds --set ecu.enabled=false",
        ),
    )


def _printed(by: str) -> float:
    return printed.row("scooter", by).number


def _bus(found: dict[str, Any]) -> Findings:
    """Return sampling, resolution and limits as they stand in the runs."""
    run = found["fig8 bus"]
    rate, speeds = 1.0 / float(run.time[1] - run.time[0]), np.unique(run["ecu.speed_measured"])
    low, high = numbers.throttle_limits()
    fit = found["identification"].fit
    values = {
        "sampling": (round(rate, 6), "Hz"),
        "resolution": (float(np.diff(speeds).min()), "km/h"),
        "upper limit": (high, "%"),
        "lower limit": (low, "%"),
        "band from": (fit.band[0], "Hz"),
        "band to": (fit.band[1], "Hz"),
    }
    return {by: holds(f"{x:g} {unit}", x == _printed(by), "as printed") for by, (x, unit) in values.items()}


def _vehicle() -> Findings:
    over_speed = [numbers.linearized(v) for v in SPEEDS]
    gains, poles = [g for g, _ in over_speed], [f for _, f in over_speed]
    shown = "/".join(f"{f:.4f}" for f in poles)
    spread = _spread(gains)
    return {
        "pole falls": holds(f"{shown} Hz", all(a > b for a, b in pairwise(poles)), "strictly falling"),
        "gain stays": Found(f"{spread:.1g} %: not at all, but for rounding"),
        "boost": at_least(numbers.boost(20.0, 40.0), 1.5, digits=3),
        "comparable": _comparable(),
    }


def _comparable() -> Found:
    slow, fast = (numbers.power_share(speed, 1.0) for speed in (10.0, 49.0))
    return holds(
        f"{slow:.2f} and {fast:.2f}", slow > 2.0 and 0.5 < fast < 2.0, "from above 2 to between ½ and 2"
    )


def _identification(found: ScooterIdentification) -> Findings:
    fit, (gain, pole) = found.measured.fit, numbers.linearized(WORKING_POINT)
    note = (
        "sweep chosen; in the paper's band only gain x pole is well conditioned "
        f"(±{100 * fit.product.relative:.1f} %, gain alone ±{100 * fit.gain.relative:.1f} %)"
    )
    ways = (
        ("linearized", gain, pole, 0.01, ""),
        ("identified over the bus", fit.gain.value, fit.pole.value, 0.05, note),
    )
    return {
        "gain": [
            near(g, PUBLISHED_GAIN, reach * PUBLISHED_GAIN, "km/h per %", of=of, reason=reason)
            for of, g, _, reach, reason in ways
        ],
        "pole": [
            near(f, PUBLISHED_POLE, reach * PUBLISHED_POLE, "Hz", of=of, reason=reason)
            for of, _, f, reach, reason in ways
        ],
        "ESR": Found(f"{found.numbers['mean ESR [%]']:.4g} %"),
        "single pole": at_most(100.0 * fit.residual, 25.0, "% (rms)", digits=2),
    }


def _observer(found: dict[str, Any]) -> Findings:
    constant = [found[f"constant {v:g} km/h"] for v in numbers.CONSTANT_SPEEDS]
    raw, ours = numbers.ripple(found["fig8 raw"]), numbers.ripple(found["fig8 bus"])
    p = BoundController.Parameters()
    crossovers = [w / (2.0 * math.pi) for w in (p.speed_bandwidth, p.acceleration_bandwidth)]
    calm = at_least(raw / ours, 20.0, digits=3)
    return {
        "converges": at_most(max(each.from_measured for each in constant), 0.01, "km/h", digits=2),
        "estimate": at_most(max(each.error for each in constant), _printed("estimate"), "km/h", digits=3),
        "ripple": calm,
        "minimized": holds(f"{ours:.1f} %/s, {raw:.0f} %/s without the observer", calm.holds, "a twentieth"),
        "faster": holds(
            f"{crossovers[1] / PUBLISHED_POLE:.1f} times; ripple {ours:.1f} %/s",
            calm.holds and crossovers[1] > PUBLISHED_POLE,
            "above 1, ripple a twentieth of that of raw speed",
        ),
        "slower": holds(
            f"{crossovers[1]:.3f} Hz", crossovers[1] < crossovers[0], f"below {crossovers[0]:.3g} Hz"
        ),
    }


def _supervisor(found: dict[str, Any]) -> Findings:
    states = {name: numbers.switches(found[name])[1] for name in ("fig8 bus", "fig9 bus")}
    pairs = {pair for each in states.values() for pair in pairwise(each)}
    run, varying = found["fig8 bus"], found["fig9 bus"]
    taken = float(run.time[(run.time >= _RELEASE) & (run["ecu.state"] == 0)][0])
    lowest = [float(varying[f"planner.{name}_bound"].min()) for name in ("acceleration", "speed")]
    return {
        "begins": holds("DCS in Figs. 8 and 9", all(each[0] == 0 for each in states.values())),
        "no V to A": holds(
            ", ".join(sorted(f"{'DAV'[a]} to {'DAV'[b]}" for a, b in pairs)), (2, 1) not in pairs, "no V to A"
        ),
        "release": holds(
            f"in DCS from {taken:.2f} s on", taken <= _RELEASE + 0.5, "before g_d is 0, at 30.5 s"
        ),
        "bounds": holds(f"{lowest[0]:.2g} m/s², {lowest[1]:.3g} km/h", min(lowest) >= 0.0, "≥ 0"),
        "slow bounds": at_least(
            varying.manifest["units"]["planner"]["parameters"]["period"] / TIME_CONSTANT, 10.0, digits=3
        ),
    }


def _figure_8(found: dict[str, Any]) -> Findings:
    rows: dict[str, list[Found]] = {by: [] for by in ("states", "settled", "jump", "crossing")}
    for name, of in _VARIANTS.items():
        run = found[f"fig8 {name}"]
        states = " ".join("DAV"[s] for s in numbers.switches(run)[1])
        above = numbers.time_above_bound(run)
        rows["states"].append(holds(states, states == "D A V D", "D A V D", of=of))
        rows["settled"].append(at_most(numbers.settled_error(run), 0.55, "km/h", digits=3, of=of))
        rows["jump"].append(at_most(numbers.largest_jump(run), 1.0, "%", digits=2, of=of))
        rows["crossing"].append(holds(f"{above:.2f} s", 0.0 < above <= 3.0, "above 0, at most 3 s", of=of))
    return rows


def _figure_9(found: dict[str, Any]) -> Findings:
    run = found["fig9 bus"]
    order = np.argsort(run["planner.speed_estimate"][1:], kind="stable")
    rising = float(np.diff(run["planner.acceleration_bound"][1:][order]).max())
    return {
        "a_b falls": at_most(rising, 1e-9, "m/s²", digits=2),
        "fig9": [
            at_most(_late_excess(found[f"fig9 {name}"]), 0.55, "km/h", digits=3, of=of)
            for name, of in _VARIANTS.items()
        ],
    }


def _acceleration(found: dict[str, Any]) -> Findings:
    """Return what the observer and speed control do to the acceleration, in Fig. 8."""
    raw, ours = (numbers.time_above_bound(found[f"fig8 {name}"]) for name in ("raw", "bus"))
    return {
        "filter lags": holds(f"{raw:.2f} s and {ours:.2f} s", raw > 1.5 * ours, "half as long again"),
        "in VCS": [
            at_most(numbers.settled_acceleration(found[f"fig8 {name}"]), 0.05, "m/s²", digits=2, of=of)
            for name, of in _VARIANTS.items()
        ],
    }


def _late_excess(results: Results) -> float:
    """Return the largest v - v_b [km/h] in VCS, 8 s after a switch or later."""
    late = (results["ecu.state"] == 2) & (numbers.since_switch(results) > 8.0)
    return float(numbers.over_bound(results)[late].max())


def _ranges(found: dict[str, Any]) -> Findings:
    """Return the ranges of the bounds that were run, and what a_b does to the consumption."""
    low, *_, high = bounds.ACCELERATION_BOUNDS
    rest, slowest, fastest = found["a_b = 0"], min(bounds.SPEED_BOUNDS), max(bounds.SPEED_BOUNDS)
    fall = [found[f"ride v_b = {max(bounds.FREE):g}"], *(found[f"ride a_b = {a:g}"] for a in (1.0, 0.5))]
    equal = {a: bounds.at_equal_speed(found, a) for a in (1.0, 0.5)}
    shown = ", ".join(f"{used:.1f} Wh/km at {speed:.1f} km/h" for used, speed in fall)
    beside = " and ".join(f"{other:.1f}" for _, _, other in equal.values())
    return {
        "range of a_b": holds(
            f"0 (the vehicle stays where it is) and {low:g} to {high:g} m/s²",
            rest.distance < 1e-6 and [0.0, high] == printed.row("scooter", "range of a_b").numbers,
        ),
        "range of v_b": holds(
            f"{slowest:g} to {fastest:g} km/h",
            [slowest, fastest] == printed.row("scooter", "range of v_b").numbers,
        ),
        "less consumption": holds(
            f"without, a_b = 1, a_b = 0.5 m/s²: {shown}; at the latter two speeds without a_b, below a v_b: "
            f"{beside} Wh/km",
            fall[0][0] > fall[1][0] > fall[2][0],
            "falls with a_b",
        ),
    }


def _own(found: dict[str, Any], identified: ScooterIdentification) -> Findings:
    product = identified.numbers["gain x pole over published"]
    shares = {
        of: found[f"fig8 {name}"] for name, of in (_VARIANTS | {"wheels": "speed of the wheels"}).items()
    }
    varying = {of: found[f"fig9 {name}"] for name, of in _VARIANTS.items()}
    return {
        "identified gain x pole, over the printed ones": near(product, 1.0, 0.03, reason=_QUANTIZER),
        "Fig. 8: time in D / A / V": [_time_in_states(run, of) for of, run in shares.items()],
        "Fig. 8: overshoot over v_b": [
            at_most(float(numbers.over_bound(run).max()), 1.5, "km/h", digits=3, of=of)
            for of, run in shares.items()
        ],
        "mean ESR of the linear model (4)": near(identified.numbers["mean ESR [%]"], 2.30, 0.1, "%"),
        "mean ESR of the non-linear model (3)": near(identified.nonlinear_esr, 1.08, 0.1, "%"),
        "rms of the throttle's rate, without and with observer, speed of the wheels not rounded": near(
            found["fig8 fine False"] / found["fig8 fine True"], 1.99, 0.1, digits=3
        ),
        **_over_bounds(found),
        "Fig. 9: switches": [_nine_switches(run, of) for of, run in varying.items()],
        "gain over 25 to 49 km/h: largest change of the linearized one": at_most(
            _spread([gain for gain, _ in (numbers.linearized(v) for v in SPEEDS)]), 1e-3, "%", digits=1
        ),
        **_energy(found),
    }


def _spread(gains: list[float]) -> float:
    """Return the largest distance of gains from the printed one, in per cent of it."""
    return 100.0 * max(abs(gain / PUBLISHED_GAIN - 1.0) for gain in gains)


def _over_bounds(found: dict[str, Any]) -> Findings:
    """Return what the map over both bounds, and the rides at equal mean speed, gave before."""
    many, dwelling = bounds.at(found, 4.0, 30.0).switches, found["dwell"].switches
    pairs = [(a, v) for a in bounds.ACCELERATION_BOUNDS for v in bounds.SPEED_BOUNDS]
    highest = max(bounds.at(found, *pair).overshoot for pair in pairs)
    more = {a: bounds.at_equal_speed(found, a) for a in bounds.ALONE}
    return {
        "a_b = 4 m/s²: switches, and with a dwell time of 0.5 s": holds(
            f"{many}, {dwelling}", (many, dwelling) == (26, 6), "26, 6"
        ),
        "a_b = 2 m/s²: overshoot over v_b = 30 km/h": near(
            bounds.at(found, 2.0, 30.0).overshoot, 1.67, 0.05, "km/h", digits=3
        ),
        "a_b to 4 m/s², v_b from 30 to 50 km/h: highest overshoot": at_most(highest, 2.0, "km/h", digits=3),
        "a_b alone, at equal mean speed: consumption over that of v_b alone": [
            near(used / other, ratio, 0.015, digits=4, of=f"{a:g} m/s², {speed:.1f} km/h")
            for (a, (speed, used, other)), ratio in zip(more.items(), (1.030, 1.016), strict=True)
        ],
    }


def _time_in_states(results: Results, of: str) -> Found:
    spent = numbers.time_in_states(results)
    close = all(abs(a - b) <= 0.1 for a, b in zip(spent, (10.9, 8.1, 21.1), strict=True))
    return holds(f"{' / '.join(f'{t:.2f}' for t in spent)} s", close, "10.9 / 8.1 / 21.1 s ± 0.1", of=of)


def _nine_switches(results: Results, of: str) -> Found:
    count = len(numbers.switches(results)[0])
    return holds(str(count), count == 9, "9", of=of)


def _energy(found: dict[str, Any]) -> Findings:
    rows: dict[str, Found] = {}
    for bounded, (consumption, speed) in ((True, (43.0, 24.1)), (False, (73.7, 39.7))):
        got = found[f"stop and go {bounded}"]
        what = f"stop and go, bounds {'on' if bounded else 'off'}"
        rows[f"{what}: consumption"] = near(got[0], consumption, 0.02 * consumption, "Wh/km", digits=3)
        rows[f"{what}: mean speed"] = near(got[1], speed, 0.02 * speed, "km/h", digits=3)
    for cycle in ("ece15", "udds"):
        on, off = found[f"{cycle} True"], found[f"{cycle} False"]
        shown = ", ".join(
            f"{metrics['energy per distance']:.1f} Wh/km, {metrics['mean speed']:.1f} km/h, "
            f"{metrics['share of the distance not followed']:.1f} % not followed"
            for metrics in (on, off)
        )
        saves = on["energy per distance"] < off["energy per distance"]
        rows[f"{cycle}, bounds on, then off"] = holds(shown, saves, "bounds save energy")
    return rows


PAPER = Paper("scooter", _runs, _page, _pictures)
