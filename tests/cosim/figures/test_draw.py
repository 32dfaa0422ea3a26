from pathlib import Path

import matplotlib
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures import draw as figures
from evcosim.cosim.figures.default_figure import default_spec
from evcosim.cosim.figures.draw import broken, draw, draw_comparison, pretty, save, thinned
from evcosim.cosim.results import results as results_module
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import FigureSpec
from evcosim.cosim.system.toml import validate

STATES = ((0, "driver"), (1, "acceleration"), (2, "velocity"))
PNG_WIDTH = 1440


def scooter(n: int = 401, step: float = 0.1) -> Results:
    """The signals of a scooter under a speed bound, in outline."""
    t = np.arange(n) * step
    rider = np.where(t < 30.0, np.clip(200.0 * (t - 1.0), 0.0, 100.0), 0.0)
    state = np.select([t < 1.5, t < 10.0, t < 30.0], [0, 1, 2], 0)
    speed = np.where(t < 30.0, np.clip(t - 1.5, 0.0, 30.0 / 3.6), 30.0 / 3.6 * np.exp(-(t - 30.0) / 5.0))
    throttle = np.where(state == 0, rider, 40.0 + np.sin(t))
    columns = {
        ResultVariable("rider.throttle", "%"): rider,
        ResultVariable("ecu.time", "s", causality="input"): t,
        ResultVariable("ecu.throttle_request", "%", causality="input"): np.round(rider / 0.4) * 0.4,
        ResultVariable("ecu.speed_measured", "km/h", causality="input"): np.round(3.6 * speed),
        ResultVariable("ecu.speed_bound", "km/h", causality="input"): np.full(n, 30.0),
        ResultVariable("ecu.throttle", "%", variability="discrete"): throttle,
        ResultVariable("ecu.state", type="Enumeration", variability="discrete", items=STATES): state,
        ResultVariable("ecu.speed_estimate", "km/h", variability="discrete"): 3.6 * speed + 0.2 * np.sin(t),
        ResultVariable("vehicle.road_grade", "rad", causality="input"): np.zeros(n),
        ResultVariable("vehicle.speed", "m/s"): speed,
        ResultVariable("vehicle.mass", "kg", causality="parameter"): np.full(n, 200.0),
    }
    manifest = {"system": "scooter", "scenario": "fig8"}
    return Results(t, np.column_stack(list(columns.values())), list(columns), manifest)


SPEC = FigureSpec.model_validate(
    {
        "title": "The bounds",
        "shade": "ecu.state",
        "panels": [
            {"label": "throttle", "unit": "%", "signals": ["rider.throttle", "ecu.throttle"]},
            {
                "label": "speed",
                "unit": "km/h",
                "limits": [0.0, 40.0],
                "signals": [
                    {"name": "vehicle.speed", "label": "true", "style": "dashed", "weight": 3.0},
                    {"name": "ecu.speed_measured", "label": "measured", "step": False},
                    "ecu.speed_bound",
                ],
            },
        ],
    }
)


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


def test_what_is_held_is_drawn_as_steps_unless_told_otherwise() -> None:
    lines = [line for axes in draw(scooter(), SPEC).axes for line in axes.get_lines()]
    styles = {line.get_label(): line.get_drawstyle() for line in lines}
    assert styles == {
        "rider.throttle": "default",
        "ecu.throttle": "steps-post",
        "true": "default",
        "measured": "default",
        "ecu.speed_bound": "steps-post",
    }


def test_no_two_lines_of_a_panel_look_alike() -> None:
    n = 8
    names = [f"a.x{j}" for j in range(n)]
    results = Results(
        [0.0, 1.0], np.vstack([np.arange(n), np.ones(n)]), [ResultVariable(x, "W") for x in names]
    )
    signals = [{"name": x, "style": "dotted"} if j == 5 else x for j, x in enumerate(names)]
    spec = FigureSpec.model_validate({"panels": [{"unit": "W", "signals": signals}]})
    lines = draw(results, spec).axes[0].get_lines()
    assert len({line.get_color() for line in lines}) == n
    assert len({str(line._unscaled_dash_pattern) for line in lines}) == n


