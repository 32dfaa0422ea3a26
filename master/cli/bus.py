"""`evcosim bus`: load and latencies of a system's buses, in a run and at most."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .options import ALONE, ScenarioOption, SystemArgument, takes_run_options

if TYPE_CHECKING:
    from ...cosim.analysis.bus_times import BusTimes
    from ...cosim.system.run_options import RunOptions

_DATA = "bus.json"


@takes_run_options("ideal", "record", *ALONE)
def bus(
    system: SystemArgument,
    scenario: ScenarioOption = None,
    *,
    options: RunOptions,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Default: results/<system>-<scenario>-bus."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> int:
    """Show who waits how long on the buses.

    Runs the system with frames that take time (timing = "frame"), and shows of each message its load, the
    times from sampling to the end of its frames, and the bound of the response-time analysis. Writes bus.json
    and a figure for each bus, with a busy period.
    """
    from ...cosim.results.repeat import given_options
    from ..studies.bus_times import bus_times
    from .console import print_json, progress_bar
    from .studies import ended, names_of, study_folder, written

    names = names_of(system, scenario)
    kept = {"system": system, "scenario": scenario, "options": given_options(options)}
    folder, remarks = study_folder(output, (*names, "bus"), _DATA, kept)
    with progress_bar(f"{system} bus", 0.0, 1.0, not as_json) as show:
        found = bus_times(system, scenario, progress=lambda done, stop: show(done / stop), **options)
    title = " ".join(name for name in names if name)
    files, unwritten = written(_write(folder, found, title, kept))
    if as_json:
        print_json({"buses": [each.as_data() for each in found], "folder": str(folder), "files": files})
    else:
        _show(found, folder, [] if unwritten else files)
    return ended(folder, files, unwritten, remarks)


def _write(folder: Path, found: list[BusTimes], title: str, settings: dict[str, Any]) -> Iterator[str]:
    """Write data and figures and yield the names of the files. Raises ConfigError."""
    from ...cosim.figures import draw as figures
    from ...cosim.figures.bus_times import draw_bus_times
    from ...cosim.visible import visible_json
    from ...cosim.writing import write_text
    from .studies import with_settings

    data = with_settings({"buses": [each.as_data() for each in found]}, settings)
    write_text(folder / _DATA, visible_json(json.dumps(data, indent=2, ensure_ascii=False)) + "\n")
    yield _DATA
    for each in found:
        figure = draw_bus_times(each, f"{title}: {each.load.bus} at {each.load.bitrate} bit/s")
        for path in figures.save(figure, folder, each.load.bus):
            yield path.name


def _show(found: list[BusTimes], folder: Path, files: Sequence[str]) -> None:
    from .console import print_paragraph, print_table

    for each in found:
        load = each.load
        bounds = f"{load.least:.1%} without stuff bits, {load.most:.1%} with all"
        print_paragraph(
            f"{load.bus} at {load.bitrate} bit/s: busy {each.counted['load']:.1%} of the time ({bounds})"
        )
        print()
        headers = each.headers()
        print_table(headers, each.rows(), right=headers[2:])
        print()
        used = ("message", "receiver", "sampled until used: least [ms]", "mean", "most")
        print_table(used, each.delay_rows(), right=used[2:])
        print()
    if files:
        print_paragraph(f"in {folder}: {', '.join(files)}")
