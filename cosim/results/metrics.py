"""Metrics: the numbers of a run that a system or scenario file names.

A metric reduces a signal x(t), or the difference of two, over the run from t_0 to t_n:

    final, max, min, range   the last value, the extremes, max - min
    mean                     (1/T) integral x dt,  T = t_n - t_0
    rms                      sqrt((1/T) integral x^2 dt)
    integral                 integral x dt
    integral_above           integral max(x - threshold, 0) dt
    share_above              the share of T in which x > threshold
    share_equal              the share of T in which x = value
    time_above, time_equal   the same as a time
    changes                  how often x changes its value
    settling                 the time from the first to the last instant at which |x| > threshold; none if
                             it is so at t_n

`after` [s] reduces only what lies at and behind that time: t_0 is then the first communication point there.
Integrals are trapezoidal for continuous signals; what is held from one communication point to the next (an
input, a sampled output) is integrated as it is held. `per` divides by a second reduction. The unit of
measure of the outcome follows from those of the signals and is converted to the metric's `unit`: no factor
stands in a file.
"""

from __future__ import annotations

import bisect
import dataclasses
import html
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import SupportsIndex, overload

import numpy as np

from ..errors import ConfigError, nearest
from ..row_store import Array
from ..system.metric_spec import MetricSpec, Reduction
from ..units.conversion import conversion
from ..units.definition import defined, names_difference
from ..units.measure import BASE_UNITS, Affine, UnitOfMeasure
from ..visible import flowing
from .recording import Recording
from .variable import ResultVariable

_SHARES = ("share_above", "share_equal")
_TIMES = ("time_above", "time_equal", "settling")
_VALUES = ("final", "mean", "max", "min", "rms", "range")  # these are in the unit of the signal
_NEEDS_DURATION = ("mean", "rms", *_SHARES)


@dataclasses.dataclass(frozen=True)
class Metric:
    """A named number in a unit of measure, or NaN and the reason why there is none."""

    name: str
    value: float
    unit: str
    reason: str = ""

    @property
    def text(self) -> str:
        """The value with its unit, as a person reads it."""
        if math.isnan(self.value):
            return f"- ({self.reason})"
        return f"{self.value:.4g}" if self.unit in ("", "1") else f"{self.value:.4g} {self.unit}"


class Metrics(list[Metric]):
    """The metrics of a run in the order of its files; `metrics["distance"]` is the one of that name."""

    def __call__(self) -> Metrics:
        """Return the same: `results.metrics()` is `results.metrics`."""
        return self

    @overload
    def __getitem__(self, place: SupportsIndex | str) -> Metric: ...
    @overload
    def __getitem__(self, place: slice) -> list[Metric]: ...
    def __getitem__(self, place: SupportsIndex | slice | str) -> Metric | list[Metric]:
        """Return a metric by place or name, or some by a slice. Raises ConfigError naming the nearest one."""
        if not isinstance(place, str):
            return super().__getitem__(place)
        named = {metric.name: metric for metric in self}
        if place not in named:
            known = ", ".join(named) or "none"
            raise ConfigError(f"the run has no metric '{place}'{nearest(place, named)}; there are: {known}")
        return named[place]

    def __str__(self) -> str:
        """Return a line for each: its name and its value."""
        width = max((len(metric.name) for metric in self), default=0)
        return "\n".join(f"{metric.name.ljust(width)}  {metric.text}" for metric in self) or "no metrics"

    def _repr_html_(self) -> str:
        """Return a table, which a notebook shows."""
        rows = "".join(f"<tr>{_cell(metric.name)}{_cell(metric.text)}</tr>" for metric in self)
        return f"<table>{rows}</table>" if rows else "<p>no metrics</p>"


def _cell(text: str) -> str:
    return f'<td style="text-align: left">{html.escape(flowing(text))}</td>'


