"""The axes of panels over time: seconds or minutes below, a quantity with its unit of measure at the left."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..results.results import Results
from .text import broken, pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MINUTES = 600.0  # s; a longer run has its time axis in minutes


@dataclasses.dataclass(frozen=True)
class TimeAxis:
    """The time axis of a figure: `scale` from seconds to its `unit`, and its ends in that unit."""

    scale: float
    unit: str
    begin: float
    end: float

    @classmethod
    def of(cls, *runs: Results) -> TimeAxis:
        """Return the axis on which all runs have room."""
        times = [t for run in runs if len(run) for t in run.span] or [0.0]
        begin, end = min(times), max(times)
        scale, unit = (1.0 / 60.0, "min") if end - begin > _MINUTES else (1.0, "s")
        return cls(scale, unit, scale * begin, scale * end)

    def finish(self, panels: Sequence[Axes]) -> None:
        """Label the time below the last of the panels that stand over each other, and set its ends."""
        panels[-1].set_xlabel(f"time [{self.unit}]")
        if self.end > self.begin:
            panels[-1].set_xlim(self.begin, self.end)


def label_value_axis(axes: Axes, label: str, unit: str) -> None:
    """Write what a panel shows at its left, with the unit of measure ("" for none)."""
    shown = f"[{pretty(unit)}]" if unit else ""
    wrapped = broken(label, 24)
    axes.set_ylabel(f"{wrapped}\n{shown}" if len(label) > 14 and shown else f"{wrapped} {shown}".strip())


def fit_value_axis(axes: Axes) -> None:
    """Set limits with room around all lines; a constant in the middle, its rounding errors not blown up."""
    drawn = [np.asarray(line.get_ydata(), dtype=np.float64) for line in axes.get_lines()]
    values = np.concatenate([y[np.isfinite(y)] for y in drawn])
    if not len(values):
        return
    low, high = float(values.min()), float(values.max())
    size = max(abs(low), abs(high))
    room = 0.07 * (high - low) if high - low > 1e-6 * size else 0.1 * size or 1.0
    axes.set_ylim(low - room, high + room)