def test_the_states_shade_every_panel_for_as_long_as_they_last() -> None:
    figure = draw(scooter(), SPEC)
    for axes in figure.axes:
        spans = {
            tuple(round(float(x), 6) for x in (*path.get_extents().intervalx,))
            for collection in axes.collections
            for path in collection.get_paths()
        }
        assert spans == {(0.0, 1.5), (30.0, 40.0), (1.5, 10.0), (10.0, 30.0)}
    names = [text.get_text() for legend in _legends(figure.axes[0]) for text in legend.get_texts()]
    assert names[:4] == ["ecu.state:", "driver", "acceleration", "velocity"]


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


def test_saved_twice_is_the_same_bytes_whatever_the_user_s_settings(tmp_path: Path) -> None:
    first = save(draw(scooter(), SPEC), tmp_path / "a")
    with matplotlib.rc_context(
        {"font.size": 30.0, "axes.grid": False, "svg.hashsalt": "x", "figure.dpi": 50}
    ):
        second = save(draw(scooter(), SPEC), tmp_path / "b")
    assert [p.name for p in first] == ["figure.png", "figure.svg"]
    assert [p.read_bytes() for p in first] == [p.read_bytes() for p in second]
    width = int.from_bytes(first[0].read_bytes()[16:20], "big")
    assert width == PNG_WIDTH


def test_a_format_or_a_place_that_does_not_exist_is_named(tmp_path: Path) -> None:
    figure = draw(scooter(), SPEC)
    with pytest.raises(ConfigError, match=r"x.bmp2: 'bmp2' is not a format of figures; use one of .*png"):
        figures.write(figure, tmp_path / "x.bmp2")
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="cannot be written"):
        save(figure, tmp_path / "file")


def test_results_plot_themselves(tmp_path: Path) -> None:
    figure = scooter().plot(tmp_path / "x.svg", title="A title")
    assert figure._suptitle.get_text() == "A title"
    assert (tmp_path / "x.svg").read_bytes().startswith(b"<?xml")
    assert scooter().plot()._suptitle.get_text() == "scooter · fig8"


def test_the_default_figure_groups_by_what_is_measured() -> None:
    spec = default_spec(scooter())
    assert spec.shade == "ecu.state"
    assert [(p.unit, [s.name for s in p.signals]) for p in spec.panels] == [
        ("%", ["rider.throttle", "ecu.throttle"]),  # the request repeats the rider's throttle
        ("km/h", ["ecu.speed_estimate", "vehicle.speed", "ecu.speed_measured", "ecu.speed_bound"]),
        ("rad", ["vehicle.road_grade"]),
    ]
    assert spec.panels[1].label == "speed"
    assert spec.note is None


def test_the_default_figure_has_an_end() -> None:
    units = ("m/s", "W", "V", "A", "N", "N.m", "kg", "K")
    variables = [ResultVariable(f"{u[0]}{i}.x{j}", u) for i, u in enumerate(units) for j in range(10)]
    data = np.random.default_rng(3).normal(size=(20, len(variables)))
    data[:, :10] = 1.0  # the speeds do not change: others are shown first
    spec = default_spec(Results(np.arange(20), data, variables))
    assert [p.unit for p in spec.panels] == list(units[1:7])
    assert all(len(p.signals) == 8 for p in spec.panels)
    assert spec.note is not None
    assert spec.note.startswith("Not shown: m0.x0, m0.x1") and spec.note.endswith("and 24 more")


def test_enumerations_beside_the_shading_one_and_booleans_have_a_panel_with_their_names() -> None:
    variables = [
        ResultVariable("ecu.state", type="Enumeration", items=STATES),
        ResultVariable("abs.mode", type="Enumeration", items=((1, "off"), (2, "on"))),
        ResultVariable("abs.ready", type="Boolean"),
        ResultVariable("bare.number"),
    ]
    data = np.array([[0, 1, 0, 1e3], [1, 2, 1, 2e3], [2, 1, 0, 3e3]], dtype=float)
    results = Results([0.0, 1.0, 2.0], data, variables)
    spec = default_spec(results)
    assert spec.shade == "ecu.state"
    ticks = [[t.get_text() for t in axes.get_yticklabels()] for axes in draw(results).axes]
    assert ticks[:2] == [["off", "on"], ["false", "true"]]
    alone = Results(results.time, data[:, :1], variables[:1])
    assert [t.get_text() for t in draw(alone).axes[0].get_yticklabels()] == [name for _, name in STATES]


