"""`evcosim compare`: two results, compared within a tolerance."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from ...cosim.results.results import Results


def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="Results folder or CSV file.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="What to compare with it.")],
    tolerance: Annotated[
        float, typer.Option(metavar="T", help="Difference allowed, in each variable's own unit.")
    ] = 0.0,
    relative: Annotated[
        float, typer.Option(metavar="R", help="Difference allowed beside it, as a share of the range in A.")
    ] = 0.0,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw what differs most (.png .svg .pdf, .html a page)."),
    ] = None,
    signals: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PATTERN", help="Only these, as in 'vehicle.*', or not: '!ecu.*'; can be given again."
        ),
    ] = None,
    common: Annotated[
        bool, typer.Option("--common", help="Leave out variables that one side alone has.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> int:
    """Compare two results; exit code 1 when they differ."""
    from ...cosim.results import compare as comparing
    from ...cosim.results.results import Results
    from .console import print_json, print_paragraph, print_table
    from .plot import is_page, warn_of_tables

    first, second = Results.read(a), Results.read(b)
    warn_of_tables((a, first), (b, second))
    if signals:
        first, second = _chosen(first, second, signals)
    found = comparing.compare(first, second, tolerance, relative, common)
    metrics = [] if signals else _metrics(first, second)
    if plot is not None and is_page(plot):
        from ...cosim.report.overlay import write_comparison

        chosen = list(dict.fromkeys(_names(first) + _names(second))) if signals else None
        write_comparison(plot, found, first, second, (str(a), str(b)), chosen)
    elif plot is not None:
        from ...cosim.figures import draw as figures

        names = [name for name in first.names if name in second.names] if signals else None
        figures.write(figures.draw_comparison(first, second, names, labels=(str(a), str(b))), plot)
    if as_json:
        print_json(dataclasses.asdict(found) | {"equal": found.equal, "metrics": metrics})
        return 0 if found.equal else 1
    headers, rows = found.table(all_rows=False)
    if rows:
        print_table(headers, rows, right=headers[2:6])
        print()
    if not found.equal and (shown := _differing(metrics)):
        print_table(("metric", str(a), str(b)), shown)
        print()
    for line in found.summary().split("\n"):
        print_paragraph(line)
    return 0 if found.equal else 1


def _names(results: Results) -> list[str]:
    return [*results.names, *results.texts]


def _chosen(first: Results, second: Results, patterns: list[str]) -> tuple[Results, Results]:
    """Return the variables of both that match a pattern. Raises ConfigError for one that matches none."""
    from .plot import names_chosen

    every = names_chosen(list(dict.fromkeys(_names(first) + _names(second))), patterns)
    one, other = (each.part(slice(None), [n for n in every if n in each]) for each in (first, second))
    return one, other


def _metrics(first: Results, second: Results) -> list[dict[str, Any]]:
    """Return the metrics that both runs have, as they stand in JSON."""
    from ...cosim.report.facts import numbers_of_metrics, plain

    one, other = (numbers_of_metrics(plain(results.manifest)) for results in (first, second))
    return [
        {"name": name, "a": a, "a_unit": unit, "b": b, "b_unit": b_unit, "equal": (a, unit) == (b, b_unit)}
        for name, (a, unit) in one.items()
        if name in other
        for b, b_unit in [other[name]]
    ]


def _differing(metrics: list[dict[str, Any]]) -> list[tuple[str, str, str]]:
    """Return the metrics that differ as they are shown, with their values."""
    from ...cosim.report.facts import number_with_unit

    shown = [
        (m["name"], number_with_unit(m["a"], m["a_unit"]), number_with_unit(m["b"], m["b_unit"]))
        for m in metrics
    ]
    return [(name, one, other) for name, one, other in shown if one != other]
