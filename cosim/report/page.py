"""The page of a run: an HTML file that needs no network, with curves to zoom into and all that is known."""

from __future__ import annotations

from pathlib import Path

from ..results.results import Results
from ..system.figure_spec import FigureSpec
from ..writing import write_text
from . import facts
from .assets import page_styles, policy, scripts, styles
from .charts import charts
from .markup import escaped


def write_report(path: Path, results: Results, spec: FigureSpec | None = None) -> None:
    """Write the page of a run; without a spec the figure is the run's own, or signals grouped by unit.

    Equal runs make equal bytes. Raises ConfigError for a spec that does not fit, and where the file cannot be
    written.
    """
    write_text(path, report(results, spec))


def report(results: Results, spec: FigureSpec | None = None) -> str:
    """Return the page of a run as HTML. Raises ConfigError for a spec that does not fit."""
    about = facts.plain(results.manifest)
    span = results.span if len(results) else (0.0, 0.0)
    failed = "error" in about
    metrics = [] if failed or not results.metric_specs else results.metrics
    described = (*results.variables, *results.text_table.variables)
    body = (
        facts.headline(about, len(results), span),
        facts.first_of_all(about) if about else "",
        charts(results, spec or results.figure, facts.events_of(about)),
        facts.metrics_section(metrics, about),
        facts.buses_section(about),
        facts.parameters_section(about),
        facts.units_section(about),
        facts.repeat_section(about),
        facts.versions_section(about),
        facts.manifest_section(about, described),
    )
    names = [str(about[key]) for key in ("system", "scenario") if about.get(key)]
    return page(" ".join(names) or "results", *body)


def page(title: str, *body: str) -> str:
    """Return a page as HTML, of parts that are HTML: with all that it needs, and no way to the network."""
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f"{policy()}<title>{escaped(title)}</title>"
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"{styles()}{page_styles()}</head><body>\n"
        + "\n".join(part for part in body if part)
        + f"\n{scripts()}</body></html>\n"
    )
