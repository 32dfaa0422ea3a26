"""Figures of an identification: Bode plot, prediction with its error, gain and pole over working points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..analysis.first_order import Estimate, FirstOrder, Fit, Prediction
from ..analysis.frequency_response import FrequencyResponse
from ..row_store import Array
from ..visible import flowing
from .canvas import canvas
from .style import COLORS, look
from .text import pretty

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BAND = "#E8E8E8"
_TRUSTED = 0.5  # coherence below which a point is drawn hollow


def bode(
    response: FrequencyResponse,
    fit: Fit,
    swept: tuple[float, float],
    gain_unit: str,
    title: str,
    published: tuple[float, float] | None = None,
) -> Figure:
    """Draw magnitude, phase and coherence over the swept frequencies [Hz], the band of the fit shaded.

    `published` is a gain and a pole [Hz] to be drawn beside the fitted model.
    """
    from matplotlib.ticker import LogFormatter

    data = response.within(swept)
    ratios = (1.3, 1.0, 0.7)
    with canvas(3, height=7.1 / 3, title=title, share_x=True, ratios=ratios) as (figure, grid):
        magnitude, phase, coherence = grid[:, 0]
        for axes in (magnitude, phase, coherence):
            axes.axvspan(*fit.band, color=_BAND, zorder=0.1, label="band of the fit")
        degrees = np.degrees(np.angle(np.sign(fit.gain.value) * data.response))
        trusted = data.coherence >= _TRUSTED
        for axes, values in ((magnitude, np.abs(data.response)), (phase, degrees)):
            _points(axes, data.frequency, values, trusted)
        _models(magnitude, phase, fit, swept, published)
        _points(coherence, data.frequency, data.coherence, trusted)
        magnitude.set_yscale("log")
        magnitude.set_ylabel(f"Magnitude\n[{pretty(gain_unit)}]")
        seen = np.abs(np.concatenate((data.response[trusted], fit.model.response(np.array(swept)))))
        magnitude.set_ylim(seen.min() / 1.5, seen.max() * 1.5)  # what is not trusted may be anywhere
        _plain_ticks(magnitude)
        phase.set_ylabel("Phase [deg]")
        known = np.concatenate((degrees[trusted], [-90.0, 0.0]))
        phase.set_ylim(known.min() - 10.0, known.max() + 10.0)
        coherence.set_ylabel("Coherence [1]")
        coherence.set_ylim(0.0, 1.05)
        coherence.set_xscale("log")
        coherence.xaxis.set_minor_formatter(LogFormatter())  # as by default, but without formulas
        coherence.set_xlim(*swept)
        coherence.set_xlabel("frequency [Hz]")
        coherence.xaxis.set_major_formatter("{x:g}")
        magnitude.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
        figure.align_ylabels()
        return figure


def _points(axes: Axes, x: Array, y: Array, trusted: NDArray[np.bool_]) -> None:
    """Draw points, all shapes (n,); those that are not trusted are hollow."""
    axes.plot(x[trusted], y[trusted], "o", ms=3.5, color=COLORS[0], label="measured")
    if not trusted.all():
        label = f"measured, coherence\nbelow {_TRUSTED:g}"
        axes.plot(x[~trusted], y[~trusted], "o", ms=3.5, mfc="none", color=COLORS[0], label=label)


def _models(
    magnitude: Axes, phase: Axes, fit: Fit, swept: tuple[float, float], published: tuple[float, float] | None
) -> None:
    f = np.geomspace(*swept, 300)
    models: list[tuple[str, FirstOrder, str, Any, float]] = [
        ("fitted model", fit.model, COLORS[1], "solid", 1.8)
    ]
    if published is not None:
        models.append(("published", FirstOrder(*published), COLORS[3], (0, (5, 2)), 1.2))
    for label, model, color, dashes, width in models:
        g = np.sign(model.gain) * model.response(f)
        look: dict[str, Any] = {"color": color, "linestyle": dashes, "linewidth": width, "label": label}
        magnitude.plot(f, np.abs(g), **look)
        phase.plot(f, np.degrees(np.angle(g)), **look)
    for axes, label in ((magnitude, f"pole, {fit.pole.value:.3g} Hz"), (phase, "")):
        axes.axvline(fit.pole.value, color="#505050", linestyle=":", linewidth=1.2, label=label)


def _plain_ticks(axes: Axes) -> None:
    """Write numbers as they are read aloud, and enough of them where a log axis has less than two decades."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())


