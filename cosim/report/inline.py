"""Results as a notebook shows them: a line on the run, its metrics, its figure."""

from __future__ import annotations

import base64

from ..errors import ConfigError
from ..figures.asked import plot
from ..figures.default_figure import title_of
from ..figures.shown import ShownFigure
from ..results.results import Results
from .markup import escaped


def shown(results: Results) -> str:
    """Return the HTML of some results, of which whatever cannot be made is named with the reason."""
    line = f"<p><b>{escaped(title_of(results))}</b> {escaped(repr(results))}</p>"
    return f"<div>{line}{_metrics(results)}{_figure(results)}</div>"


def _metrics(results: Results) -> str:
    if not results.metric_specs:
        return ""
    try:
        return results.metrics._repr_html_()
    except ConfigError as error:
        return f"<p>no metrics: {escaped(error)}</p>"


def _figure(results: Results) -> str:
    if not len(results):
        return "<p>no figure: the run has no communication point</p>"
    try:
        figure = plot(results, None, None, None, None)
    except ConfigError as error:
        return f"<p>no figure: {escaped(error)}</p>"
    assert isinstance(figure, ShownFigure)  # `canvas` makes no other ones
    picture = base64.b64encode(figure._repr_png_()).decode("ascii")
    return f'<img style="max-width: 100%" alt="the figure of the run" src="data:image/png;base64,{picture}">'
