"""`evcosim budget`: the bus delay, coarseness and slowness at which a system's own metric breaks."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .options import ALONE, ScenarioOption, SystemArgument, WorkersOption, takes_run_options

if TYPE_CHECKING:
    from ...cosim.analysis.bus_budget import Budget
    from ...cosim.system.run_options import RunOptions

_PAGE, _DATA, _TABLE, _FIGURE = "budget.md", "budget.json", "budget.csv", "budget"


@takes_run_options("ideal", "record", *ALONE)
def budget(
    system: SystemArgument,
    scenario: ScenarioOption = None,
    *,
    options: RunOptions,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Default: results/<system>-<scenario>-budget."),
    ] = None,
    workers: WorkersOption = None,
    seeds: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=1,
            help="Vary timing, jitter and lost frames too, what is chance over N seeds.",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the budget as JSON.")] = False,
) -> int:
    """Find how late, coarse and slow the buses may be.

    Bus delay, signal resolution and message cycle are stepped up, each by itself, and the system is judged by
    the metric of its [budget] table. Writes budget.md, budget.json, budget.csv and a figure.
    """
    from ...cosim.analysis.bus_budget import as_data
    from ...cosim.results.repeat import given_options
    from ..studies.bus_budget import budget as measure_budget
    from .console import print_json, progress_bar
    from .studies import ended, names_of, study_folder, written

    kept: dict[str, Any] = {"system": system, "scenario": scenario, "options": given_options(options)}
    if seeds:
        kept["seeds"] = seeds
    folder, remarks = study_folder(output, (*names_of(system, scenario), "budget"), _DATA, kept)
    with progress_bar(f"{system} budget", 0.0, 1.0, not as_json) as show:
        found = measure_budget(
            system,
            scenario,
            workers=workers,
            seeds=seeds or 0,
            progress=lambda done, total, _: show(done / total),
            **options,
        )
    files, unwritten = written(_write(folder, found, kept))
    if as_json:
        print_json(as_data(found) | {"folder": str(folder), "files": files})
    else:
        _show(found, folder, [] if unwritten else files)
    return ended(folder, files, unwritten, remarks)


def _write(folder: Path, found: Budget, settings: dict[str, Any]) -> Iterator[str]:
    """Write page, data, figure and table and yield the names of the files. Raises ConfigError."""
    from ...cosim.analysis.bus_budget import as_csv, as_data, as_markdown
    from ...cosim.figures import draw as figures
    from ...cosim.figures.bus_budget import draw_budget
    from ...cosim.visible import visible_json
    from ...cosim.writing import write_text
    from .studies import with_settings

    write_text(folder / _PAGE, as_markdown(found, f"{_FIGURE}.png"))
    yield _PAGE
    data = with_settings(as_data(found), settings)
    write_text(folder / _DATA, visible_json(json.dumps(data, indent=2, ensure_ascii=False)) + "\n")
    yield _DATA
    for path in figures.save(draw_budget(found), folder, _FIGURE):
        yield path.name
    write_text(folder / _TABLE, as_csv(found))
    yield _TABLE


def _show(found: Budget, folder: Path, files: Sequence[str]) -> None:
    from .console import print_fields, print_paragraph, print_table

    scenario = f" {found.scenario}" if found.scenario else ""
    print_paragraph(f"{found.system}{scenario}, {found.rule} (* as it is)")
    print()
    print_table(("variation", "point", "value", "verdict"), found.rows(), right=("value",))
    print()
    print_fields([(each.name, found.summary(each)) for each in found.series])
    if files:
        print()
        print_paragraph(f"in {folder}: {', '.join(files)}")
