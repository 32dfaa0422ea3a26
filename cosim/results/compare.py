"""Comparison of two runs: how far apart each variable is, and when.

Two values are equal when

    |b - a| <= tolerance + relative * (max a - min a)

`tolerance` is absolute, in the variable's unit in `a`; `relative` is a share of the range that the variable
goes through in `a`, so that it means the same for a power in W and a state of charge, and no value near
zero is judged more strictly than its neighbors: `a` is the reference, so that the tolerance is known before
`b` is. A NaN, on either side or on both, is a difference. So are a variable that one side alone has, unless
only `common` ones are wanted, a longer stretch of time, and other states of an enumeration.

Both tolerances are 0 unless given: then the values are compared with equal bits but for the sign of zero, and
a time that one run alone has, and a type or unit of measure that the runs do not share, are differences too.
With a tolerance they are remarks: runs of other steps, or of another vehicle, can be as near as it says. A
table alone, as a CSV file, declares no types and units; so it differs in none.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from ..errors import ConfigError
from ..row_store import Array
from ..units.conversion import conversion
from ..units.definition import defined
from ..units.measure import Affine
from ..visible import on_one_line
from .common_times import CommonTimes, NotCompared
from .results import Results, ResultVariable
from .text_table import shown_text

_SQUARES = 1e150  # the squares of greater differences overflow


@dataclasses.dataclass(frozen=True)
class VariableDifference:
    """The difference of a variable of `b` from that of `a`, in `unit` (that of `a`).

    `difference` is the largest, at `time` [s]; `rms` is over all compared points, `range` max - min in `a`.
    It is infinite where one side is not a number, and NaN where nothing could be compared: `remark` says why.
    So it is of texts, of which `time` is the first at which they differ.
    """

    name: str
    unit: str
    difference: float
    time: float
    rms: float
    range: float
    equal: bool
    remark: str = ""

    @property
    def relative(self) -> float:
        """The largest difference as a share of the range; infinite for one from a constant."""
        if math.isnan(self.difference):
            return math.inf
        if self.difference == 0.0:
            return 0.0
        return self.difference / self.range if 0.0 < self.range < math.inf else math.inf


@dataclasses.dataclass(frozen=True)
class Comparison:
    """The outcome: a row for each common variable, the names on one side alone, and remarks.

    `points` is the number of compared times, of which `only_times_a` and `only_times_b` are of one run alone.
    `not_compared` are the points of one run before or after the other; `same_span` is true without any. With
    `common`, variables of one side alone are no difference. Where the rows of both are not the `same_rows` in
    number, one of them has times that the other has not, or has fewer often.
    """

    rows: tuple[VariableDifference, ...]
    only_a: tuple[str, ...]
    only_b: tuple[str, ...]
    points: int
    only_times_a: int
    only_times_b: int
    not_compared: tuple[NotCompared, ...]
    same_span: bool
    tolerance: float
    relative: float
    remarks: tuple[str, ...] = ()
    common: bool = False
    same_rows: bool = True

    @property
    def equal(self) -> bool:
        """True where both have the same variables, and each is equal at every time of both runs.

        Runs with nothing in common, or of which one goes on longer, are not equal; without a tolerance
        neither are runs of which one has times that the other has not.
        """
        compared = bool(self.rows) and self.points > 0 and all(row.equal for row in self.rows)
        same_times = self.same_span and (self._same_times or not self.exact)
        return compared and same_times and (self.common or not (self.only_a or self.only_b))

    @property
    def _same_times(self) -> bool:
        return self.same_rows and not (self.only_times_a or self.only_times_b)

    @property
    def exact(self) -> bool:
        """True where no difference is allowed."""
        return not (self.tolerance or self.relative)

    def table(self, all_rows: bool = True) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
        """Return the header and the rows as text; without `all_rows`, only of variables that differ."""
        header = ("variable", "unit", "largest difference", "at t [s]", "rms", "of the range", "")
        return header, [_cells(row) for row in self.rows if all_rows or not row.equal]

    def summary(self) -> str:
        """Return the outcome in a few lines."""
        different = [row for row in self.rows if not row.equal]
        rule = f"tolerance {self.tolerance:g}" + (
            f" + {100 * self.relative:g} % of the range" if self.relative else ""
        )
        what = f"{len(self.rows)} common variables at {self.points} times, {rule}"
        lines = [f"equal: {what}" if self.equal else f"different: {len(different)} of {what}"]
        for names, side in ((self.only_a, "first"), (self.only_b, "second")):
            if names:
                counts = "" if self.common else " (a difference, unless --common leaves it out)"
                lines.append(f"only in the {side}: {', '.join(names)}{counts}")
        lines += self.remarks
        if self.exact and self.same_span and not self._same_times:
            lines.append("without a tolerance, times of one run alone are a difference")
        return "\n".join(map(on_one_line, lines))


def _cells(row: VariableDifference) -> tuple[str, ...]:
    share = f"{100 * row.relative:.3g} %" if math.isfinite(row.relative) else "-"
    verdict = row.remark or ("" if row.equal else "differs")
    numbers = (f"{row.difference:.4g}", f"{row.time:.10g}", f"{row.rms:.4g}")
    return (row.name, row.unit, *("-" if n == "nan" else n for n in numbers), share, verdict)


def compare(
    a: Results, b: Results, tolerance: float = 0.0, relative: float = 0.0, common: bool = False
) -> Comparison:
    """Compare two results at the times of both, over the stretch that both cover.

    Where one of them lacks a time it is interpolated: linearly between continuous values, the previous value
    for what is held. Units of measure are converted. With `common`, a variable that one of them alone has is
    no difference. Raises ConfigError for a negative or NaN tolerance, and for an infinite `relative`.
    """
    for name, value in (("tolerance", tolerance), ("relative", relative)):
        if not value >= 0.0:
            raise ConfigError(f"{name} = {value!r}: a tolerance is a number and must not be negative")
    if math.isinf(relative):
        raise ConfigError(
            f"a relative tolerance must be finite, not {relative!r}: it is a share of the range"
        )
    at = CommonTimes.of(a.time, b.time)
    rows = [_compared(a, b, v, at, (tolerance, relative)) for v in a.variables if v.name in b.names]
    rows += [_compared_texts(a, b, name, at) for name in a.texts if name in b.texts]
    for name in (*(n for n in a.names if n in b.texts), *(n for n in a.texts if n in b.names)):
        rows.append(_without_values(name, "", "a text on one side, numbers on the other"))
    return Comparison(
        rows=tuple(rows),
        only_a=tuple(name for name in (*a.names, *a.texts) if name not in b),
        only_b=tuple(name for name in (*b.names, *b.texts) if name not in a),
        points=len(at.time),
        only_times_a=at.second.interpolated,
        only_times_b=at.first.interpolated,
        not_compared=at.not_compared,
        same_span=at.same_span,
        tolerance=tolerance,
        relative=relative,
        remarks=at.remarks,
        common=common,
        same_rows=len(a) == len(b),
    )


def difference(a: Results, b: Results, name: str) -> tuple[Array, Array]:
    """Return times [s] and b - a of a common variable, in its unit in `a`, shapes (n,).

    The times are those at which the two are compared. Raises ConfigError where they measure different
    quantities, or one of them lacks the variable.
    """
    at = CommonTimes.of(a.time, b.time)
    variable, other = a.variable(name), b.variable(name)
    convert, _ = _conversion(other, variable)
    held = variable.held or other.held
    values = at.second.values(b.column(name), held, at.time)
    return at.time, convert.scale * values + convert.offset - at.first.values(a.column(name), held, at.time)


def _compared(
    a: Results, b: Results, variable: ResultVariable, at: CommonTimes, allowed: tuple[float, float]
) -> VariableDifference:
    """Compare a variable of both; `allowed` are the absolute difference, and the share of the range."""
    other = b.variable(variable.name)
    unit = variable.unit or other.unit
    try:
        convert, remark = _conversion(other, variable)
    except ConfigError as error:
        return _without_values(variable.name, unit, str(error))
    held = variable.held or other.held
    x = at.first.values(a.column(variable.name), held, at.time)
    y = at.second.values(b.column(variable.name), held, at.time)
    if not convert.identity:
        y = convert.scale * y + convert.offset
    if not len(x):
        return _without_values(variable.name, unit, "no common time")
    apart = _differences(x, y)
    worst = int(np.argmax(apart))
    largest, span = float(apart[worst]), _range(x)
    tolerance, relative = allowed
    share = relative * span if math.isfinite(span) else 2 * relative * _range(x / 2)
    equal = math.isfinite(largest) and largest <= tolerance + share
    remarks, alike = _kinds(variable, other, remark)
    if a.manifest and b.manifest and not any(allowed):  # both are runs, which declare types and units
        equal = equal and not remarks
    rms = _rms(apart, largest)
    when = float(at.time[worst])
    return VariableDifference(variable.name, unit, largest, when, rms, span, equal and alike, remarks)


def _kinds(one: ResultVariable, other: ResultVariable, remark: str) -> tuple[str, bool]:
    """Return what differs in the kinds of a variable of both runs, after a `remark` ("": nothing).

    The second value is False for two enumerations whose states are not the same.
    """
    said = [remark] if remark else []
    if one.type != other.type:
        said.append(f"{one.type} in the first, {other.type} in the second")
    states = [dict(each.items) for each in (one, other)]
    changed = [k for k in sorted({*states[0], *states[1]}) if states[0].get(k) != states[1].get(k)]
    if not (all(states) and changed):
        return "; ".join(said), True
    first, second = ("no state" if k is None else repr(k) for k in (each.get(changed[0]) for each in states))
    said.append(f"{changed[0]} is {first} in the first, {second} in the second")
    return "; ".join(said), False


def _compared_texts(a: Results, b: Results, name: str, at: CommonTimes) -> VariableDifference:
    x, y = at.first.texts(a[name]), at.second.texts(b[name])
    if not len(x):
        return _without_values(name, "", "no common time")
    apart = np.flatnonzero(x != y)
    row = _without_values(name, "", "")
    if not len(apart):
        return dataclasses.replace(row, equal=True)
    first = int(apart[0])
    texts = f"{shown_text(x[first])} and {shown_text(y[first])}"
    said = f"{texts}; they differ at {len(apart)} of {len(x)} times"
    return dataclasses.replace(row, time=float(at.time[first]), remark=said)


def _without_values(name: str, unit: str, remark: str) -> VariableDifference:
    return VariableDifference(name, unit, math.nan, math.nan, math.nan, math.nan, equal=False, remark=remark)


def _conversion(other: ResultVariable, variable: ResultVariable) -> tuple[Affine, str]:
    """Return the map between the units of two variables, and a remark where one side declares none."""
    source, target = other.unit, variable.unit
    if source == target:
        return Affine(), ""
    if not source or not target:
        return Affine(), f"[{source or target}] on one side only: compared as numbers"
    difference = other.difference or variable.difference  # of a bare table nobody knows
    return conversion(defined(source), defined(target), (difference, difference)), ""


def _differences(x: Array, y: Array) -> Array:
    """Return |y - x|, infinite where either is NaN; all shapes (n,)."""
    with np.errstate(invalid="ignore", over="ignore"):
        apart = np.where(x == y, 0.0, np.abs(y - x))  # equal infinities differ by nothing
    return np.where(np.isnan(apart), np.inf, apart)


def _rms(apart: Array, largest: float) -> float:
    """Return the root of the mean square of differences, shape (n,), of which one is the `largest`."""
    if not math.isfinite(largest):
        return math.inf
    scale = largest if largest > _SQUARES else 1.0
    return scale * float(np.sqrt(np.mean((apart / scale) ** 2)))


def _range(values: Array) -> float:
    """Return max - min of the finite values, shape (n,): 0 without any, infinite beyond the doubles."""
    finite = values[np.isfinite(values)]
    with np.errstate(over="ignore"):
        return float(finite.max() - finite.min()) if len(finite) else 0.0


def worst(rows: Sequence[VariableDifference], count: int) -> list[str]:
    """Return the names of the `count` variables that differ most, by their share of the range.

    Where none differs they are the first of all. Those that could not be compared, as a speed with a force,
    are left out.
    """
    compared = [row for row in rows if not math.isnan(row.difference)]
    different = [row for row in compared if row.relative > 0.0] or compared
    return [row.name for row in sorted(different, key=lambda row: -row.relative)[:count]]
