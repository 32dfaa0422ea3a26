"""Identification of G(s) = mu/(1 + s T) from a measured frequency response, and how well it predicts.

Fit. With f_p = 1/(2 pi T) the pole in Hz, over the points k in a band:

    G(f) = mu/(1 + j f/f_p)                                                                          (1)
    minimize  sum_k gamma_k^2 |1 - G(f_k)/H_k|^2   over ln|mu| and ln f_p                            (2)

the error of each point is relative, its weight is its coherence. Source: Dardanelli et al., "Speed and
acceleration controllers for a light electric two-wheeled vehicle", IEEE CDC-ECC 2011, section III (weighted
least squares in 0.05-0.3 Hz; it does not print the weights: coherence and relative error are chosen). The
search starts at the solution of the linear problem H_k = mu - T (j w_k H_k) (E. C. Levy, IRE Trans. Automatic
Control AC-4, 1959).

Confidence. With J the weighted residuals' Jacobian, N points, and r the residuals of the minimum:

    C = 8/3 |r|^2/(2 N - 2) (J' J)^-1        covariance of (ln|mu|, ln f_p)                          (3)

(G. A. F. Seber, C. J. Wild, Nonlinear Regression, Wiley 1989, section 2.1.2). 8/3 is the sum of the
correlations of a Hann spectrum's neighboring points (F. J. Harris, Proc. IEEE 66(1), 1978: 2/3 and 1/6 on
each side), which count as independent otherwise. Intervals are Student's, in logarithms. They cover scatter
(noise, quantization), not what is systematic: nonlinearity, or dynamics that (1) does not have.

Conditioning. Far above its pole, G is mu f_p/(j f) and any gain fits with its pole: only their product is
known. Far below, G is mu and says nothing of the pole. So gain and pole are separable when the pole lies
inside the band.

Prediction. ESR(t) = |v_m - v_id|/v_m 100 % over accelerations, v_m measured, v_id of the model          (4)
(the paper's index). The model is incremental, v = c + x with T x' = mu u - x, and re-initialized at v_m in
decelerations.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from ..errors import ConfigError
from ..row_store import Array
from ..shortage import require_scipy
from .frequency_response import FrequencyResponse

POOR_COHERENCE = 0.9
POOR_FIT = 0.1
USELESS_COHERENCE = 0.3
USELESS_INTERVAL = 10.0  # the upper end of an interval over the lower one
_NEIGHBORS = 8.0 / 3.0  # (3)
_FAR = 1e3  # how far outside the band a pole is looked for, as a factor


@dataclasses.dataclass(frozen=True)
class Estimate:
    """A value and the ends of its confidence interval, in one unit."""

    value: float
    low: float
    high: float

    @property
    def relative(self) -> float:
        """Half the width of the interval as a share of the value."""
        return 0.5 * (self.high - self.low) / abs(self.value) if self.value else math.inf

    @property
    def percentage(self) -> str:
        """`relative` in words, as +-2.6 %."""
        share = 100.0 * self.relative
        return f"+-{share:.1f} %" if share < 1000.0 else "by more than a factor of 10"

    @property
    def spread(self) -> float:
        """The end of the interval that is farther from 0 over the other one; inf if it holds 0 or is none."""
        near, far = sorted((abs(self.low), abs(self.high)))
        return far / near if near > 0.0 and self.low * self.high > 0.0 else math.inf


@dataclasses.dataclass(frozen=True)
class FirstOrder:
    """G(s) = gain/(1 + s/(2 pi pole)): `gain` in output per input unit, `pole` in Hz."""

    gain: float
    pole: float

    @property
    def time_constant(self) -> float:
        """T [s]."""
        return 1.0 / (2.0 * math.pi * self.pole)

    def response(self, frequency: Array) -> NDArray[np.complex128]:
        """Return G at frequencies [Hz], any shape. (1)"""
        return np.asarray(self.gain / (1.0 + 1j * frequency / self.pole), dtype=np.complex128)

    def simulated(self, u: Array, step: float, start: float = 0.0) -> Array:
        """Return x of T x' = gain u - x, x(0) = `start`, shape (n + 1,).

        The inputs `u`, shape (n,), are held over `step` [s] each.
        """
        from scipy import signal

        decay = math.exp(-step / self.time_constant)
        x, _ = signal.lfilter([(1.0 - decay) * self.gain], [1.0, -decay], u, zi=[decay * start])
        return np.concatenate(([start], x))


@dataclasses.dataclass(frozen=True)
class Fit:
    """A fitted model: `gain` in output per input unit, `pole` [Hz], `product` = gain times pole, each with a
    confidence interval; `band` [Hz] and `points` that it was fitted to; `residual`, the relative rms error of
    the response; `coherence`, the mean in the band; `correlation` of ln gain and ln pole.
    """

    gain: Estimate
    pole: Estimate
    product: Estimate
    band: tuple[float, float]
    points: int
    residual: float
    coherence: float
    correlation: float
    confidence: float

    @property
    def model(self) -> FirstOrder:
        """The model without its intervals."""
        return FirstOrder(self.gain.value, self.pole.value)

    @property
    def separable(self) -> bool:
        """True where the band separates gain and pole: the pole lies inside it."""
        return self.band[0] < self.pole.value < self.band[1]

    @property
    def refusal(self) -> str:
        """The reason why the numbers say nothing ("": they do)."""
        if not self.coherence >= USELESS_COHERENCE:
            return (
                f"coherence in the band is {self.coherence:.2f} on average, less than "
                f"{USELESS_COHERENCE:g}: what the output does is not from this input; a larger amplitude, "
                "more repeats or another band may help"
            )
        estimates = (("gain", self.gain), ("pole", self.pole), ("gain x pole", self.product))
        wide = [name for name, estimate in estimates if not estimate.spread <= USELESS_INTERVAL]
        if not wide:
            return ""
        return (
            f"the {100 * self.confidence:g} % interval of {' and '.join(wide)} spans more than a factor of "
            f"{USELESS_INTERVAL:g}; a band with the pole inside ({self.band[0]:g} to {self.band[1]:g} Hz was "
            "fitted), a larger amplitude or more repeats may help"
        )

    @property
    def warnings(self) -> list[str]:
        """A sentence for each reason not to trust the numbers."""
        said = [] if self.separable else [self._conditioning()]
        if self.coherence < POOR_COHERENCE:
            said.append(
                f"coherence in the band is {self.coherence:.2f} on average: the output does not follow the "
                "input alone and linearly; saturation, quantization, noise or too small an amplitude"
            )
        if self.residual > POOR_FIT:
            said.append(
                f"the model misses the response by {100 * self.residual:.0f} % (rms): it is not "
                "first-order in this band, or too noisy"
            )
        return said

    def _conditioning(self) -> str:
        pole, (low, high) = self.pole.value, self.band
        if pole <= low:
            return (
                f"the band ({low:g} to {high:g} Hz) lies above the pole ({pole:.3g} Hz), where the data "
                f"cannot separate gain from pole: only gain x pole is well conditioned "
                f"({self.product.percentage}; gain alone {self.gain.percentage}); "
                "a band that reaches below the pole gives both"
            )
        return (
            f"the band ({low:g} to {high:g} Hz) lies below the pole ({pole:.3g} Hz): the data give the gain, "
            "the pole is extrapolated"
        )


def fit_first_order(measured: FrequencyResponse, band: tuple[float, float], confidence: float = 0.95) -> Fit:
    """Return the first-order model that fits `measured` best in `band` [Hz]. (2), (3)

    Raises ConfigError when the band holds fewer than three points, or the response is zero or not finite.
    """
    require_scipy()
    from scipy import optimize

    data = measured.within(band)
    if not (np.isfinite(data.response).all() and np.abs(data.response).min() > 0.0):
        raise ConfigError(f"the response in the band {band[0]} to {band[1]} Hz is zero or not finite")
    weight = np.sqrt(data.coherence)
    sign, start = _levy(data, band)
    limits = (np.log(band[0] / _FAR), np.log(band[1] * _FAR))

    def residuals(q: Array) -> Array:
        """Return the weighted errors (2), shape (2 n,), for q = (ln|mu|, ln f_p), shape (2,)."""
        model = FirstOrder(sign * math.exp(q[0]), math.exp(q[1]))
        error = weight * (1.0 - model.response(data.frequency) / data.response)  # (2)
        return np.concatenate((error.real, error.imag))

    found = optimize.least_squares(
        residuals, start, bounds=([-np.inf, limits[0]], [np.inf, limits[1]]), xtol=1e-14, ftol=1e-14
    )
    points = len(data.frequency)
    covariance = _covariance(found.jac, 2.0 * found.cost / (2 * points - 2))
    spread = _student(confidence, 2 * points - 2)
    log_gain, log_pole = found.x
    product = covariance[0, 0] + covariance[1, 1] + 2.0 * covariance[0, 1]
    deviations = np.sqrt(np.maximum([covariance[0, 0], covariance[1, 1], product], 0.0))
    return Fit(
        gain=_estimate(log_gain, spread * deviations[0], sign),
        pole=_estimate(log_pole, spread * deviations[1], 1.0),
        product=_estimate(log_gain + log_pole, spread * deviations[2], sign),
        band=band,
        points=points,
        residual=math.sqrt(2.0 * found.cost / float(np.sum(weight**2))),
        coherence=float(data.coherence.mean()),
        correlation=_correlation(covariance),
        confidence=confidence,
    )


def _levy(data: FrequencyResponse, band: tuple[float, float]) -> tuple[float, list[float]]:
    """Return the gain's sign, and the (ln|gain|, ln pole) at which the search begins."""
    w = 2.0 * np.pi * data.frequency
    size = np.abs(data.response)
    columns = np.stack([np.ones_like(w, dtype=np.complex128), -1j * w * data.response]) / size
    target = data.response / size
    a = np.concatenate((columns.real, columns.imag), axis=1).T
    b = np.concatenate((target.real, target.imag))
    (gain, time_constant), *_ = np.linalg.lstsq(a, b, rcond=None)
    if gain == 0.0:
        gain = float(size[0])
    pole = 1.0 / (2.0 * math.pi * time_constant) if time_constant > 0.0 else math.sqrt(band[0] * band[1])
    return math.copysign(1.0, gain), [
        math.log(abs(gain)),
        math.log(min(max(pole, band[0] / _FAR * 1.01), band[1] * _FAR / 1.01)),
    ]


