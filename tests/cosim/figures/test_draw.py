"""A figure of results as a whole: its panels, titles, legends, and what a long run makes of it."""

from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.text import Text

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures import thinning
from evcosim.cosim.figures.comparison import draw_comparison
from evcosim.cosim.figures.draw import draw, save
from evcosim.cosim.figures.saving import write
from evcosim.cosim.figures.system_diagram import draw_diagram
from evcosim.cosim.results import results as results_module
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import FigureSpec
from evcosim.cosim.system.system import SystemFile
from evcosim.cosim.visible import visible
from support.outlined_scooter import SPEC, STATES, scooter


def test_the_panels_show_the_signals_in_the_panel_s_unit() -> None:
    results = scooter()
    throttle, speed = draw(results, SPEC).axes
    true = speed.get_lines()[0]
    assert np.array_equal(true.get_ydata(), 3.6 * results["vehicle.speed"])
    assert np.array_equal(true.get_xdata(), results.time)
    assert [text.get_text() for text in speed.get_legend().get_texts()] == [
        "true",
        "measured",
        "ecu.speed_bound",
    ]
    assert (throttle.get_ylabel(), speed.get_ylabel()) == ("throttle [%]", "speed [km/h]")
    assert speed.get_xlabel() == "time [s]"
    assert speed.get_ylim() == (0.0, 40.0)
    assert true.get_linewidth() == 3.0


def _legends(axes):
    return [child for child in axes.get_children() if isinstance(child, matplotlib.legend.Legend)]


def test_legends_and_titles_overlap_nothing() -> None:
    figure = draw(scooter(), SPEC)
    figure.draw_without_rendering()
    boxes = [figure._suptitle.get_window_extent()]
    boxes += [legend.get_window_extent() for axes in figure.axes for legend in _legends(axes)]
    boxes += [axes.get_window_extent() for axes in figure.axes]
    for i, box in enumerate(boxes):
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1
        assert not any(_overlap(box, other) for other in boxes[:i])


def _overlap(a, b) -> bool:
    wide, tall = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
    return wide > 1.0 and tall > 1.0  # touching by a pixel is no overlap


def test_results_plot_themselves(tmp_path: Path) -> None:
    figure = scooter().plot(tmp_path / "x.svg", title="A title")
    assert figure._suptitle.get_text() == "A title"
    assert (tmp_path / "x.svg").read_bytes().startswith(b"<?xml")
    assert scooter().plot()._suptitle.get_text() == "scooter · fig8"


def test_results_without_points_or_with_gaps_are_drawn() -> None:
    variables = [ResultVariable("a.x", "V"), ResultVariable("a.state", type="Enumeration", items=STATES)]
    assert len(draw(Results([], np.empty((0, 2)), variables)).axes) == 2
    gap = draw(Results([0, 1, 2], [[1.0, 0], [np.nan, 1], [2.0, 2]], variables)).axes[0]
    assert gap.get_ylim() == pytest.approx((0.93, 2.07))
    with pytest.raises(ConfigError, match="no variable to draw"):
        draw(Results([0.0], np.empty((1, 0)), []))


def test_a_long_run_is_a_small_file_in_minutes_with_its_spike(tmp_path: Path) -> None:
    n = 137_000
    t = np.arange(n) * 0.01
    noise = np.random.default_rng(5).normal(size=(n, 24))
    noise[70_000, 0] = 99.0
    state = (np.arange(n) % 7 // 3).astype(float)  # chattering: a state every 30 ms
    variables = [ResultVariable(f"a.x{j}", ("V", "A", "W", "N")[j % 4]) for j in range(24)]
    shading = ResultVariable("ecu.state", type="Enumeration", items=STATES)
    figure = draw(Results(t, np.column_stack([noise, state]), [*variables, shading]))
    png, svg = save(figure, tmp_path)
    assert svg.stat().st_size < 2e6 and png.stat().st_size < 4e6
    assert max(line.get_ydata().max() for line in figure.axes[0].get_lines()) == 99.0
    assert figure.axes[-1].get_xlabel() == "time [min]"
    assert figure.axes[-1].get_xlim()[1] == pytest.approx(t[-1] / 60.0)


@pytest.mark.parametrize("rows", [3, 100, 4000])
def test_a_figure_does_not_depend_on_the_pieces_that_a_run_is_read_in(
    rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same panels, states and lines; where lines are thinned, with the same ends and extremes."""
    results = scooter(20_001, 0.002)
    results.data[12_345, results.names.index("vehicle.speed")] = 99.0
    whole = draw(results)
    monkeypatch.setattr(results_module, "PIECE", rows)
    monkeypatch.setattr(thinning, "PIECE", rows)
    pieces = draw(results)
    assert len(pieces.axes) == len(whole.axes) == 2
    for a, b in zip(whole.axes, pieces.axes, strict=True):
        assert (a.get_ylabel(), a.get_ylim()) == (b.get_ylabel(), b.get_ylim())
        shades = [[bars.get_paths() for bars in axes.collections] for axes in (a, b)]
        assert [[p.vertices.tolist() for p in paths] for paths in shades[0]] == [
            [p.vertices.tolist() for p in paths] for paths in shades[1]
        ]
        for one, other in zip(a.get_lines(), b.get_lines(), strict=True):
            assert {tuple(xy) for xy in one.get_xydata()} <= {tuple(xy) for xy in other.get_xydata()}


FORMULAS = ["$\\frac{", "a$b$c", "$$", "$x^2$", "\\$a$", "50 % of $ and _{", "a\x1b[2Jb\u202e$", "速度"]


@pytest.mark.parametrize("text", FORMULAS)
def test_signs_of_formulas_and_what_steers_are_drawn_as_they_are(tmp_path: Path, text: str) -> None:
    time = np.arange(5.0)
    variables = [
        ResultVariable(f"u.{text}", unit=text, description=text),
        ResultVariable("u.state", type="Enumeration", causality="output", items=((0, text), (1, f"{text}2"))),
        ResultVariable("u.other", type="Enumeration", causality="output", items=((0, text), (1, f"{text}2"))),
    ]
    data = np.column_stack([time, time % 2, time % 2])
    results = Results(time, data, variables, {"system": text, "scenario": text})
    spec = FigureSpec.model_validate(
        {
            "title": text,
            "note": text,
            "shade": "u.state",
            "panels": [
                {"label": text, "unit": text, "signals": [{"name": f"u.{text}", "label": text}]},
                {"label": text, "signals": ["u.other"]},
            ],
        }
    )
    system = SystemFile.model_validate({"name": "s", "units": {"u": {"fmu": f"{text}.fmu"}}})
    figures = [draw(results, spec), draw(results), draw_comparison(results, results), draw_diagram(system)]
    shown = visible(text)
    for figure in figures:
        texts = [each.get_text() for each in figure.findobj(Text)]
        assert any(shown in each.replace("\n", " ") for each in texts)
        assert all(visible(each) == each for each in texts)
        assert not any(each.get_parse_math() for each in figure.findobj(Text) if "$" in each.get_text())
        write(figure, tmp_path / "figure.svg")
        picture = (tmp_path / "figure.svg").read_text(encoding="utf-8")
        assert visible(picture) == picture
    write(figures[0], tmp_path / "figure.png")  # the texts of all four are drawn by the same code
