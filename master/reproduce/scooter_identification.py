"""The paper's identification of the scooter: its Figs. 2 to 4 with numbers, drawn and as data.

Dardanelli et al., "Speed and acceleration controllers for a light electric two-wheeled vehicle", IEEE CDC-ECC
2011, section III. Published: gain 0.46 and pole 0.03 Hz at a working point, fitted in 0.05-0.3 Hz; mean ESR
3.18 % over positive accelerations; the pole gets slower with speed at a gain that hardly changes. Chosen: the
working point, 30 km/h, and the unit of the gain, km/h per %; sweep, amplitude, duration, and the square wave.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...cosim.analysis.first_order import Prediction
from ...cosim.row_store import Array
from ...cosim.system.identification_spec import IdentificationSpec
from ...models.constants import KMH
from ...models.scooter import Scooter
from ..studies.identification import Identification, identify
from ..studies.identification_run import PhaseProgress
from . import printed
from .scooter_numbers import steady_throttle

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PUBLISHED_GAIN = printed.row("scooter", "gain").number  # km/h per %, a unit that is chosen
PUBLISHED_POLE = printed.row("scooter", "pole").number  # Hz
WORKING_POINT = 30.0  # km/h, chosen
SPEEDS = (25.0, 30.0, 35.0, 40.0, 45.0, 49.0)  # km/h

_SMALL = 1.0  # %; small enough for the speed limit at 49.5 km/h and the boost's below 24 km/h


@dataclasses.dataclass(frozen=True)
class ScooterIdentification:
    """The results behind Figs. 2 to 4: `measured` over the bus at 30 km/h, `over_speed` without it."""

    measured: Identification
    over_speed: tuple[Identification, ...]

    @property
    def numbers(self) -> dict[str, float]:
        """The obtained values of the published quantities, by name and unit."""
        fit = self.measured.fit
        return {
            "gain [km/h per %]": fit.gain.value,
            "pole [Hz]": fit.pole.value,
            "gain x pole over published": fit.product.value / (PUBLISHED_GAIN * PUBLISHED_POLE),
            "mean ESR [%]": self.measured.prediction.mean_esr,
        }

    @cached_property
    def nonlinear(self) -> Array:
        """The speed [km/h] of the non-linear model (3) in the test of Fig. 4, shape (n,)."""
        return nonlinear_speed(self.measured.prediction)

    @property
    def nonlinear_esr(self) -> float:
        """The mean ESR [%] of the non-linear model over the same accelerations as the linear one's."""
        test = self.measured.prediction
        rising = np.isfinite(test.esr)
        return float((100.0 * np.abs(test.measured - self.nonlinear) / test.measured)[rising].mean())

    def drawings(self) -> dict[str, Callable[[], Figure]]:
        """Return what draws Figs. 2, 3 and 4, as `fig2`, `fig3`, `fig4`."""
        from ...cosim.figures import identification as figures

        found = self.measured
        swept = (found.sweep.start, found.sweep.stop)
        published = (PUBLISHED_GAIN, PUBLISHED_POLE)
        return {
            "fig2": lambda: figures.bode(
                found.response,
                found.fit,
                swept,
                found.gain_unit,
                "From throttle to measured speed at 30 km/h",
                published,
            ),
            "fig3": lambda: figures.over_working_points(
                [each.working_point[1] for each in self.over_speed],
                [each.fit for each in self.over_speed],
                "speed [km/h]",
                found.gain_unit,
                "Gain and pole over speed",
                (WORKING_POINT, *published),
            ),
            "fig4": lambda: figures.prediction(
                found.prediction,
                found.output_unit,
                "Measured speed",
                "The identified and the non-linear model beside the scooter",
                {"non-linear model (3),\nre-initialized too": self.nonlinear},
            ),
        }

    def save(self, folder: Path) -> list[Path]:
        """Write the figures as fig2.png, fig2.svg and so on, and return their paths. Raises ConfigError."""
        from ...cosim.figures.draw import save

        return [path for stem, draw in self.drawings().items() for path in save(draw(), folder, stem)]


def scooter_identification(
    speeds: Sequence[float] = SPEEDS, progress: PhaseProgress | None = None
) -> ScooterIdentification:
    """Do the identifications of Figs. 2 to 4, in some seconds; `speeds` [km/h] are those of Fig. 3.

    Raises as `identify` does.
    """
    return ScooterIdentification(at_working_point(progress), tuple(at_speed(v, progress) for v in speeds))


def at_working_point(progress: PhaseProgress | None = None, **options: Any) -> Identification:
    """Identify as in Figs. 2 and 4: the rider's throttle to the measured speed, over the bus (whole km/h)."""
    return identify("scooter", progress=progress, **options)


def nonlinear_speed(test: Prediction) -> Array:
    """Return the speed [km/h] of `Scooter` under the throttle [%] of a test, shape (n,).

    It starts at the first measured speed, and is set to the measured one wherever the linear model is.
    """
    p, dt = Scooter.Parameters(), float(test.time[1] - test.time[0])
    speeds = np.empty_like(test.measured)
    x = Scooter.initial(p, Scooter.Inputs())
    for k, (throttle, measured) in enumerate(zip(test.u.tolist(), test.measured.tolist(), strict=True)):
        if k == 0 or test.predicted[k] == measured:
            x = dataclasses.replace(x, speed=measured / KMH)
        speeds[k] = KMH * x.speed
        x = Scooter.step(p, x, Scooter.Inputs(throttle), dt)
    return speeds


def at_speed(speed: float, progress: PhaseProgress | None = None) -> Identification:
    """Identify a point of Fig. 3: the vehicle alone, swept by 1 % of throttle around a `speed` [km/h]."""
    spec = IdentificationSpec(
        input="throttle",
        output="speed",
        unit="km/h",
        amplitude=_SMALL,
        at_input=[steady_throttle(speed)],
        sweep=(0.008, 0.6),
        duration=600.0,
    )
    return identify("Scooter", spec, parameters={"initial_speed": speed / KMH}, progress=progress)
