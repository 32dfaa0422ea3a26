"""The files that a system, a scenario or a swap file names and that stand outside of its folder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from .scenario import Scenario
from .system import System
from .toml import data_file, is_built_in


def read_outside(system: System, scenario: Scenario, fmus: Mapping[str, Path]) -> tuple[str, ...]:
    """Return a sentence for each file that is read from outside the folder of the file that names it.

    `fmus` are the files of the units' FMUs that the system or a swap file names by a path. A link counts as
    what it leads to; what evcosim brings is outside of nothing.
    """
    found = []
    for key, path, named_in in _named(system, scenario, fmus):
        if not is_built_in(path) and named_in.parent.resolve() not in path.resolve().parents:
            found.append(f"{key} reads {path}, which is not in the folder of {named_in}")
    return tuple(found)


def _named(system: System, scenario: Scenario, fmus: Mapping[str, Path]) -> Iterator[tuple[str, Path, Path]]:
    """Yield the place of each key that names a file, that file, and the file in which the key stands."""
    for unit, fmu in fmus.items():
        yield f"{system.keys_of(unit)}fmu", fmu, system.swaps.get(unit, system.path)
    for name, bus in system.file.buses.items():
        place = f"{system.path}: buses.{name}.dbc"
        yield place, data_file(bus.dbc, system.path, place), system.path
    chosen = system.file.scenario
    if scenario.path is not None and chosen is not None and scenario.path == Path(chosen):
        yield f"{system.path}: scenario", scenario.path, system.path  # its default, given by a path
    if scenario.path is not None:
        named = [
            (number, "csv", entry.csv) for number, entry in scenario.file.stimuli if entry.csv is not None
        ]
        named += [(number, "can_log", entry.can_log) for number, entry in scenario.file.can_logs]
        for number, key, name in sorted(named):
            place = f"{scenario.path}: stimulus {number}.{key}"
            yield place, data_file(name, scenario.path, place), scenario.path
