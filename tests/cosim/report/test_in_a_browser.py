"""Pages in a headless Chromium: linked zoom, values under the cursor, the search, names that do nothing."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.report.charts import charts
from evcosim.cosim.report.page import page, write_report
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import FigureSpec, PanelSpec, SignalSpec
from support.browser import browser
from support.pages import HOSTILE, hostile_run, small_run

RUN = small_run(
    events=[{"time": 1.0, "action": "override", "variable": "ecu.torque", "value": 3.0}],
    system="cart", warnings=[], status="done",
)  # fmt: skip # the record of an event on one line
SPEC = FigureSpec(
    shade="ecu.state",
    panels=[
        PanelSpec(
            label="Speed", unit="km/h", signals=[SignalSpec(name="car.speed"), SignalSpec(name="car.wind")]
        ),
        PanelSpec(label="Torque", unit="N.m", signals=[SignalSpec(name="ecu.torque")], limits=(-1.0, 5.0)),
    ],
)
CHARTS = "document.querySelector('section.charts').charts"


@pytest.fixture(scope="module")
def chromium():
    with browser() as found:
        yield found


@pytest.fixture
def opened(chromium, tmp_path):
    """Open the page of a run, and afterwards: no error in the console, nothing from the network."""

    def open_page(results, spec=None, width=1280):
        write_report(tmp_path / "report.html", results, spec)
        chromium.open(tmp_path / "report.html", width)
        chromium.settle()
        return chromium

    yield open_page
    assert chromium.said == []
    assert chromium.asked == [(tmp_path / "report.html").as_uri()]
    assert not chromium.run("'hit' in window")


def views(page):
    return page.run(f"{CHARTS}.panels.map(p => [p.plot.scales.x.min, p.plot.scales.x.max])")


def plot(page, number=0):
    """Return left, top, width, height [px] of what a panel draws on."""
    page.run(f"{CHARTS}.panels[{number}].root.scrollIntoView({{block: 'center'}})")
    box = "p.plot.over.getBoundingClientRect()"
    return page.run(f"(p => [{box}.left, {box}.top, {box}.width, {box}.height])({CHARTS}.panels[{number}])")


def point_at(page, row, number=0):
    """Move the mouse to a row of the run in a panel."""
    left, top, width, height = plot(page, number)
    low, high = views(page)[number]
    page.mouse("mouseMoved", left + width * (RUN.time[row] - low) / (high - low), top + height / 2)
    page.settle()


def values(page):
    return page.run("[...document.querySelectorAll('.key b')].map(b => b.textContent)")


def test_values_under_the_cursor_are_those_of_the_row(opened):
    page = opened(RUN, SPEC)
    for row in (0, 57, 123, 301, 400):
        point_at(page, row, number=row % 2)
        speed, wind, torque = values(page)
        assert speed == f"{3.6 * np.float32(RUN['car.speed'][row]):.6g} km/h"
        assert wind == f"{np.float32(RUN['car.wind'][row]):.6g} km/h"
        assert torque == f"{RUN['ecu.torque'][row]:.6g} N·m"
        state = ["off", "on", "failed"][[0, 1, 5].index(RUN["ecu.state"][row])]
        assert (
            page.run("document.querySelector('output').textContent") == f"t = {RUN.time[row]:.6g} s · {state}"
        )
    page.mouse("mouseMoved", 5, 5)
    page.settle()
    assert values(page)[2] == f"{RUN['ecu.torque'][-1]:.6g} N·m"  # at rest: the end of what is in view
    page.run(f"{CHARTS}.zoom(1, 2.5); {CHARTS}.rest()")
    assert values(page)[2] == "2 N·m"


def test_a_drag_zooms_all_panels_and_all_shows_the_run_again(opened):
    page = opened(RUN, SPEC)
    assert views(page) == [[0, 4], [0, 4]]
    left, top, width, height = plot(page)
    page.drag((left + 0.25 * width, top + height / 2), (left + 0.5 * width, top + height / 2))
    for low, high in views(page):
        assert (low, high) == (pytest.approx(1.0, abs=0.02), pytest.approx(2.0, abs=0.02))
    low, high = views(page)[0]
    middle, length = (low + high) / 2, high - low
    for name, at, size in (
        ("later", 0.25, 1),
        ("zoom in", 0.25, 0.5),
        ("zoom out", 0.25, 1),
        ("earlier", 0, 1),
    ):
        page.run(f"document.querySelector('[aria-label=\"{name}\"]').click()")
        page.settle()
        expected = [middle + at * length - size * length / 2, middle + at * length + size * length / 2]
        assert views(page) == [pytest.approx(expected)] * 2
    page.run("document.querySelector('[aria-label=\"the whole run\"]').click()")
    page.settle()
    assert views(page) == [[0, 4], [0, 4]]
    assert page.run(f"{CHARTS}.panels[1].plot.scales.y.min") == -1.0  # as the figure says


def test_search_adds_a_signal_that_follows_the_zoom_and_can_go(opened):
    page = opened(RUN, SPEC)
    page.run(f"{CHARTS}.zoom(1, 2)")
    page.run("document.querySelector('.search input').focus()")
    page.call("Input.insertText", text="over ground")
    found = page.run("[...document.querySelectorAll('.found button')].map(b => b.firstChild.textContent)")
    assert found == ["car.speed [m/s]"]
    page.run("document.querySelector('.search input').value = ''")
    page.call("Input.insertText", text="mode")
    for kind in ("keyDown", "keyUp"):
        page.call("Input.dispatchKeyEvent", type=kind, key="Enter", code="Enter", windowsVirtualKeyCode=13)
    page.wait(f"{CHARTS}.panels.length === 3 && {CHARTS}.panels[2].plot")
    page.settle()
    assert views(page)[2] == [1, 2]
    assert values(page)[3] == "</script>"
    point_at(page, 150)
    assert values(page)[3] == "warm-up"
    page.run("document.querySelector('h3 button').click()")
    assert len(views(page)) == 2


def test_a_line_is_hidden_by_its_key(opened):
    page = opened(RUN, SPEC)
    page.run("document.querySelectorAll('.key')[1].click()")
    assert page.run(f"{CHARTS}.panels[0].plot.series.map(s => s.show)") == [True, True, False]
    assert page.run("document.querySelectorAll('.key')[1].getAttribute('aria-pressed')") == "false"


def test_held_signals_are_steps_states_shade_and_events_are_marked(opened):
    """Colors are read where they must be: right of a jump, in a state's stretch, at the time of an event."""
    page = opened(RUN, SPEC)
    page.run(
        f"(p => {{ const all = p.ctx.getImageData(0, 0, p.ctx.canvas.width, p.ctx.canvas.height);"
        "const place = (t, v) => 4 * (Math.round(p.valToPos(v, 'y', true)) * all.width + "
        "Math.round(p.valToPos(t, 'x', true)));"
        "window.color = (t, v) => [...all.data.slice(place(t, v), place(t, v) + 3)];"
        f"}})({CHARTS}.panels[1].plot)"
    )
    assert page.run("color(2.53, 2)") == [0, 0x72, 0xB2]  # the torque is 2 from 2 s to 3 s
    assert page.run("color(1.73, 3.4)") == [0xFB, 0xE3, 0xC0]  # "on" from 1.01 s to 3 s
    assert page.run("color(0.73, 3.4)") == [255, 255, 255]
    mark = [page.run(f"color({1.0 + x}, {y / 20})") for x in (-0.004, 0.0, 0.004) for y in range(60)]
    assert any(red > 100 and green < 100 and blue < 100 for red, green, blue in mark)
    assert page.run("document.querySelector('.events').textContent") == "1 s: override ecu.torque = 3"


