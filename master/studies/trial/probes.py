"""What a trial looks at: from runs of an FMU and of the unit that is there now to findings."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np

from ....cosim.analysis.signs import Pair, alike, direction
from ....cosim.errors import ConfigError, RunError
from ....cosim.interface import VariableInfo
from ....cosim.row_store import Array
from ...fmi.fmu import is_true
from ...isolation.unit import IsolatedUnit
from .bench import Bench, largest
from .levels import Level

Verdict = Literal["good", "note", "problem"]
Columns = Mapping[str, Array]

_MATTERS = 0.01  # of an output's range: a difference between step sizes
_NO_REACTION = 1e-3  # of the reaction that the unit has that is there now
_LIKE, _UNLIKE = 0.5, 5.0  # agreement of two courses from which on they are alike; ratio from which on not
_ABSURD = 1e4  # times the largest value of the unit that is there now
_FACTORS = {3.6: "km/h beside m/s", 1000.0: "kilo", 100.0: "%", 180.0 / math.pi: "deg beside rad",
            60.0 / (2.0 * math.pi): "rpm beside rad/s", 9.80665: "g beside m/s2"}  # fmt: skip # mistakes


@dataclasses.dataclass(frozen=True)
class Finding:
    """One thing that a trial saw: `what` was looked at, a verdict, and a sentence.

    "problem": it should not run like this; "note": worth knowing; "good": as it should be.
    """

    what: str
    verdict: Verdict
    text: str


def failed(what: str, error: Exception) -> Finding:
    """A run that ended before its end."""
    return Finding(what, "problem", " ".join(str(error).split()))


def _number(x: float, digits: int = 3) -> str:
    return f"{float(f'{x:.{digits}g}'):g}"


# ---- reactions


@dataclasses.dataclass(frozen=True)
class Reaction:
    """How both units react with one output to one input; `sign` is 1 where they agree, -1 for the other sign,
    0 where that cannot be said."""

    pair: Pair
    finding: Finding
    sign: int


def reaction(pair: Pair, unit: str, theirs: Array, ours: Array) -> Reaction | None:
    """Compare the changes of an output, shape (n,), that the same input made; None where neither has one."""
    size, expected = largest(theirs), largest(ours)
    what, measure = " -> ".join(pair), "" if unit in ("", "1") else f" {unit}"
    if expected == 0.0:
        if size == 0.0:
            return None
        text = f"{_moves(theirs)} it by up to {_number(size)}{measure}; that of the system does not react"
        return Reaction(pair, Finding(what, "note", text), 0)
    now = f"that of the system {_moves(ours)} it by up to {_number(expected)}{measure}"
    if size < _NO_REACTION * expected:
        return Reaction(pair, Finding(what, "problem", f"no reaction; {now}"), 0)
    ratio, agreement = alike(theirs, ours)
    told = f"{_moves(theirs)} it by up to {_number(size)}{measure}"
    if agreement <= -_LIKE:
        return Reaction(pair, Finding(what, "problem", f"{told}: the other sign; {now}"), -1)
    if agreement < _LIKE:
        return Reaction(pair, Finding(what, "note", f"{told}, in another course; {now}"), 0)
    guess = _guess(ratio, agreement)
    if guess or not 1.0 / _UNLIKE < ratio < _UNLIKE:
        said = f"{told}, {_number(ratio)} times as much as it should{guess}; {now}"
        return Reaction(pair, Finding(what, "problem", said), 1)
    same = f"{told}, as that of the system ({_number(expected)}{measure})"
    return Reaction(pair, Finding(what, "good", same), 1)


def _moves(change: Array) -> str:
    return {1: "raises", -1: "lowers", 0: "moves"}[direction(change)]


def _guess(ratio: float, agreement: float) -> str:
    """Which mistake in a unit of measure would give the ratio; "" where none is near."""
    for factor, name in _FACTORS.items():
        if agreement > 0.99 and min(abs(ratio / factor - 1.0), abs(ratio * factor - 1.0)) < 0.03:
            return f": is its unit of measure another one ({name})?"
    return ""


# ---- values


def values(columns: Sequence[Columns], ours: Sequence[Columns], bench: Bench) -> list[Finding]:
    """Values far beyond those of the unit that is there now, and beyond the FMU's own limits."""
    found = []
    for name in bench.outputs:
        variable = bench.interface.variables[name]
        reached = [c[name] for c in columns if name in c]
        if not reached:
            continue
        low, high = (f(float(f(c)) for c in reached) for f in (min, max))
        known = max((largest(c[name]) for c in ours if name in c), default=0.0)
        if max(abs(low), abs(high)) > _ABSURD * (known or 1e5):
            text = f"from {_number(low)} to {_number(high)}; that of the system stays within {_number(known)}"
            found.append(Finding(f"values of {name}", "problem", text))
        elif text := _beyond(variable, reached, bench):
            found.append(Finding(f"values of {name}", "note", text))
    return found