@pytest.mark.parametrize("value", [0.0, 5.0, -3e6, 1e-9])
def test_a_constant_is_seen_in_the_middle(value: float) -> None:
    data = value * (1.0 + 1e-15 * np.sin(np.arange(50.0)))[:, None]
    axes = draw(Results(np.arange(50), data, [ResultVariable("a.x", "V")])).axes[0]
    low, high = axes.get_ylim()
    assert (low + high) / 2 == pytest.approx(value, abs=1e-9 * (high - low))
    assert high - low > 0.1 * abs(value)


def test_results_without_points_or_with_gaps_are_drawn() -> None:
    variables = [ResultVariable("a.x", "V"), ResultVariable("a.state", type="Enumeration", items=STATES)]
    assert len(draw(Results([], np.empty((0, 2)), variables)).axes) == 2
    gap = draw(Results([0, 1, 2], [[1.0, 0], [np.nan, 1], [2.0, 2]], variables)).axes[0]
    assert gap.get_ylim() == pytest.approx((0.93, 2.07))
    with pytest.raises(ConfigError, match="no variable to draw"):
        draw(Results([0.0], np.empty((1, 0)), []))


samples = arrays.arrays(np.float64, st.integers(0, 400), elements=st.floats(-1e3, 1e3))


@given(samples, st.integers(10, 60))
def test_thinning_keeps_the_ends_the_extremes_and_the_order(values: np.ndarray, limit: int) -> None:
    keep = thinned(values, limit)
    assert len(keep) <= max(limit + 4, 0)
    assert np.all(np.diff(keep) > 0)
    if len(values):
        assert keep[0] == 0 and keep[-1] == len(values) - 1
        assert values[keep].min() == values.min() and values[keep].max() == values.max()


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
    monkeypatch.setattr(figures, "PIECE", rows)
    pieces = draw(results)
    assert len(pieces.axes) == len(whole.axes) > 2
    for a, b in zip(whole.axes, pieces.axes, strict=True):
        assert (a.get_ylabel(), a.get_ylim()) == (b.get_ylabel(), b.get_ylim())
        shades = [[bars.get_paths() for bars in axes.collections] for axes in (a, b)]
        assert [[p.vertices.tolist() for p in paths] for paths in shades[0]] == [
            [p.vertices.tolist() for p in paths] for paths in shades[1]
        ]
        for one, other in zip(a.get_lines(), b.get_lines(), strict=True):
            assert {tuple(xy) for xy in one.get_xydata()} <= {tuple(xy) for xy in other.get_xydata()}


def test_states_that_chatter_to_the_end_are_drawn_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    state = (np.arange(9000) % 7 // 3).astype(float)
    variables = [ResultVariable("ecu.state", type="Enumeration", items=STATES), ResultVariable("a.x", "V")]
    results = Results(np.arange(9000.0), np.column_stack([state, state]), variables)
    few = Results(np.arange(20.0), results.data[:20], variables)
    found = []
    for rows in (100_000, 50):
        monkeypatch.setattr(results_module, "PIECE", rows)
        shades = [c for r in (results, few) for c in draw(r).axes[0].collections]
        found.append([[p.vertices.tolist() for p in bars.get_paths()] for bars in shades])
    assert found[0] == found[1]
    assert sum(map(len, found[0][:3])) > 100


def test_a_comparison_shows_what_differs_most() -> None:
    a, b = scooter(), scooter(301)
    other = Results(b.time, b.data * 1.01, b.variables)
    figure = draw_comparison(a, other, ["vehicle.speed", "ecu.state"], labels=("old", "new"))
    assert [axes.get_ylabel() for axes in figure.axes] == ["vehicle.speed [m/s]", "[m/s]", "ecu.state", ""]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["old", "new"]
    changed = scooter()
    changed.data[50, changed.names.index("vehicle.speed")] += 1.0
    overlay, beside = draw_comparison(a, changed).axes
    assert overlay.get_ylabel() == "vehicle.speed [m/s]"
    (line,) = beside.get_lines()
    assert sorted(line.get_ydata())[-2:] == pytest.approx([0.0, 1.0])
    nothing = Results(a.time, a.data[:, :1], [ResultVariable("x.y")])
    with pytest.raises(ConfigError, match="no variable in common"):
        draw_comparison(a, nothing)


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("ecu.acceleration_estimate", ["ecu.", "acceleration_estimate"]),
        ("controller.rear_steering_angle", ["controller.", "rear_steering_angle"]),
        ("ecu.a_very_long_name_of_a_variable_that", ["ecu.a_very_long_name_of_", "a_variable_that"]),
        ("speed of the front wheel of the vehicle", ["speed of the front wheel", "of the vehicle"]),
        ("x" * 40, ["x" * 40]),
        ("", [""]),
    ],
)
def test_names_are_broken_at_their_marks(text: str, lines: list[str]) -> None:
    assert broken(text, 24).split("\n") == lines


