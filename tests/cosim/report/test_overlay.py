"""The page of two runs: lines of both in one unit, their difference, and what differs between the runs."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.report.overlay import comparison, write_comparison
from evcosim.cosim.results.compare import compare
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.results.text_table import TextTable
from support.pages import HOSTILE, data_in, hostile_run, small_run, times_of, unpacked


def made(a, b, names=None, labels=("one", "two")):
    return comparison(compare(a, b), a, b, labels, names)


def of(data, line):
    column = data["columns"][line["column"]]
    return times_of(data["grids"][column["grid"]]), line["scale"] * unpacked(column) + line["offset"]


def run(values, unit="m/s", step=0.01, name="a.x", **manifest):
    time = np.round(np.arange(len(values)) * step, 9)
    return Results(time, np.asarray(values, dtype=float)[:, None], [ResultVariable(name, unit)], manifest)


def test_both_runs_are_in_the_unit_of_the_first_with_their_own_times():
    first, second = run([1.0, 2.0, 3.0]), run([3.6, 7.2], "km/h", 0.02)
    (data,) = data_in(made(first, second))
    both, apart = data["panels"]
    assert (both["title"], both["unit"], [line["label"] for line in both["lines"]]) == (
        "a.x",
        "m/s",
        ["one", "two"],
    )
    times, values = of(data, both["lines"][1])
    np.testing.assert_allclose(times, second.time)
    np.testing.assert_allclose(values, [1.0, 2.0])
    assert apart["title"] == "a.x: difference"
    np.testing.assert_allclose(of(data, apart["lines"][0])[1], [0.0, -0.5, -1.0], atol=1e-6)


def test_the_variables_that_differ_most_or_those_that_are_named():
    a = small_run()
    data = a.data.copy()
    data[:, 1] += 5.0
    b = Results(a.time, data, a.variables, texts=a.text_table)
    (shown,) = data_in(made(a, b))
    assert [panel["title"] for panel in shown["panels"]] == ["car.wind", "car.wind: difference"]
    (shown,) = data_in(made(a, b, ["ecu.mode", "ecu.state"]))
    assert [panel["title"] for panel in shown["panels"]] == ["ecu.mode", "ecu.state", "ecu.state: difference"]
    assert {signal["title"] for signal in shown["signals"]} == {*a.names, *a.texts}


def test_texts_have_one_number_each_in_both_runs():
    def texts(*of_rows):
        table = TextTable(
            [ResultVariable("a.s", "", "String")], [(k, (text,)) for k, text in enumerate(of_rows)]
        )
        return Results(np.arange(3.0), np.empty((3, 0)), [], texts=table)

    (data,) = data_in(made(texts("x", "y", "z"), texts("y", "x", "w"), ["a.s"]))
    names = dict(data["panels"][0]["items"])
    shown = [[names[int(v)] for v in of(data, line)[1]] for line in data["panels"][0]["lines"]]
    assert shown == [["x", "y", "z"], ["y", "x", "w"]]


def test_what_is_on_one_side_alone_or_measures_something_else():
    (data,) = data_in(made(run([1.0, 2.0]), run([1.0, 2.0], "N"), ["a.x"]))
    assert [len(panel["lines"]) for panel in data["panels"]] == [1]
    (data,) = data_in(made(run([1.0, 2.0]), run([1.0, 2.0], name="a.y")))
    assert (data["panels"], [len(signal["lines"]) for signal in data["signals"]]) == ([], [1, 1])


def test_settings_metrics_and_commands_side_by_side():
    def settled(mass, value):
        return run(
            [1.0, 2.0],
            units={"car": {"parameters": {"mass": mass}, "sha256": "abc"}},
            metrics={"way": {"value": value, "unit": "m"}},
            command=f"evcosim run cart --set car.mass={mass}",
        )

    page = made(settled(100.0, 1.5), settled(180.0, 2.5))
    for text in ("units.car.parameters.mass", "100", "180", "1.5 m", "2.5 m", "--set car.mass=180"):
        assert text in page
    assert "units.car.sha256" not in page
    assert "Nothing that run.json tells" in made(settled(1.0, 1.0), settled(1.0, 2.0))


def test_events_of_both_runs():
    event = {"time": 1.0, "action": "set", "variable": "a.b", "value": 2.0}
    (data,) = data_in(made(run([1.0, 2.0], events=[event]), run([1.0, 3.0], events=[event])))
    assert data["events"] == [{"time": 1.0, "text": "set a.b = 2"}]
    (data,) = data_in(made(run([1.0, 2.0], events=[event]), run([1.0, 3.0])))
    assert data["events"] == [{"time": 1.0, "text": "one: set a.b = 2"}]


def test_failures_and_warnings_of_a_run_come_first():
    page = made(run([1.0], status="failed", error="it broke"), run([1.0], warnings=["mind"]))
    assert page.index("it broke") < page.index("mind") < page.index('class="charts"')


@pytest.mark.parametrize(("a", "b"), [(0, 3), (3, 0), (0, 0), (1, 1)])
def test_few_rows(a, b):
    page = made(small_run(a), small_run(b))
    assert ("recorded no row" in page) == (not a or not b)


def test_names_are_no_markup(tmp_path):
    write_comparison(
        tmp_path / "x.html",
        compare(hostile_run(), hostile_run(200)),
        hostile_run(),
        hostile_run(200),
        (HOSTILE[0], HOSTILE[1]),
    )
    page = (tmp_path / "x.html").read_text(encoding="utf-8")
    assert page.count("<script") == page.count("</script>") == 3
    assert "<img" not in page.replace("\\u003cimg", "") and "\u202e" not in page