def _beyond(v: VariableInfo, reached: Sequence[Array], bench: Bench) -> str:
    """That values leave the limits which the FMU itself declares; "" where they do not."""
    scale = bench.to_ours(v.name)
    low, high = min(float(np.min(c)) for c in reached), max(float(np.max(c)) for c in reached)
    room = 1e-9 * max(abs(low), abs(high))
    if v.min is not None and low < scale(v.min) - room:
        return f"goes down to {_number(low)}, below the FMU's own min {_number(scale(v.min))}"
    if v.max is not None and high > scale(v.max) + room:
        return f"goes up to {_number(high)}, above the FMU's own max {_number(scale(v.max))}"
    return ""


# ---- limits of inputs


def input_ends(bench: Bench, given: Mapping[str, Level]) -> list[Finding]:
    """What the system can give to an input and the FMU does not take."""
    found = []
    for name, level in given.items():
        v = bench.interface.variables.get(name)
        if v is None or v.causality != "input" or (v.min is None and v.max is None):
            continue
        map_ = bench.from_ours(name)
        ends = sorted(map_(end) for end in level.limits)
        if (v.max is not None and ends[1] > v.max * (1.0 + 1e-9)) or (v.min is not None and ends[0] < v.min):
            takes = f"from {_end(v.min)} to {_end(v.max)}"
            text = f"the system can give {_end(ends[0])} to {_end(ends[1])} [{v.unit}], the FMU takes {takes}"
            found.append(Finding(f"range of {name}", _cut(ends, v), text))
    return found


def _cut(ends: Sequence[float], v: VariableInfo) -> Verdict:
    """Nobody says how far an input goes: that is worth a note; a limit that is said is a problem."""
    said = any(
        math.isfinite(end) and limit is not None and (end - limit) * side > 0.0
        for end, limit, side in zip(ends, (v.min, v.max), (-1.0, 1.0), strict=True)
    )
    return "problem" if said else "note"


def _end(x: float | None) -> str:
    return "any value" if x is None or not math.isfinite(x) else f"{x:.6g}"


# ---- step sizes


def steps(
    run: Callable[[int], Columns], counts: Sequence[int], names: Sequence[str], period: float
) -> tuple[Finding, int]:
    """How far the outputs `names` with `counts` FMU steps in a period are from those with the last of them,
    and how many steps are enough. `run` raises RunError where the FMU fails."""
    reference = run(counts[-1])
    apart: list[float] = []
    worst = ""
    for count in counts[:-1]:
        try:
            columns = run(count)
            found = {name: _apart(columns[name], reference[name]) for name in names}
        except RunError:
            found = {"the run, which fails": math.inf}
        name = max(found, key=lambda n: found[n], default="")
        worst = worst or name
        apart.append(found.get(name, 0.0))
    names = ", ".join(f"{1000.0 * period / count:g}" for count in counts[:-1])
    told = ", ".join(map(_share, apart))
    text = f"of {names} ms differ from those of {1000.0 * period / counts[-1]:g} ms by {told} of the range"
    if apart[0] <= _MATTERS:
        return Finding("steps", "good", text), counts[0]
    enough = next((c for c, a in zip(counts, apart, strict=False) if a <= _MATTERS), counts[-1])
    if apart[-1] > _MATTERS:
        text += f" ({worst}); still smaller ones may be needed"
    else:
        text += f" ({worst}): substeps = {enough}"
    return Finding("steps", "problem", text), enough