def check(specs: Sequence[MetricSpec], variables: Mapping[str, ResultVariable], place: str) -> None:
    """Check metrics against the variables that a run will record.

    Raises ConfigError naming `place` for an unknown variable or state (with the nearest there is), a unit
    of measure that cannot result, and a name given twice. A variable that declares no unit is no error here:
    a metric that needs its unit then has no value, and gives the reason.
    """
    seen: set[str] = set()
    for spec in specs:
        here = f"{place}: metric '{spec.name}'"
        if spec.name in seen:
            raise ConfigError(f"{here} is there twice")
        seen.add(spec.name)
        for part in spec.reductions:
            _check_reduction(part, variables, here)
        try:
            _scale(spec, variables)
        except _NoValueError:
            continue
        except ConfigError as error:
            raise ConfigError(f"{here}: {error}") from error


def _check_reduction(part: Reduction, variables: Mapping[str, ResultVariable], place: str) -> None:
    for name in (part.signal, part.minus):
        if name is not None and name not in variables:
            raise ConfigError(f"{place}: no variable '{name}' is recorded{nearest(name, variables)}")
        if name is not None and variables[name].type == "String":
            raise ConfigError(f"{place}: '{name}' is a String, which has no numbers to reduce")
    if isinstance(part.value, str):
        names = [name for _, name in variables[part.signal].items]
        if part.value not in names:
            raise ConfigError(
                f"{place}: '{part.signal}' has no state '{part.value}'{nearest(part.value, names)}; "
                f"states: {', '.join(names) or 'none'}"
            )


def evaluate(results: Recording, specs: Sequence[MetricSpec]) -> list[Metric]:
    """Return the metrics of a run, in the order of the specs. Raises ConfigError as `check` does."""
    variables = {v.name: v for v in results.variables}
    check(specs, variables, "metrics")
    return [_evaluate(results, spec, variables) for spec in specs]


def _evaluate(results: Recording, spec: MetricSpec, variables: Mapping[str, ResultVariable]) -> Metric:
    def without(reason: str) -> Metric:
        return Metric(spec.name, math.nan, spec.unit, reason)

    if not len(results):
        return without("the run has no communication point")
    parts = spec.reductions
    try:
        scale = _scale(spec, variables)
        numbers = [_reduce(results, part) for part in parts]
    except _NoValueError as error:
        return without(str(error))
    value = numbers[0]
    if spec.per:
        if numbers[1] == 0.0:
            return without(f"the {spec.per.reduce} of {spec.per.signal} is 0")
        value /= numbers[1]
    value = scale(value)
    return Metric(spec.name, value, spec.unit) if math.isfinite(value) else without("it is not finite")


class _NoValueError(ConfigError):
    """A metric that is in order has no value for this run; the message is the reason."""


def _unit(variable: ResultVariable) -> UnitOfMeasure:
    if variable.unit:
        return defined(variable.unit)
    if variable.type == "Real":
        raise _NoValueError(f"'{variable.name}' declares no unit of measure")
    return defined("1")


def _scale(spec: MetricSpec, variables: Mapping[str, ResultVariable]) -> Affine:
    """Return the map from the reductions' numbers, in the signals' units, to the metric's unit."""
    if spec.per is None and spec.reduce in _VALUES and _same(spec.unit, variables[spec.signal].unit):
        _to_signal(spec, variables)  # raises where they measure different quantities
        return Affine()  # nothing to convert, so the unit may be one that nobody defines
    source, target = _outcome(spec, variables), defined(spec.unit)
    difference = False  # of temperatures: 0 of it is 0 in every unit
    if spec.per is not None:
        source = _quotient(source, _outcome(spec.per, variables))
    else:
        difference = spec.minus is not None or spec.reduce == "range" or _is_difference(spec, variables)
    convert = conversion(source, target, (difference, difference))
    if convert.offset and spec.reduce == "rms":
        raise ConfigError(f"an rms in [{source.name}] cannot be given in [{target.name}]: their zeros differ")
    return convert


