"""`evcosim compare`: two results, compared within a tolerance."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

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
        typer.Option(metavar="PATTERN", help="Only these variables, as in 'vehicle.*'; can be given again."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> int:
    """Compare two results; exit code 1 when they differ."""
    from ...cosim.results import compare as comparing
    from ...cosim.results.results import Results
    from .console import print_json, print_paragraph, print_table
    from .plot import chosen, is_page

    first, second = Results.read(a), Results.read(b)
    if signals:
        first = chosen(first, signals)
        common = [name for name in (*first.names, *first.texts) if name in second]
        second = second.part(slice(None), common)
    found = comparing.compare(first, second, tolerance, relative)
    if plot is not None and is_page(plot):
        from ...cosim.report.overlay import write_comparison

        chosen_names = (*second.names, *second.texts) if signals else None
        write_comparison(plot, found, first, second, (str(a), str(b)), chosen_names)
    elif plot is not None:
        from ...cosim.figures import draw as figures

        names = second.names if signals else None
        figures.write(figures.draw_comparison(first, second, names, labels=(str(a), str(b))), plot)
    if as_json:
        print_json(dataclasses.asdict(found) | {"equal": found.equal})
        return 0 if found.equal else 1
    headers, rows = found.table(all_rows=False)
    if rows:
        print_table(headers, rows, right=headers[2:6])
        print()
    if not (signals or found.equal) and (metrics := _metrics(first, second)):
        print_table(("metric", str(a), str(b)), metrics)
        print()
    for line in found.summary().split("\n"):
        print_paragraph(line)
    return 0 if found.equal else 1


def _metrics(first: Results, second: Results) -> list[tuple[str, str, str]]:
    """Return the metrics that both runs have, and that differ, with their values."""
    from ...cosim.report.facts import kept_metrics, plain

    one, other = (dict(kept_metrics(plain(results.manifest))) for results in (first, second))
    return [(name, text, other[name]) for name, text in one.items() if other.get(name, text) != text]
