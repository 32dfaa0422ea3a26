"""`evcosim plot`: the figure of results, drawn again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ...cosim.results.results import Results
    from ...cosim.system.figure_spec import FigureSpec


def plot(
    result: Annotated[Path, typer.Argument(metavar="RESULT", help="Results folder or CSV file.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Where to: .png, .svg, .pdf, or .html for a page; default: beside the results.",
        ),
    ] = None,
    signals: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PATTERN", help="Only these, as in 'vehicle.*', or not: '!ecu.*'; can be given again."
        ),
    ] = None,
) -> None:
    """Draw results again, or chosen signals of them."""
    from ...cosim.figures import draw as figures
    from ...cosim.results.results import Results

    results = Results.read(result)
    warn_of_tables((result, results))
    if signals:
        results, spec = chosen(results, signals), None
    else:
        spec = spec_of(results)
    path = output or (result / "figure.png" if result.is_dir() else result.with_suffix(".png"))
    if is_page(path):
        results.report(path, spec)
    else:
        figures.write(figures.draw(results, spec), path)
    print(path)


def warn_of_tables(*tables: tuple[Path, Results]) -> None:
    """Print the warnings of results that are read from a table; those of a run its summary has."""
    from ...cosim.results.results import CSV_NAME
    from .failures import complain

    for path, results in {path.resolve(): (path, results) for path, results in reversed(tables)}.values():
        if not path.is_dir() and path.name != CSV_NAME:
            for note in results.manifest.get("warnings", ()):
                complain(f"warning: {note}")


def is_page(path: Path) -> bool:
    """Return True for the name of a file that becomes a page to zoom into, and no picture."""
    return path.suffix.lower() in (".html", ".htm")


def chosen(results: Results, patterns: list[str]) -> Results:
    """Return the results of variables that match a pattern. Raises ConfigError for one that matches none."""
    return results.part(slice(None), names_chosen((*results.names, *results.texts), patterns))


def names_chosen(names: Sequence[str], patterns: list[str]) -> list[str]:
    """Return the names that match a pattern and none behind a '!', in their order.

    Where all patterns have a '!', they leave out of all names. Raises ConfigError for one that matches none,
    and where nothing is left.
    """
    from ...cosim.errors import ConfigError, nearest
    from ...cosim.interface import fitting

    found = set(names) if all(pattern.startswith("!") for pattern in patterns) else set()
    for pattern in sorted(patterns, key=lambda p: p.startswith("!")):
        wanted = pattern.removeprefix("!")
        fits = fitting(wanted, names)
        if not fits:
            near = nearest(wanted, [*names, *(f"{name.partition('.')[0]}.*" for name in names)])
            raise ConfigError(f"--signals {pattern}: the results have no such variable{near}")
        found = found - set(fits) if pattern.startswith("!") else found | set(fits)
    if not found:
        raise ConfigError(f"--signals {' '.join(patterns)}: no variable is left")
    return [name for name in names if name in found]


def spec_of(results: Results) -> FigureSpec | None:
    """Return the figure of system and scenario that run.json names; None if it is gone or does not fit.

    Lines of variables that the results do not have are left out.
    """
    from ...cosim.errors import ConfigError
    from ...cosim.figures import draw as figures
    from ...cosim.system.scenario import load_scenario
    from ...cosim.system.selection import figure_spec
    from ...cosim.system.system import load_system

    names = [results.manifest.get(key) for key in ("system", "scenario")]
    files = results.manifest.get("files")
    files = files if isinstance(files, dict) else {}
    system_name, scenario_name = (
        files.get(k) or n for k, n in zip(("system", "scenario"), names, strict=True)
    )
    if not system_name:
        return None
    try:
        system = load_system(str(system_name))
        scenario = load_scenario(system, str(scenario_name) if scenario_name else None)
        spec = figure_spec(system, scenario)
        recorded = {v.name: v for v in results.variables}
        # as the run left lines out: of what an FMU did not have, or `record` left out
        spec = spec and spec.without(lambda name: name not in recorded)
        if spec is not None:
            figures.check(spec, recorded, "figure")
    except ConfigError:
        return None  # moved, renamed or changed since the run: the default figure shows what there is
    return spec