def _covariance(jacobian: Array, variance: float) -> Array:
    """Return C, shape (2, 2), of a Jacobian of shape (2 n, 2) and the variance of the residuals."""
    normal = jacobian.T @ jacobian
    return np.asarray(_NEIGHBORS * variance * np.linalg.pinv(normal), dtype=np.float64)  # (3)


def _correlation(covariance: Array) -> float:
    """Return the correlation of two estimates, from -1 to 1, by their covariance, shape (2, 2)."""
    scale = math.sqrt(covariance[0, 0] * covariance[1, 1])
    return float(covariance[0, 1] / scale) if scale > 0.0 else 0.0


def _student(confidence: float, freedom: int) -> float:
    """Return the half width of a confidence interval in standard deviations, by Student's distribution."""
    from scipy import special

    return float(special.stdtrit(freedom, 0.5 + 0.5 * confidence))


def _estimate(log_value: float, spread: float, sign: float) -> Estimate:
    """Return the estimate whose logarithm is `log_value` give or take `spread`."""
    spread = min(spread, 300.0)  # exp of more is no number; so wide an interval says nothing anyway
    ends = sorted(sign * math.exp(log_value + s) for s in (-spread, spread))
    return Estimate(sign * math.exp(log_value), ends[0], ends[1])


def curvature(x: Array, y: Array) -> float:
    """Return the bend of `y` over `x`, the output of the linear model, from a straight line; both shape (n,).

    It is the largest distance between the cubic and the line that fit best, as a share of the line's range: 0
    where the unit is linear, large where an input or an output is cut off.
    """
    scale = float(np.abs(x).max())
    cubic, line = np.polyfit(x / scale, y, 3), np.polyfit(x / scale, y, 1)
    at = np.linspace(float(x.min()), float(x.max()), 101) / scale
    reach = abs(float(line[0])) * float(np.ptp(at))
    bend = float(np.abs(np.polyval(cubic, at) - np.polyval(line, at)).max())
    return bend / reach if reach > 0.0 else math.inf


