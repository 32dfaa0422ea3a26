"""The part of a page with the panels: its data, and that it is JSON that ends no element."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.report.charts import as_json, charts
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import EndSpec, FigureSpec, PanelSpec, SignalSpec
from support.pages import HOSTILE, data_in, hostile_run, small_run


def test_a_run_without_a_figure_has_its_signals_by_quantity():
    (data,) = data_in(charts(small_run(), events=[(1.0, "set a")]))
    assert data["states"]["name"] == "ecu.state"
    assert "speed" in [panel["title"] for panel in data["panels"]]
    assert data["time"] == {"scale": 1.0, "unit": "s", "begin": 0.0, "end": 4.0, "shown": [0.0, 4.0]}
    assert data["events"] == [{"time": 1.0, "text": "set a"}]
    assert len(data["signals"]) == 7


def test_a_long_run_is_in_minutes():
    (data,) = data_in(charts(small_run(1000, step=1.0)))
    assert (data["time"]["unit"], data["time"]["end"]) == ("min", pytest.approx(999 / 60))


def test_the_figure_that_is_asked_for_and_its_note():
    spec = FigureSpec(panels=[PanelSpec(unit="m/s", signals=[SignalSpec(name="car.speed")])], note="a <note>")
    part = charts(small_run(), spec)
    (data,) = data_in(part)
    assert (len(data["panels"]), data["states"]) == (1, None)
    assert "a &lt;note&gt;" in part
    with pytest.raises(ConfigError, match=r"no variable 'car\.sped' is recorded"):
        charts(small_run(), FigureSpec(panels=[PanelSpec(signals=[SignalSpec(name="car.sped")])]))


def test_a_figure_that_ends_before_its_run():
    until = EndSpec(signal="car.speed", below=0.0, unit="km/h")
    spec = FigureSpec(until=until, panels=[PanelSpec(unit="m/s", signals=[SignalSpec(name="car.speed")])])
    part = charts(small_run(step=0.1), spec)  # at once: the run begins there
    assert data_in(part)[0]["time"]["shown"] == [0.0, 40.0]
    low = until.model_copy(update={"signal": "car.wind", "below": 3.59, "unit": None})
    part = charts(small_run(step=0.1), spec.model_copy(update={"until": low}))  # in the first step: a point
    assert data_in(part)[0]["time"]["shown"] == [0.0, 40.0] and "The figure ends" not in part
    spec = spec.model_copy(update={"until": until.model_copy(update={"signal": "car.wind"})})
    part = charts(small_run(step=0.1), spec)
    assert (data_in(part)[0]["time"]["shown"], data_in(part)[0]["time"]["end"]) == ([0.0, 1.5], 40.0)
    assert "The figure ends at 1.5 s" in part


def test_the_figure_alone_has_its_own_columns_and_no_search():
    spec = FigureSpec(
        shade="ecu.state", panels=[PanelSpec(unit="m/s", signals=[SignalSpec(name="car.speed")])]
    )
    (data,) = data_in(charts(small_run(), spec, search=False))
    assert (len(data["columns"]), data["signals"], data["states"]["name"]) == (2, [], "ecu.state")
    assert data["panels"] == data_in(charts(small_run(), spec))[0]["panels"]


def test_no_row_one_row_and_texts_alone():
    assert "No row was recorded" in charts(small_run(0))
    (data,) = data_in(charts(small_run(1)))
    assert data["panels"]
    run = small_run()
    texts = Results(run.time, np.empty((len(run), 0)), [], texts=run.text_table)
    (data,) = data_in(charts(texts))
    assert [panel["title"] for panel in data["panels"]] == ["ecu.mode"]
    parameter = Results([0.0, 1.0], np.ones((2, 1)), [ResultVariable("a.p", causality="parameter")])
    assert len(data_in(charts(parameter))[0]["panels"]) == 1


def test_no_name_ends_the_element_of_the_data():
    part = charts(hostile_run())
    assert part.count("</script>") == 1
    titles = {signal["title"] for signal in data_in(part)[0]["signals"]}
    assert HOSTILE[0] in titles and "a.\\u202eevil\\u200b" in titles
    assert as_json({"</script>": "<!--&"}) == '{"\\u003c/script\\u003e":"\\u003c!--\\u0026"}'
