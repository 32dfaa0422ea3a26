"""Results as a notebook shows them."""

from __future__ import annotations

import base64
import re
from html.parser import HTMLParser

import numpy as np

from evcosim.cosim.results.metrics import Metric, Metrics
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.figure_spec import FigureSpec
from evcosim.cosim.system.metric_spec import MetricSpec

BAD = "<script>alert(1)</script>"
SPEED = ResultVariable("vehicle.speed", "m/s")


def tags(html: str) -> list[str]:
    """Return the names of all tags that begin, as a browser reads them."""
    found: list[str] = []
    parser = HTMLParser()
    parser.handle_starttag = lambda tag, attributes: found.append(tag)
    parser.feed(html)
    return found


def some(n: int = 11, **options) -> Results:
    t = np.arange(n) * 0.1
    return Results(t, t[:, None], [SPEED], {"system": "scooter", "scenario": "fig8"}, **options)


def test_the_metrics_and_the_figure_are_shown():
    top = MetricSpec(name="top speed", signal="vehicle.speed", reduce="max", unit="km/h")
    shown = some(metrics=[top])._repr_html_()
    assert "scooter · fig8" in shown
    assert "11 communication points, 0 to 1 s" in shown
    assert re.search(r"<td[^>]*>top speed</td><td[^>]*>3\.6 km/h</td>", shown)
    picture = re.search(r'src="data:image/png;base64,([^"]+)"', shown)
    assert picture
    assert base64.b64decode(picture[1]).startswith(b"\x89PNG")
    assert len(shown) < 100_000
    assert "http" not in shown


def test_the_figure_is_that_of_the_system():
    spec = FigureSpec(panels=[{"signals": ["vehicle.speed"]}, {"signals": ["vehicle.speed"]}])
    assert some(figure=spec)._repr_html_() != some()._repr_html_()


def test_names_do_nothing():
    variable = ResultVariable(f"a.{BAD}", BAD)
    metric = MetricSpec(name=BAD, signal=variable.name, unit=BAD)
    results = Results(
        [0.0, 1.0], [[1.0], [2.0]], [variable], {"system": BAD, "scenario": 3}, metrics=[metric]
    )
    assert "script" not in tags(results._repr_html_())
    assert "&lt;script&gt;" in results._repr_html_()
    table = Metrics([Metric(BAD, 1.0, BAD)])._repr_html_()
    assert tags(table) == ["table", "tr", "td", "td"]


def test_what_cannot_be_shown_is_named_with_the_reason():
    """Never an error: a notebook shows none, but the line alone."""
    lost = some(metrics=[MetricSpec(name="m", signal="ecu.gone")])._repr_html_()
    assert "no metrics: metrics: metric &#x27;m&#x27;: no variable" in lost
    assert "<img" in lost
    assert "no figure: the run has no communication point" in some(0)._repr_html_()
    bare = Results([0.0], np.empty((1, 0)), [])._repr_html_()
    assert "no figure: the results have no variable to draw" in bare
    gone = some(figure=FigureSpec(panels=[{"signals": ["ecu.gone"]}]))._repr_html_()
    assert "no figure: figure.panels 1.signals 1: no variable" in gone
    assert some(1)._repr_html_().count("<img") == 1