def flat_share(y: Array, sweep_frequency: Array, rate: float) -> float:
    """Return the longest time that `y` stays at one of its extremes, in periods of the sweep at that time.

    `y` and `sweep_frequency` [Hz] have shape (n,), sampled at `rate` [Hz]. At an extreme is within 1 % of the
    range: a sine is there for 0.06 periods at a time, one that is cut off for much longer.
    """
    low, high = float(y.min()), float(y.max())
    near = 0.01 * (high - low)
    return max(_longest(inside, sweep_frequency / rate) for inside in (y <= low + near, y >= high - near))


def _longest(inside: NDArray[np.bool_], amount: Array) -> float:
    """Return the largest sum of `amount` over a stretch of neighbors that are `inside`, both shape (n,)."""
    total = np.concatenate(([0.0], np.cumsum(amount)))
    edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(np.int8)))
    return max(
        (float(total[b] - total[a]) for a, b in zip(edges[::2], edges[1::2], strict=True)), default=0.0
    )


@dataclasses.dataclass(frozen=True)
class Prediction:
    """A measured output and the model's: `time` [s], `u`, `measured`, `predicted` and `esr` [%], shapes (n,).

    `esr` (4) is NaN outside accelerations; `mean_esr` [%] is its mean over them, NaN where there is none or
    the output is not above zero in one: a share of it says nothing then.
    """

    time: Array
    u: Array
    measured: Array
    predicted: Array
    esr: Array
    mean_esr: float