WRONG = [
    ({"signals": ["vehicle.sped"]}, r"panel 1: no variable 'vehicle.sped' .*did you mean 'vehicle.speed'"),
    (
        {"unit": "N", "signals": ["vehicle.speed"]},
        r"'vehicle.speed' \[m/s\] in \[N\]: .*different quantities",
    ),
]


@pytest.mark.parametrize(("panel", "message"), WRONG)
def test_a_panel_that_cannot_be_drawn_is_refused(panel: dict, message: str) -> None:
    spec = FigureSpec.model_validate({"panels": [panel]})
    with pytest.raises(ConfigError, match=message):
        draw(scooter(), spec)


def test_only_an_enumeration_shades() -> None:
    spec = FigureSpec.model_validate({"shade": "vehicle.speed", "panels": [{"signals": ["ecu.state"]}]})
    with pytest.raises(ConfigError, match=r"'vehicle.speed' is not an enumeration, so it has no states"):
        draw(scooter(), spec)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"panels": []}, "panels: List should have at least 1 item"),
        ({"panels": [{"signals": []}]}, "panels 1.signals: List should have at least 1 item"),
        ({"panels": [{"signals": ["x"], "limits": [2, 1]}]}, "limits: the first must be below the second"),
        (
            {"panels": [{"signals": [{"name": "x", "sytle": "dashed"}]}]},
            r"unknown key \(did you mean 'style'",
        ),
        ({"panels": [{"signals": [{"name": "x", "style": "wavy"}]}]}, "Input should be 'solid', 'dashed'"),
    ],
)
def test_a_wrong_key_of_a_figure_is_named(keys: dict, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        validate(keys, FigureSpec, "scooter.toml")


def test_a_signal_without_a_unit_says_so_in_the_legend() -> None:
    results = Results([0.0, 1.0], [[1.0], [2.0]], [ResultVariable("vendor.speed")])
    spec = FigureSpec.model_validate({"panels": [{"unit": "km/h", "signals": ["vendor.speed"]}]})
    text = draw(results, spec).axes[0].get_legend().get_texts()[0].get_text()
    assert text.replace("\n", " ") == "vendor.speed (no unit declared)"


@pytest.mark.parametrize(
    ("unit", "shown"), [("m/s2", "m/s²"), ("N.m", "N·m"), ("kg/m3", "kg/m³"), ("1", "1"), ("m.s-1", "m·s⁻¹")]
)
def test_units_are_printed_as_in_print(unit: str, shown: str) -> None:
    assert pretty(unit) == shown


def test_a_chart_that_is_not_over_time_looks_like_the_others(tmp_path):
    with figures.canvas(2, 2, height=2.0, title="chart") as (figure, axes):
        assert axes.shape == (2, 2)
        for i, one in enumerate(axes.flat):
            one.plot([0.0, 1.0], [0.0, i], **figures.look(i))
    png, _ = figures.save(figure, tmp_path)
    assert png.stat().st_size > 1000
    looks = [(figures.look(i)["color"], str(figures.look(i)["linestyle"])) for i in range(8)]
    assert len(set(looks)) == 8