def _same(a: str, b: str) -> bool:
    return a == b or {a, b} == {"", "1"}


def _outcome(part: Reduction, variables: Mapping[str, ResultVariable]) -> UnitOfMeasure:
    """Return the unit of measure of a reduction's number."""
    _to_signal(part, variables)  # raises where they measure different quantities
    if part.reduce in _SHARES or part.reduce == "changes":
        return defined("1")
    if part.reduce in _TIMES:
        return defined("s")
    unit = _unit(variables[part.signal])
    if part.reduce in ("integral", "integral_above"):
        if unit.offset and not _is_difference(part, variables):
            raise ConfigError(f"an integral of [{unit.name}] has no meaning: its zero is arbitrary")
        return _combined(f"{unit.name}.s", unit, defined("s"), 1)
    return unit


def _to_signal(part: Reduction, variables: Mapping[str, ResultVariable]) -> tuple[Affine, float]:
    """Return the map from the unit of `minus` to the signal's, and the threshold (0: none) in the latter."""
    signal = variables[part.signal]
    other, threshold = Affine(), part.threshold or 0.0
    if part.minus is not None and variables[part.minus].unit != signal.unit:
        minus = variables[part.minus]
        other = conversion(_unit(minus), _unit(signal), (minus.difference, signal.difference))
    if part.threshold_unit is not None and part.threshold_unit != signal.unit:
        # a threshold of a difference has no zero of its own
        difference = part.minus is not None or _is_difference(part, variables)
        source, target = defined(part.threshold_unit), _unit(signal)
        threshold = conversion(source, target, (difference, difference))(threshold)
    return other, threshold


def _is_difference(part: Reduction, variables: Mapping[str, ResultVariable]) -> bool:
    """Return True where a signal is a difference of temperatures, as its description or its unit says."""
    signal = variables[part.signal]
    return signal.difference or names_difference(signal.unit)


def _quotient(a: UnitOfMeasure, b: UnitOfMeasure) -> UnitOfMeasure:
    if a.offset or b.offset:
        raise ConfigError(f"[{a.name}] per [{b.name}] has no meaning: a zero of theirs is arbitrary")
    return _combined(f"{a.name}/({b.name})", a, b, -1)


def _combined(name: str, a: UnitOfMeasure, b: UnitOfMeasure, sign: int) -> UnitOfMeasure:
    """Return the unit a * b (sign 1) or a / b (sign -1)."""
    for unit in (a, b):
        if unit.logarithmic:
            raise ConfigError(f"[{unit.name}] is logarithmic: it has no integral and no quotient")
    nothing = (0,) * len(BASE_UNITS)
    pairs = zip(a.exponents or nothing, b.exponents or nothing, strict=True)
    return UnitOfMeasure(
        name,
        exponents=tuple(x + sign * y for x, y in pairs),
        factor=a.factor * b.factor**sign,
    )


def _reduce(results: Recording, part: Reduction) -> float:
    """Return the number of a reduction, in the unit of the signal and s.

    One piece of the run is in memory at a time. Raises _NoValueError where the run gives it no value.
    """
    variables = {name: results.variable(name) for name in part.signals}
    first = _first_row(results, part)
    duration = results.span[1] - float(results.times(first, first + 1)[0])
    if part.reduce in _NEEDS_DURATION and duration == 0.0:
        raise _NoValueError("the run has no duration")
    other, threshold = _to_signal(part, variables)
    pieces = _pieces(results, part, first, other)
    if part.reduce in _AT_POINTS:
        return _AT_POINTS[part.reduce](x for _, x in pieces)
    if part.reduce == "settling":
        return _settling(pieces, threshold)
    held = part.reduce in (*_SHARES, *_TIMES) or all(v.held for v in variables.values())
    integrand = _integrand(part, variables[part.signal], threshold)
    integral = sum(_integral(time, integrand(x), held) for time, x in pieces)
    if part.reduce == "rms":
        return math.sqrt(integral / duration)
    return integral / duration if part.reduce in _NEEDS_DURATION else integral


