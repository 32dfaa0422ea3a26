"""The states of an enumeration as a background of all panels, with their names above the first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..results.results import Results
from ..row_store import Array
from ..visible import on_one_line
from .axes import TimeAxis
from .style import SHADES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SPANS = 1000  # shaded stretches at most: one pixel each


def draw_states(panels: list[Axes], results: Results, name: str, time_axis: TimeAxis) -> None:
    """Shade each panel for as long as a state of the enumeration `name` lasts."""
    from matplotlib.patches import Patch

    time, values = course(results, name, _SPANS)
    handles = [Patch(visible=False, label=f"{on_one_line(name)}:")]
    for place, (value, text) in enumerate(results.variable(name).items):
        face = SHADES[place % len(SHADES)]
        hatch = "///" if place >= len(SHADES) else None
        spans = [(time_axis.scale * a, time_axis.scale * (b - a)) for a, b in spans_of(time, values, value)]
        for axes in panels if spans else []:
            bars = axes.broken_barh(spans, (0.0, 1.0), transform=axes.get_xaxis_transform())
            bars.set(facecolor=face, hatch=hatch, edgecolor="#C0C0C0", linewidth=0.0, zorder=0.1)
        handles.append(
            Patch(facecolor=face, hatch=hatch, edgecolor="#808080", linewidth=0.6, label=on_one_line(text))
        )
    legend = panels[0].legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=min(7, len(handles)),
        handlelength=1.8,
        columnspacing=1.6,
    )
    panels[0].add_artist(legend)  # beside the legend of the lines, which would replace it
    legend.set_clip_on(False)  # the layout makes room for what is not clipped


def course(results: Results, name: str, most: int) -> tuple[Array, Array]:
    """Return times [s] and values of a held variable, shapes (n,): at the start, at each change, at the end.

    More than `most` changes would not be seen: then the state at each of as many equal distances counts.
    """
    times, kept, count = [np.empty(0)], [np.empty(0)], 0
    for time, values in results.pieces([name], overlap=1):
        x = values[:, 0]
        at = np.flatnonzero(x[1:] != x[:-1]) + 1
        count += len(at)
        if count > most:
            rows = np.linspace(0, len(results) - 1, most).astype(np.intp).tolist()
            few = [next(results.pieces([name], first=k, rows=1)) for k in rows]
            return np.concatenate([t for t, _ in few]), np.concatenate([v[:, 0] for _, v in few])
        at = at if len(times) > 1 else np.insert(at, 0, 0)
        times.append(time[at])
        kept.append(x[at])
    if len(results) > 1:
        times.append(time[-1:])
        kept.append(x[-1:])
    return np.concatenate(times), np.concatenate(kept)


def spans_of(time: Array, values: Array, value: float) -> list[tuple[float, float]]:
    """Return the stretches [t_k, t_j) [s] of a course, shapes (n,), in which it has this value."""
    inside = np.concatenate(([False], values[:-1] == value, [False]))  # the last value lasts no time
    edges = np.flatnonzero(inside[1:] != inside[:-1])
    spans = [(float(time[a]), float(time[b])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    return [(a, b) for a, b in spans if a < b]  # a change at the end stands there twice