def test_names_and_values_that_are_hostile_do_nothing(opened):
    run = hostile_run()
    page = opened(run)
    titles = page.run(f"{CHARTS}.data.signals.map(s => s.title)")
    assert HOSTILE[0] in titles and len(titles) == len(run.names) + 1
    for i in range(len(titles)):
        page.run(f"{CHARTS}.add({CHARTS}.data.signals[{i}], true).then(() => 0)")
    page.settle()
    assert page.run("document.querySelectorAll('img').length") == 0
    text = page.run("document.body.innerText")
    assert HOSTILE[0] in text and HOSTILE[1] in text and "\u202e" not in text


@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_rows(opened, count):
    page = opened(small_run(count), width=390)
    assert page.run("document.documentElement.scrollWidth") <= 390
    assert page.run("document.querySelectorAll('.panel').length > 0") == (count > 0)


@pytest.mark.parametrize("width", [390, 1280])
def test_no_page_is_wider_than_the_screen(opened, width):
    page = opened(hostile_run(), width=width)
    assert page.run("document.documentElement.scrollWidth") <= width
    assert page.run("document.querySelector('.uplot').getBoundingClientRect().right") <= width


def test_two_runs_on_their_own_times_share_a_panel(chromium, tmp_path):
    """Grids that differ are put together: each line has its own rows."""
    from evcosim.cosim.figures.axes import TimeAxis
    from evcosim.cosim.figures.style import Stroke
    from evcosim.cosim.report.charts import element
    from evcosim.cosim.report.columns import Columns
    from evcosim.cosim.report.panels import line_data, panel_data

    times = [np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.5, 1.5, 2.0])]
    columns = Columns()
    numbers = [columns.column(columns.grid(t), 10.0 * t) for t in times]
    lines = [line_data(n, f"run {n}", n == 1, Stroke("#000", "solid", 1.0)) for n in numbers]
    run = Results(times[0], times[0][:, None], [ResultVariable("a.x")])
    part = element(TimeAxis.of(run), columns, panels=[panel_data("x", "m", lines, ())], signals=[])
    (tmp_path / "two.html").write_text(page("two", part, charts(small_run())), encoding="utf-8")
    chromium.open(tmp_path / "two.html")
    chromium.run(f"{CHARTS}.show(1.6)")
    assert values(chromium)[:2] == ["20 m", "15 m"]  # the nearest row, and the one that is held
    chromium.run(f"{CHARTS}.show(2.5)")
    assert values(chromium)[:2] == ["-", "-"]  # behind the end of both
    assert chromium.run(f"[...{CHARTS}.panels[0].plot.data[0]]") == [0, 0.5, 1, 1.5, 2]
    assert chromium.said == []