def _share(apart: float) -> str:
    if math.isinf(apart):
        return "no result"
    return "more than 1000 %" if apart > 10.0 else f"{100.0 * apart:.2g} %"


def _apart(values: Array, reference: Array) -> float:
    span, size = float(np.ptp(reference)), largest(reference)
    difference = largest(values - reference)
    return difference / span if span > 1e-9 * size else 0.0 if difference <= 1e-9 * size else math.inf


# ---- a unit that is there: its speed, and its state


def speed(unit: IsolatedUnit, at: float, step: float, seconds: float) -> Finding:
    """The time of a step of `step` s from the time `at` on, from the fastest of many stretches."""
    count, best, end = 1, math.inf, time.perf_counter() + seconds
    while True:
        begin = time.perf_counter()
        unit.start_step(at, step, count)
        unit.finish_step()
        took = time.perf_counter() - begin
        at += count * step
        best = min(best, took / count)
        if time.perf_counter() > end:
            break
        if took < 0.01 and count < 256:
            count *= 2
    times = step / best if best > 0.0 else math.inf
    told = f"{_number(1e6 * best, 2)} us for a step of {1000.0 * step:g} ms"
    text = f"{told}, {_number(times, 2)} times as fast as real time"
    return Finding("speed", "good" if times >= 1.0 else "note", text)


_STEPS = 25


def state(unit: IsolatedUnit, bench: Bench, at: float) -> Finding:
    """Whether the unit goes on from a saved state as it did before, whatever it declares."""
    kind = bench.fmu.kind
    declared = is_true(kind, "canGetAndSetFMUstate") or is_true(kind, "canGetAndSetFMUState")
    but = (
        "declares that it saves its state, but " if declared else "does not declare that it saves its state; "
    )
    if bench.fmu.description.fmiVersion.startswith("1"):
        return Finding("state", "note", "FMI 1.0 cannot save it")
    try:
        number = unit.save_state()
        before = _outputs(unit, bench)
        first = _onward(unit, bench, at)
        unit.restore_state(number)
        back = _outputs(unit, bench)
        second = _onward(unit, bench, at)
        unit.free_state(number)
    except (ConfigError, RunError) as error:
        if not declared:
            return Finding("state", "note", "is not saved, as it declares")
        return Finding("state", "note", but + " ".join(str(error).split()))
    if first == [before] * _STEPS:
        return Finding("state", "note", "nothing moved in the trial, so that restoring it shows nothing")
    if second != first or back != before:
        return Finding("state", "note", but + "what it restores goes on otherwise")
    if not declared:
        return Finding("state", "note", but + "it does, and restores it to the last bit")
    return Finding("state", "good", "is saved, and restored to the last bit")


def _outputs(unit: IsolatedUnit, bench: Bench) -> tuple[object, ...]:
    return tuple(unit.get(name) for name in bench.outputs)


def _onward(unit: IsolatedUnit, bench: Bench, at: float) -> list[tuple[object, ...]]:
    """The outputs after each of some steps from a time on, the inputs held."""
    found = []
    for k in range(_STEPS):
        unit.start_step(at + k * bench.period, bench.period / bench.entry.substeps, bench.entry.substeps)
        unit.finish_step()
        found.append(_outputs(unit, bench))
    return found