def _first_row(results: Recording, part: Reduction) -> int:
    """Return the row at which the reduced part begins. Raises _NoValueError where the run ends before it."""
    if part.after is None:
        return 0
    rows = range(len(results))
    first = bisect.bisect_left(rows, part.after, key=lambda k: float(results.times(k, k + 1)[0]))
    if first == len(results):
        raise _NoValueError(f"the run ends before {part.after:g} s")
    return first


Piece = tuple[Array, Array]
"""Times [s] and values of a signal, shapes (n,); it begins with the last row of the piece before."""


def _pieces(results: Recording, part: Reduction, first: int, other: Affine) -> Iterator[Piece]:
    """Yield the pieces of the reduced signal. Raises _NoValueError for a value that is not finite."""
    for time, values in results.pieces(part.signals, first, overlap=1):
        x = values[:, 0]
        if part.minus is not None:
            x = x - (other.scale * values[:, 1] + other.offset)
        if not np.isfinite(x).all():
            raise _NoValueError(f"{part.signal} is not finite at {time[~np.isfinite(x)][0]:g} s")
        yield time, x


def _final(xs: Iterable[Array]) -> float:
    """Return the last value of all pieces, shapes (n,)."""
    last = math.nan
    for x in xs:
        last = float(x[-1])
    return last


def _range(xs: Iterable[Array]) -> float:
    """Return max - min over all pieces, shapes (n,)."""
    ends = [(float(np.min(x)), float(np.max(x))) for x in xs]
    return max(high for _, high in ends) - min(low for low, _ in ends)


_AT_POINTS: dict[str, Callable[[Iterable[Array]], float]] = {
    "final": _final,
    "max": lambda xs: max(float(np.max(x)) for x in xs),
    "min": lambda xs: min(float(np.min(x)) for x in xs),
    "range": _range,
    "changes": lambda xs: float(sum(np.count_nonzero(np.diff(x)) for x in xs)),
}


def _state(part: Reduction, variable: ResultVariable) -> float:
    if isinstance(part.value, str):
        return float(next(value for value, name in variable.items if name == part.value))
    return float(part.value or 0)


def _settling(pieces: Iterable[Piece], threshold: float) -> float:
    """Return the time [s] from leaving the threshold first to staying within it.

    Raises _NoValueError where the signal does not stay within it.
    """
    begin, end = math.nan, 0.0
    for time, x in pieces:
        at = np.flatnonzero(np.abs(x) > threshold)
        if len(at):
            begin = float(time[at[0]]) if math.isnan(begin) else begin
            end = float(time[at[-1] + 1]) if at[-1] + 1 < len(time) else math.inf
    if end == math.inf:  # no piece came after it
        raise _NoValueError("it is beyond the threshold at the end")
    return 0.0 if math.isnan(begin) else end - begin


def _integrand(part: Reduction, variable: ResultVariable, threshold: float) -> Callable[[Array], Array]:
    """Return the function of a signal's values, shape (n,) to (n,), that is integrated."""
    if part.reduce in ("share_above", "time_above"):
        return lambda x: (x > threshold).astype(np.float64)
    if part.reduce in ("share_equal", "time_equal"):
        state = _state(part, variable)
        return lambda x: (x == state).astype(np.float64)
    if part.reduce == "integral_above":
        return lambda x: np.maximum(x - threshold, 0.0)
    return np.square if part.reduce == "rms" else np.asarray


def _integral(time: Array, x: Array, held: bool) -> float:
    """Return the integral of x over time [s], both shape (n,): by steps if it is held, else trapezoids."""
    at = x[:-1] if held else 0.5 * (x[1:] + x[:-1])
    return float(np.sum(at * np.diff(time)))
