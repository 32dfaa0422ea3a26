"""The options of a run, declared once for everything that runs a system."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from numbers import Real
from pathlib import Path
from typing import Any, Literal, TypedDict, cast, get_args

import numpy as np

from ..can.bus_settings import LONGEST_DELAY, BusVariation
from ..clock import LATEST
from ..errors import ConfigError, nearest, short
from ..interface import Value
from .system import SHORTEST, Algorithm, EngineName, Isolation, UnitsName


class RunOptions(TypedDict, total=False):
    """Keyword arguments of `Simulation`, `simulate`, `budget` and `identify`; each may be left out."""

    parameters: Mapping[str, Value] | None
    """Values by "unit.variable" of parameters, initial states and inputs that nothing drives, each in the
    variable's own unit; they override the files. Of an FMU by itself by its own names."""

    start: Mapping[str, Value] | None
    """Start values by "unit.variable" of inputs that nothing drives, and of states and other variables whose
    initial value the FMU lets be given, each in the variable's own unit; they override the files. Of an FMU
    by itself by its own names."""

    inputs: Mapping[str, Value | Path] | None
    """Of an FMU by itself: what its inputs receive by name, a constant or a table "FILE.csv" with the input's
    name, or "FILE.csv:COLUMN"."""

    fmus: Mapping[str, str | Path] | None
    """Paths or built-in names of FMUs by unit; each takes the place of the one that the system names."""

    swaps: Mapping[str, str | Path] | None
    """Paths of swap files by unit: FMUs with other names, units and signs in the place of a unit."""

    allow_open: bool
    """Run although a swap file has `open` names: what needs them is left out (default: False)."""

    ideal: bool
    """Leave the buses out: unit conversion only (default: False)."""

    bus: BusVariation | None
    """Changes of all buses in this run: delay, resolution, cycle, timing, jitter and lost frames."""

    delay: float | None
    """Time [s] by which every message of every bus arrives later than the files say, a multiple of the
    communication step."""

    algorithm: Algorithm | None
    """The order of steps, "gauss_seidel" or "jacobi" (default: the system's)."""

    stop_time: float | None
    """The time [s] at which the run ends (default: the scenario's, else the system's)."""

    step_size: float | None
    """The communication step [s] (default: the scenario's, else the system's; of an FMU by itself that of its
    default experiment)."""

    record: Sequence[str] | None
    """Patterns of the variables to record, in place of the files', as ["vehicle.*", "!vehicle.power"]; figure
    and metrics go without what they need beside (default: the scenario's, else the system's)."""

    interface: Literal["co_simulation", "model_exchange"] | None
    """Of an FMU by itself that has both: "co_simulation" (the default) or "model_exchange"."""

    tolerance: float | None
    """Of an FMU by itself: the relative tolerance of its solver (default: as it declares)."""

    isolation: Isolation | None
    """Run every unit in a process of its own ("process"), or none ("none"; default: the system's)."""

    trust: bool
    """Let a file of yours put FMUs that evcosim did not build into this process by `isolation = "none"`
    (default: False)."""

    engine: EngineName | None
    """The engine, "compiled" (needs numba) or "python", equal bit for bit (default: the system's)."""

    units: UnitsName | None
    """The kind of the FMUs that evcosim builds: "python" (pythonfmu FMUs), "native" (compiled), equal bit for
    bit, or "auto", native where a model can be and a comparison on this machine has found no difference
    (default: "python"; of what runs many times "auto")."""

    strict: bool
    """Refuse every FMU whose description has defects, even if they could be mended (default: False)."""


def check_options(options: Mapping[str, Any]) -> None:
    """Raise TypeError with the nearest option for a name that is not in RunOptions.

    Raises ConfigError for a value of another type, which would otherwise pass for another option.
    """
    known = RunOptions.__optional_keys__
    for name in options:
        if name not in known:
            raise TypeError(
                f"a run has no option '{name}'{nearest(name, known)}; there are: {', '.join(sorted(known))}"
            )
        if (value := options[name]) is not None and name in _RULES and not _RULES[name][0](value):
            raise ConfigError(f"{name} = {short(value)}: {_RULES[name][1]}")


def in_floats(options: RunOptions) -> RunOptions:
    """Return options whose numbers of other types than Python's own, as a Fraction, are floats.

    A Decimal, a number of numpy and an array of no dimension are such numbers too.
    """
    given = {name: options.get(name) for name in ("delay", "stop_time", "step_size", "tolerance")}
    numbers = {
        name: float(cast(float, value))
        for name, value in given.items()
        if _is_number(value) and not isinstance(value, int | float)
    }
    return cast(RunOptions, {**options, **numbers})


def _one_of(kind: Any) -> tuple[Callable[[Any], bool], str]:
    """Return the rule for a Literal type."""
    known = get_args(kind)
    return lambda value: isinstance(value, str) and value in known, f"must be {' or '.join(map(repr, known))}"


def _is_number(value: Any) -> bool:
    """Return True for a real number of any type, also as an array of no dimension."""
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and _is_number(value[()])
    other = bool | np.timedelta64  # which pass for integers
    return isinstance(value, Real | Decimal) and not isinstance(value, other)


def _is_time(value: Any) -> bool:
    if not _is_number(value):
        return False
    try:
        seconds = float(value)
    except (OverflowError, ValueError):  # an integer beyond all doubles, a signaling NaN of a Decimal
        return False
    return abs(seconds) <= LATEST or not math.isfinite(seconds)  # which is refused with its place


def _is_positive(value: Any) -> bool:
    return _is_time(value) and SHORTEST <= float(value) <= LATEST


def _is_delay(value: Any) -> bool:
    return _is_time(value) and 0.0 <= float(value) <= LONGEST_DELAY


def _are_patterns(value: Any) -> bool:
    return isinstance(value, list | tuple) and bool(value) and all(isinstance(e, str) and e for e in value)


def _is_share(value: Any) -> bool:
    return _is_time(value) and 0.0 < float(value) < 1.0


_FLAG = (lambda value: isinstance(value, bool), "must be True or False")
_BY_NAME = (lambda value: isinstance(value, Mapping), "must be a mapping of names")
_RULES: dict[str, tuple[Callable[[Any], bool], str]] = {
    "parameters": _BY_NAME,
    "start": _BY_NAME,
    "inputs": _BY_NAME,
    "fmus": _BY_NAME,
    "swaps": _BY_NAME,
    "allow_open": _FLAG,
    "ideal": _FLAG,
    "bus": (lambda value: isinstance(value, BusVariation), "must be a BusVariation"),
    "delay": (_is_delay, f"must be a number of seconds from 0 to {LONGEST_DELAY:g}"),
    "algorithm": _one_of(Algorithm),
    "stop_time": (_is_time, f"must be a number of seconds, up to {LATEST:g}"),
    "step_size": (_is_positive, f"must be a number of seconds above 0, {SHORTEST:g} to {LATEST:g}"),
    "record": (_are_patterns, "must be a list of patterns of variables, one at least"),
    "interface": _one_of(Literal["co_simulation", "model_exchange"]),
    "tolerance": (_is_share, "must be a number between 0 and 1"),
    "isolation": _one_of(Isolation),
    "trust": _FLAG,
    "engine": _one_of(EngineName),
    "units": _one_of(UnitsName),
    "strict": _FLAG,
}
