"""The probes of a trial: functions from runs of an FMU and of the present unit to findings."""

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
from ....cosim.plan.unit_plan import FmuSteps
from ....cosim.row_store import Array
from ...fmi.fmu import is_true
from ...isolation.unit import IsolatedUnit
from .bench import Bench, largest
from .levels import Level

Verdict = Literal["good", "note", "problem"]
Columns = Mapping[str, Array]

_MATTERS = 0.01  # of an output's range: a difference between step sizes
_NO_REACTION = 1e-3  # of the present unit's reaction
_LIKE, _UNLIKE = 0.5, 5.0  # agreement of two courses from which on they are alike; ratio from which on not
_ABSURD = 1e4  # times the largest value of the present unit
_FACTORS = {3.6: "km/h beside m/s", 1000.0: "kilo", 100.0: "%", 180.0 / math.pi: "deg beside rad",
            60.0 / (2.0 * math.pi): "rpm beside rad/s", 9.80665: "g beside m/s2"}  # fmt: skip # mistakes


@dataclasses.dataclass(frozen=True)
class Finding:
    """A result of a trial: `what` was examined, a verdict, and a sentence.

    "problem": it should not run like this; "note": worth knowing; "good": nothing is wrong.
    """

    what: str
    verdict: Verdict
    text: str


def failed(what: str, error: Exception) -> Finding:
    """Return the finding of a run that ended before its end."""
    return Finding(what, "problem", " ".join(str(error).split()))


def _number(x: float, digits: int = 3) -> str:
    return f"{float(f'{x:.{digits}g}'):g}"


# ---- reactions


@dataclasses.dataclass(frozen=True)
class Reaction:
    """The reactions of one output of both units to one input.

    `sign` is 1 if they agree, -1 if they are opposite, 0 if neither is certain.
    """

    pair: Pair
    finding: Finding
    sign: int


def reaction(pair: Pair, unit: str, theirs: Array, ours: Array) -> Reaction | None:
    """Compare the changes of an output, shape (n,), in `unit`, that the same input caused.

    Return None if neither unit reacts.
    """
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
    moved = f"{_moves(theirs)} it by up to {_number(size)}{measure}"
    if agreement <= -_LIKE:
        return Reaction(pair, Finding(what, "problem", f"{moved}: the other sign; {now}"), -1)
    if agreement < _LIKE:
        return Reaction(pair, Finding(what, "note", f"{moved}, in another course; {now}"), 0)
    guess = _guess(ratio, agreement)
    if guess or not 1.0 / _UNLIKE < ratio < _UNLIKE:
        text = f"{moved}, {_number(ratio)} times as much as it should{guess}; {now}"
        return Reaction(pair, Finding(what, "problem", text), 1)
    same = f"{moved}, as that of the system ({_number(expected)}{measure})"
    return Reaction(pair, Finding(what, "good", same), 1)


def _moves(change: Array) -> str:
    return {1: "raises", -1: "lowers", 0: "moves"}[direction(change)]


def _guess(ratio: float, agreement: float) -> str:
    """Return a question about the unit of measure whose mistake would give the ratio; "" if none would."""
    for factor, name in _FACTORS.items():
        if agreement > 0.99 and min(abs(ratio / factor - 1.0), abs(ratio * factor - 1.0)) < 0.03:
            return f": is its unit of measure another one ({name})?"
    return ""


# ---- values


def values(columns: Sequence[Columns], ours: Sequence[Columns], bench: Bench) -> list[Finding]:
    """Find values far beyond those of the present unit (`ours`), and beyond the FMU's own limits."""
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
    """Return a sentence about values beyond the limits that the FMU itself declares; "" if there are none."""
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
    """Find inputs to which the system can give values that the FMU does not take."""
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
    """Return "problem" if a declared end exceeds the FMU's limit, "note" if an undeclared one may."""
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
    """Compare the outputs `names` with `counts` FMU steps in a period [s] with those of the last count.

    Return the finding and the number of steps that is enough. `run` raises RunError if the FMU fails.
    """
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
    shares = ", ".join(map(_share, apart))
    text = f"of {names} ms differ from those of {1000.0 * period / counts[-1]:g} ms by {shares} of the range"
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
    """Return the largest difference of two courses, shape (n,), as a share of the reference's range."""
    span, size = float(np.ptp(reference)), largest(reference)
    difference = largest(values - reference)
    return difference / span if span > 1e-9 * size else 0.0 if difference <= 1e-9 * size else math.inf


# ---- a unit that is there: its speed, and its state


LONGEST_SPEED = 8192
"""The most steps of a measurement of the speed."""


def speed(unit: IsolatedUnit, at: float, step: float, seconds: float) -> Finding:
    """Measure the time of a step of `step` [s], from the time `at` [s] on: the fastest of many stretches.

    `seconds` [s] is the longest duration of the measurement; it does LONGEST_SPEED steps at most.
    """
    count, left, best, end = 1, LONGEST_SPEED, math.inf, time.perf_counter() + seconds
    while count <= left:
        begin = time.perf_counter()
        unit.start_step(FmuSteps.equal(at, step, count))
        unit.finish_step()
        took = time.perf_counter() - begin
        at += count * step
        left -= count
        best = min(best, took / count)
        if time.perf_counter() > end:
            break
        if took < 0.01 and count < 256:
            count *= 2
    times = step / best if best > 0.0 else math.inf
    text = f"{_number(1e6 * best, 2)} us for a step of {1000.0 * step:g} ms"
    text += f", {_number(times, 2)} times as fast as real time"
    return Finding("speed", "good" if times >= 1.0 else "note", text)


_STEPS = 25
LONGEST_STATE = 2 * _STEPS
"""The periods that a probe of the state needs."""


def state(unit: IsolatedUnit, bench: Bench, at: float) -> Finding:
    """Compare the outputs after a saved state, from the time `at` [s] on, with those after it is restored."""
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
    """Do some periods from the time `at` [s] on, the inputs held; return the outputs after each."""
    found = []
    for k in range(_STEPS):
        substeps = bench.entry.substeps
        unit.start_step(FmuSteps.equal(at + k * bench.period, bench.period / substeps, substeps))
        unit.finish_step()
        found.append(_outputs(unit, bench))
    return found