def prediction(
    found: Prediction, unit: str, label: str, title: str, others: Mapping[str, Array] | None = None
) -> Figure:
    """Draw measured and predicted output over time [s], and ESR(t) [%] in the accelerations.

    `others` are outputs, shape (n,), of other models beside it, by the texts of their legend.
    """
    shown = np.isfinite(found.esr).any()
    rows, height = (2, 2.35) if shown else (1, 3.1)
    with canvas(rows, height=height, title=title, share_x=True) as (figure, grid):
        panels = list(grid[:, 0])
        top = panels[0]
        top.plot(found.time, found.measured, color=COLORS[0], linewidth=2.4, label="measured")
        others = others or {}
        of_fit = f"{'linear ' if others else ''}model,\nre-initialized in\ndecelerations"
        for i, (text, values) in enumerate([*others.items(), (of_fit, found.predicted)], 1):
            top.plot(found.time, values, **look(i) | {"linewidth": 1.4}, label=text)
        name = flowing(label)
        top.set_ylabel(f"{name}\n[{pretty(unit)}]" if unit else name)
        if shown:
            panels[1].plot(found.time, found.esr, color=COLORS[0], marker=".", ms=3, label="in accelerations")
            mean = f"mean, {found.mean_esr:.2f} %"
            panels[1].axhline(found.mean_esr, **look(1) | {"linewidth": 1.4}, label=mean)
            panels[1].set_ylabel("ESR [%]")
            panels[1].set_ylim(bottom=0.0)
        for axes in panels:
            axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
        panels[-1].set_xlabel("time [s]")
        panels[-1].set_xlim(found.time[0], found.time[-1])
        figure.align_ylabels()
        return figure


def over_working_points(
    points: Sequence[float],
    fits: Sequence[Fit],
    axis: str,
    gain_unit: str,
    title: str,
    published: tuple[float, float, float] | None = None,
) -> Figure:
    """Draw gain and pole [Hz] over the working points, with confidence intervals.

    `axis` names the quantity of the points and its unit. `published` is such a point, its gain and pole.
    """
    with canvas(2, height=2.35, title=title, share_x=True) as (figure, grid):
        gain, pole = grid[:, 0]
        _intervals(gain, points, [fit.gain for fit in fits])
        _intervals(pole, points, [fit.pole for fit in fits])
        if published is not None:
            for axes, value in ((gain, published[1]), (pole, published[2])):
                axes.plot(published[0], value, "D", ms=9, mfc="none", color=COLORS[1], label="published")
        gain.set_ylabel(f"Gain\n[{pretty(gain_unit)}]")
        pole.set_ylabel("Pole [Hz]")
        pole.set_ylim(bottom=0.0)
        center = float(np.mean([fit.gain.value for fit in fits]))
        low, high = gain.get_ylim()
        gain.set_ylim(min(low, 0.8 * center, 1.2 * center), max(high, 0.8 * center, 1.2 * center))
        pole.set_xlabel(flowing(axis))
        gain.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
        figure.align_ylabels()
        return figure


def _intervals(axes: Axes, points: Sequence[float], estimates: Sequence[Estimate]) -> None:
    values = np.array([e.value for e in estimates])
    arms = np.abs(np.array([[e.low for e in estimates], [e.high for e in estimates]]) - values)
    axes.errorbar(
        points, values, yerr=arms, fmt="o-", ms=5, capsize=4, color=COLORS[0], label="identified, 95 %"
    )
