"""The figure of the times on a bus: each message has its row in both panels."""

from __future__ import annotations

from pathlib import Path

from evcosim.cosim.analysis.bus_times import BusTimes, Carried
from evcosim.cosim.figures.bus_times import draw_bus_times
from evcosim.cosim.figures.saving import save
from evcosim.cosim.plan.bus_load import BusLoad, MessageLoad


def times() -> BusTimes:
    rows = tuple(MessageLoad(n, i, False, 8, 0.01, 0.02, 0.03, 3e-4, 1e-3) for i, n in enumerate("AB"))
    latency = {"min": 1e-4, "mean": 2e-4, "max": 3e-4}
    messages = {"A": {"carried": 1, "latency": latency}, "B": {"carried": 0, "latency": None}}
    period = (Carried("A", 1.0, 1.0, 1.0002), Carried("B", 1.0, 1.00021, 1.0005))
    return BusTimes(BusLoad("can0", 500_000, rows), {"load": 0.1, "messages": messages}, period)


def test_messages_stand_in_rows_the_first_to_win_on_top(tmp_path: Path) -> None:
    figure = draw_bus_times(times(), "s: can0")
    upper, lower = figure.axes
    for panel in (upper, lower):
        assert [tick.get_text() for tick in panel.get_yticklabels()] == ["A", "B"]
        assert panel.yaxis_inverted()
        assert "[ms]" in panel.get_xlabel()
    bars = sorted((p.get_y(), p.get_x(), p.get_width()) for p in lower.patches)
    assert [round(width, 9) for _, _, width in bars] == [0.2, 0.0, 0.29, 0.21]
    assert [path.name for path in save(figure, tmp_path, "can0")] == ["can0.png", "can0.svg"]


def test_the_legend_names_each_thing_once() -> None:
    figure = draw_bus_times(times(), "s: can0")
    names = [[text.get_text() for text in panel.get_legend().get_texts()] for panel in figure.axes]
    assert sorted(names[0]) == ["bound", "least to greatest", "mean"]
    assert sorted(names[1]) == ["takes the bus", "waits"]


def test_what_babbles_has_a_row_below_the_messages() -> None:
    known = times()
    babbling = BusTimes(known.load, known.counted, (*known.period, Carried("fault_1_0x0", 1.0, 1.0, 1.0002)))
    figure = draw_bus_times(babbling, "s: can0")
    for panel in figure.axes:
        assert [tick.get_text() for tick in panel.get_yticklabels()] == ["A", "B", "fault_1_0x0"]
    assert sorted({round(p.get_y() + p.get_height() / 2) for p in figure.axes[1].patches}) == [0, 1, 2]
