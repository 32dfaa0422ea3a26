"""The figure of the times on a bus: latencies of its messages beside their bounds, and a busy period."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..analysis.bus_times import BusTimes
from ..visible import visible
from .canvas import canvas
from .style import COLORS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WAITING, _SENT, _BOUND = COLORS[6], COLORS[0], COLORS[3]
_ROW = 0.26  # inches of a message
_MS = 1e3
_ABOVE: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}


def draw_bus_times(times: BusTimes, title: str) -> Figure:
    """Draw of each message the latencies that a run has seen with their bound, and who waited for whom.

    The upper panel has from the least to the greatest time from sampling to the end of the frame as a bar,
    the mean as a disk, the bound of the response-time analysis as a line. The lower one is a busy period:
    each frame waits from its sampling on, then takes the bus. What babbles has a row below the messages.
    """
    own = [message.name for message in times.load.messages]
    own += sorted({frame.name for frame in times.period} - set(own))
    count = len(own)
    height = max(2.2, 1.1 + _ROW * count)
    with canvas(rows=2, height=height, title=title, ratios=(1.0, 1.0)) as (figure, axes):
        names = [visible(name) for name in own]
        for panel in axes[:, 0]:
            panel.set_yticks(range(count), names, fontsize=8.5)
            panel.set_ylim(count - 0.4, -0.6)  # the first to win on top
            panel.grid(axis="y", visible=False)
        _draw_latencies(axes[0, 0], times)
        _draw_period(axes[1, 0], times, own)
        for panel in axes[:, 0]:
            handles, labels = panel.get_legend_handles_labels()
            unique = dict(zip(labels, handles, strict=True))
            panel.legend(unique.values(), unique.keys(), ncols=len(unique), **_ABOVE)
        return figure


def _draw_latencies(panel: Axes, times: BusTimes) -> None:
    for row, message in enumerate(times.load.messages):
        latency = times.latency(message.name)
        if latency is not None:
            low, mean, high = (_MS * latency[key] for key in ("min", "mean", "max"))
            panel.barh(
                row, high - low, left=low, height=0.5, color=_SENT, alpha=0.45, label="least to greatest"
            )
            panel.plot([mean], [row], "o", color=_SENT, markersize=5.0, label="mean")
        if message.response is not None:
            bound = _MS * message.response
            panel.plot([bound, bound], [row - 0.4, row + 0.4], color=_BOUND, linewidth=1.6, label="bound")
    panel.set_xlim(left=0.0)
    panel.set_xlabel("From sampling to the end of the frame [ms]")


def _draw_period(panel: Axes, times: BusTimes, names: Sequence[str]) -> None:
    rows = {name: row for row, name in enumerate(names)}
    begin = min((frame.sampled for frame in times.period), default=0.0)
    for frame in times.period:
        row = rows[frame.name]
        since, start, end = (_MS * (t - begin) for t in (frame.sampled, frame.start, frame.end))
        panel.barh(row, start - since, left=since, height=0.36, color=_WAITING, label="waits")
        panel.barh(row, end - start, left=start, height=0.66, color=_SENT, label="takes the bus")
    panel.set_xlim(left=0.0)
    panel.set_xlabel(f"The busy period of the longest wait, from t = {begin:.6g} s on [ms]")
