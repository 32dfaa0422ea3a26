"""The options of a run, declared once for everything that runs a system."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TypedDict

from ..can.bus_settings import BusVariation
from ..errors import nearest
from ..interface import Value
from .system import Algorithm, EngineName, Isolation


class RunOptions(TypedDict, total=False):
    """Keyword arguments of `Simulation`, `simulate`, `budget` and `identify`; each may be left out."""

    parameters: Mapping[str, Value] | None
    """Values of parameters by "unit.parameter", each in the parameter's own unit; they override the files."""

    fmus: Mapping[str, str | Path] | None
    """Paths or built-in names of FMUs by unit; each takes the place of the one that the system names."""

    swaps: Mapping[str, str | Path] | None
    """Paths of swap files by unit: FMUs with other names, units and signs in the place of a unit."""

    ideal: bool
    """Leave the buses out: unit conversion only (default: False)."""

    bus: BusVariation | None
    """Delay, resolution and cycle of all buses in this run."""

    algorithm: Algorithm | None
    """The order of steps, "gauss_seidel" or "jacobi" (default: the system's)."""

    stop_time: float | None
    """The time [s] at which the run ends (default: the scenario's, else the system's)."""

    isolation: Isolation | None
    """Run every unit in a process of its own ("process"), or none ("none"; default: the system's)."""

    engine: EngineName | None
    """The engine, "compiled" (needs numba) or "python", equal bit for bit (default: the system's)."""

    strict: bool
    """Refuse every FMU whose description has defects, even if they could be mended (default: False)."""


def check_names(options: Iterable[str]) -> None:
    """Raise TypeError with the nearest option for a name that is not in RunOptions."""
    known = RunOptions.__optional_keys__
    for name in options:
        if name not in known:
            raise TypeError(
                f"a run has no option '{name}'{nearest(name, known)}; there are: {', '.join(sorted(known))}"
            )
