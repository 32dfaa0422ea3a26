"""Frequency sweeps: the logarithmic chirp that excites a unit around a working point, and its limits.

    u(t)   = u_0 + A sin(phi(t))                                                                     (1)
    phi(t) = 2 pi f_0 D / ln(f_1/f_0) ((f_1/f_0)^(t/D) - 1)                                          (2)
    f(t)   = phi'(t)/(2 pi) = f_0 (f_1/f_0)^(t/D)                                                    (3)

Source: A. Farina, "Simultaneous measurement of impulse response and distortion with a swept-sine
technique", 108th AES Convention, 2000, equation (4). It stays as long in each octave, so that a pole is seen
as well at low frequencies as at high ones. It begins at u_0 with a rising flank, and is repeated from there.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ..errors import ConfigError
from ..row_store import Array
from ..system.identification_spec import IdentificationSpec
from .frequency_response import LARGEST

STEPS_PER_PERIOD = 8
"""Communication steps that a period of the highest frequency needs: fewer, and the held input is no sine."""

PERIODS = 2.0
"""Periods of the lowest frequency that a sweep must last for it to be seen."""

FINEST = 1e-9
"""The least amplitude as a share of the working point, of which rounding leaves seven digits."""


@dataclasses.dataclass(frozen=True)
class Sweep:
    """A logarithmic chirp from `start` to `stop` [Hz] in `duration` [s], `repeats` times.

    `amplitude` is in the unit of the input. Raises ConfigError for numbers that make no sweep.
    """

    start: float
    stop: float
    duration: float
    amplitude: float
    repeats: int = 1

    def __post_init__(self) -> None:
        numbers = (self.start, self.stop, self.duration, self.amplitude)
        if not all(math.isfinite(x) and x > 0.0 for x in numbers):
            raise ConfigError(
                f"sweep from {self.start} to {self.stop} Hz in {self.duration} s with amplitude "
                f"{self.amplitude}: all four are finite and above 0"
            )
        if self.repeats < 1:
            raise ConfigError(f"sweep: repeats = {self.repeats}: it is done at least once")
        if not self.start < self.stop:
            raise ConfigError(
                f"sweep from {self.start} to {self.stop} Hz: the first frequency is the lower one"
            )
        if self.duration * self.start < PERIODS:
            raise ConfigError(
                f"sweep of {self.duration} s: {self.start} Hz needs {PERIODS / self.start:.6g} s or more "
                f"({PERIODS:g} periods)"
            )

    @property
    def length(self) -> float:
        """Duration of all repeats [s]."""
        return self.repeats * self.duration

    def __call__(self, time: Array) -> Array:
        """Return the deviation from the working point at times [s] since the start, any shape. (1), (2)"""
        ratio = self.stop / self.start
        along = np.mod(time, self.duration) / self.duration
        phase = 2.0 * np.pi * self.start * self.duration / np.log(ratio) * (ratio**along - 1.0)
        return np.asarray(self.amplitude * np.sin(phase), dtype=np.float64)

    def frequency(self, time: Array) -> Array:
        """Return the frequency [Hz] at times [s] since the start, any shape. (3)"""
        along = np.mod(time, self.duration) / self.duration
        return np.asarray(self.start * (self.stop / self.start) ** along, dtype=np.float64)

    def check_step(self, step_size: float) -> None:
        """Raise ConfigError unless steps of `step_size` [s] can follow the highest frequency."""
        highest = 1.0 / (STEPS_PER_PERIOD * step_size)
        if self.stop > highest * (1.0 + 1e-9):
            raise ConfigError(
                f"sweep up to {self.stop} Hz: with steps of {step_size} s it goes up to {highest:.6g} Hz "
                f"({STEPS_PER_PERIOD} steps to a period; the Nyquist frequency is {0.5 / step_size:.6g} Hz)"
            )

    def check_band(self, band: tuple[float, float]) -> None:
        """Raise ConfigError unless `band` [Hz] lies in the sweep."""
        low, high = band
        if not (math.isfinite(low) and math.isfinite(high) and self.start <= low < high <= self.stop):
            raise ConfigError(
                f"band {low} to {high} Hz: it must rise, and lie in the sweep from {self.start} to "
                f"{self.stop} Hz"
            )

    def check_range(self, center: float, low: float | None, high: float | None, name: str, unit: str) -> None:
        """Raise ConfigError when the sweep round `center` leaves what the input `name` declares.

        Also where it would be lost in the rounding of `center`, or its square overflow.
        """
        bottom, top = center - self.amplitude, center + self.amplitude
        if self.amplitude < FINEST * abs(center) or max(abs(bottom), abs(top)) > LARGEST:
            raise ConfigError(
                f"the sweep of {name} has an amplitude of {self.amplitude:g} around {center:.6g} {unit}: "
                f"it is {FINEST:g} or more of that value, and both are {LARGEST:g} at most"
            )
        if (low is not None and bottom < low) or (high is not None and top > high):
            limits = f"{'' if low is None else f'{low:g}'}..{'' if high is None else f'{high:g}'}"
            raise ConfigError(
                f"the sweep saturates {name}: {center:.6g} {unit} with amplitude {self.amplitude:g} is "
                f"{bottom:.6g} to {top:.6g}, the input is declared for {limits} {unit}".rstrip()
            )


def sweep_of(spec: IdentificationSpec) -> Sweep:
    """Return the sweep of a specification.

    Raises ConfigError for numbers that make none, or a band outside it.
    """
    sweep = Sweep(*spec.sweep, spec.duration, spec.amplitude, spec.repeats)
    sweep.check_band(spec.fit_band)
    return sweep
