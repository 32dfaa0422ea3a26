"""The frequency response between two sampled signals, estimated from their spectra, with coherence.

    H(f)       = S_uy(f)/S_uu(f)                                                                     (1)
    gamma^2(f) = |S_uy(f)|^2/(S_uu(f) S_yy(f))                                                       (2)

Source: J. S. Bendat, A. G. Piersol, Random Data, 4th ed., Wiley 2010, equations (6.37) (H, least squares for
noise at the output) and (6.39) (coherence: the share of the output's power that is linear in the input).
Spectra by Welch's method (IEEE Trans. Audio Electroacoust. 15(2), 1967): Hann windows, overlapping by half.

Before, both signals are averaged over blocks, which removes quantization steps and the images of the held
input. Both see the same average, so H is that of the unit itself.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from ..errors import ConfigError
from ..row_store import Array
from ..shortage import require_scipy

LARGEST = 1e150
"""The magnitude of a signal at most: spectra are squares, which doubles hold to 1e308."""

RATE = 8.0
"""Blocks in a period of the sweep's highest frequency."""


@dataclasses.dataclass(frozen=True)
class FrequencyResponse:
    """`response` at `frequency` [Hz] with its `coherence` (0 to 1), shapes (n,).

    `resolution` [Hz] is the distance of the points.
    """

    frequency: Array
    response: NDArray[np.complex128]
    coherence: Array

    @property
    def resolution(self) -> float:
        """The distance of the points [Hz]."""
        return float(self.frequency[1] - self.frequency[0]) if len(self.frequency) > 1 else 0.0

    def within(self, band: tuple[float, float]) -> FrequencyResponse:
        """Return the points in `band` [Hz]. Raises ConfigError when there are fewer than three."""
        keep = (self.frequency >= band[0]) & (self.frequency <= band[1])
        if np.count_nonzero(keep) < 3:
            raise ConfigError(
                f"band {band[0]} to {band[1]} Hz holds {np.count_nonzero(keep)} points {self.resolution:.3g} "
                "Hz apart; three are needed: widen it, or sweep for longer"
            )
        return FrequencyResponse(self.frequency[keep], self.response[keep], self.coherence[keep])


def block_length(highest: float, step_size: float) -> int:
    """Return how many steps of `step_size` [s] a block takes, for a sweep up to `highest` [Hz]."""
    return max(1, int(1.0 / (RATE * highest * step_size) + 1e-9))


def averaged(values: Array, block: int) -> Array:
    """Return the means over blocks of `block` of the n values, shape (n // block,)."""
    whole = len(values) // block * block
    return np.asarray(values[:whole].reshape(-1, block).mean(axis=1), dtype=np.float64)


def midpoints(values: Array) -> Array:
    """Return the means of neighbors of n values, shape (n - 1,).

    They put what is valid at t_k where the input held from t_k on has its center of mass; without it the
    output would seem half a step early.
    """
    return np.asarray(0.5 * (values[1:] + values[:-1]), dtype=np.float64)


def frequency_response(u: Array, y: Array, rate: float, length: int | None = None) -> FrequencyResponse:
    """Return (1), (2) between the input `u` and the output `y`, both shape (n,), sampled at `rate` [Hz].

    `length` samples make a segment (default: a power of two, at most a quarter of the signal). The
    frequency 0 is left out. Raises ConfigError for signals that do not vary, are not finite, or too short.
    """
    require_scipy()
    from scipy import signal

    _check_signals(u, y)
    if length is None:
        length = 1 << int(np.log2(max(len(u) // 4, 1)))
    if not 8 <= length <= len(u):
        raise ConfigError(
            f"segments of {length} samples: a spectrum takes 8 or more, and {len(u)} are given; "
            "sweep for longer"
        )
    options = {"fs": rate, "nperseg": length, "window": "hann", "detrend": "constant"}
    frequency, s_uu = signal.welch(u, **options)
    _, s_yy = signal.welch(y, **options)
    _, s_uy = signal.csd(u, y, **options)
    keep = (s_uu > 1e-12 * s_uu.max()) & (s_yy > 0.0)
    keep[:2] = False  # 0 Hz and its neighbor: what removing the mean has left
    response = s_uy[keep] / s_uu[keep]  # (1)
    coherence = np.minimum(np.abs(s_uy[keep]) ** 2 / (s_uu[keep] * s_yy[keep]), 1.0)  # (2)
    return FrequencyResponse(frequency[keep], response, coherence)


def _check_signals(u: Array, y: Array) -> None:
    """Raise ConfigError unless both have the same shape (n,), are finite, and vary."""
    if u.shape != y.shape or u.ndim != 1:
        raise ConfigError(f"input {u.shape} and output {y.shape}: two signals of the same length are needed")
    for name, values in (("input", u), ("output", y)):
        if not np.isfinite(values).all():
            first = int(np.argmin(np.isfinite(values)))
            raise ConfigError(f"the {name} is {values[first]} at sample {first}: it must be finite")
        if (largest := np.abs(values).max(initial=0.0)) > LARGEST:
            raise ConfigError(f"the {name} is up to {largest:.6g}: {LARGEST:g} at most, to be squared")
        if not np.ptp(values) > 1e-12 * np.abs(values).max(initial=0.0):
            raise ConfigError(f"the {name} is constant ({values[0]:.6g}): there is nothing to identify")
