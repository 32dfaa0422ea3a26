"""`evcosim check`: whether an FMU fits into the place of a system's unit, before it is run."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .options import ScenarioOption

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...cosim.fit import Row


def check(
    file: Annotated[str, typer.Argument(metavar="FILE", help="An FMU, or a swap file that maps one.")],
    place: Annotated[str, typer.Option("--as", metavar="SYSTEM.UNIT", help="Whose place it would take.")],
    scenario: ScenarioOption = None,
    write: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a swap file, ready to edit.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> int:
    """Show whether an FMU fits in the place of a unit; exit code 1 when something is missing or to choose."""
    from ...cosim.fit import fits
    from .console import print_json, print_table

    fmu, rows = _compared(file, place, scenario)
    complete = fits(rows)
    if as_json:
        print_json(
            {"fmu": fmu, "place": place, "fits": complete, "rows": list(map(dataclasses.asdict, rows))}
        )
    else:
        table = [(row.need or "-", row.role, row.variable or "-", row.verdict, _reason(row)) for row in rows]
        print_table((place, "role", "variable of the FMU", "verdict", "why"), table)
        print()
    if write is not None:
        from ...cosim.swap import written

        written(write, fmu, place, rows)
    if not as_json:
        _conclude(complete, rows, file, place, write)
    return 0 if complete else 1


def _compared(file: str, place: str, scenario: str | None) -> tuple[str, list[Row]]:
    """The FMU's path, and the rows for what the system needs from the unit."""
    from ...cosim.errors import ConfigError, nearest
    from ...cosim.files import read_toml
    from ...cosim.fit import fit
    from ...cosim.requirements import requirements
    from ...cosim.scenario import load_scenario
    from ...cosim.swap import SwapFile
    from ...cosim.system import load_system
    from ..builtin import fmu_file
    from ..fmi.fmu import check_runnable, read_fmu

    name, _, unit = place.rpartition(".")
    if not name:
        raise ConfigError(f"--as {place}: it is written SYSTEM.UNIT, as in scooter.vehicle")
    system = load_system(name)
    if unit not in system.file.units:
        raise ConfigError(f"--as {place}: there is no unit '{unit}'{nearest(unit, system.file.units)}")
    entry = read_toml(Path(file), SwapFile) if file.endswith(".toml") else None
    path = fmu_file(entry.fmu, Path(file)) if entry else fmu_file(file)
    fmu = read_fmu(path)
    check_runnable(fmu)
    present = read_fmu(fmu_file(system.file.units[unit].fmu, system.path)).interface
    needs = requirements(system, load_scenario(system, scenario), unit, present)
    return str(path), fit(needs, fmu.interface, entry)


def _reason(row: Row) -> str:
    told = row.verdict in ("your choice", "missing") and row.others
    return f"{row.reason}; others: {', '.join(row.others)}" if told else row.reason


def _conclude(complete: bool, rows: Sequence[Row], file: str, place: str, write: Path | None) -> None:
    from .console import counted

    counts: dict[str, int] = {}
    for row in rows:
        counts[row.verdict] = counts.get(row.verdict, 0) + 1
    print(", ".join(f"{n} {verdict}" for verdict, n in counts.items()))
    system, _, unit = place.rpartition(".")
    if write is not None:
        print(f"written: {write}; then: evcosim run {system} --swap {unit}={write}")
    elif complete and file.endswith(".toml"):
        print(f"it fits: evcosim run {system} --swap {unit}={file}")
    else:
        left = sum(counts.get(verdict, 0) for verdict in ("your choice", "missing"))
        said = f"{counted(left, 'row')} to decide" if left else "it fits"
        print(f"{said}: evcosim check {file} --as {place} --write swap.toml writes the mapping")