def predict(
    model: FirstOrder, time: Array, u: Array, y: Array, working_point: tuple[float, float]
) -> Prediction:
    """Return the model beside the measurement, re-initialized in decelerations. (4)

    `time` [s], input `u` and output `y` have shape (n,). `u` is held from each time on; the steps are equal.
    `working_point` is an input and its steady output. Accelerating is a mean slope over T/5 of more than 1 %
    of the range of `y` in T.
    """
    step = float(time[1] - time[0])
    slope = _slope(y, step, 0.1 * model.time_constant)
    steep = 0.01 * np.ptp(y) / model.time_constant
    u_0, y_0 = working_point
    decay = math.exp(-step / model.time_constant)
    target = y_0 + model.gain * (u - u_0)
    predicted = np.empty_like(y)
    v = float(y[0])
    for k in range(len(y)):
        if slope[k] < -steep:
            v = float(y[k])
        predicted[k] = v
        v = float(target[k]) + (v - float(target[k])) * decay
    rising = slope > steep
    esr = np.full(len(y), np.nan)
    if rising.any() and y[rising].min() > 0.0:
        esr[rising] = 100.0 * np.abs(y - predicted)[rising] / y[rising]  # (4)
    mean = float(esr[rising].mean()) if rising.any() else math.nan
    return Prediction(time, u, y, predicted, esr, mean)


def _slope(y: Array, step: float, half: float) -> Array:
    """Return the mean slope of `y` per s, over `half` [s] on each side of a point; both shape (n,)."""
    reach = max(1, round(half / step))
    at = np.arange(len(y))
    after, before = np.minimum(at + reach, len(y) - 1), np.maximum(at - reach, 0)
    return np.asarray((y[after] - y[before]) / (step * np.maximum(after - before, 1)), dtype=np.float64)
