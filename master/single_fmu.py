"""An FMU by itself: a system of one unit that records its outputs, with inputs that the caller gives.

The FMU's default experiment says the times, unless the options of the run do.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..cosim.csv_numbers import CsvFile
from ..cosim.errors import ConfigError, nearest, short
from ..cosim.interface import UnitInterface
from ..cosim.plan.steps import steps_in
from ..cosim.system.run_options import RunOptions
from ..cosim.system.scenario import Scenario, ScenarioFile
from ..cosim.system.system import System, SystemFile, system_names
from ..cosim.system.toml import validate
from .builtin import builtin_names, fmu_file
from .fmi.fmu import Fmu, declared_number, declared_step, read_fmu

UNIT = "fmu"
"""The name of the unit in the system of an FMU alone."""

ALONE = ("inputs", "interface", "tolerance")
"""The options of a run that are for an FMU by itself; a system's stand in its files."""

_OF_SYSTEMS = ("fmus", "swaps", "ideal", "bus", "delay")
_SHORTEST = 1e-9  # s
_DURATION = 1.0  # s, where the FMU declares no stop time
_STEPS = 500  # at least, where it declares no step size
_MOST_STEPS = 1_000_000  # where the step size is not the caller's
_MOST_LOCALS = 100  # that are recorded of an FMU without outputs
_VARIES = ("continuous", "discrete", "tunable")


def names_fmu(target: object) -> bool:
    """Return True if the target of a run is an FMU: a file *.fmu, or a built-in FMU by its name."""
    if not isinstance(target, str | Path):
        return False
    text = str(target)
    return text.lower().endswith(".fmu") or (text not in system_names() and text in builtin_names())


def check_alone(options: RunOptions) -> None:
    """Raise ConfigError for an option of a system's run that is for an FMU by itself."""
    for name in ALONE:
        if options.get(name):
            instead = (
                "a [[stimulus]] of a scenario drives an input of a system; where nothing does, a start value "
                "(--start, in Python `start`) is a constant"
            )
            said = instead if name == "inputs" else "what a system takes stands in its files"
            raise ConfigError(f"{name} is for an FMU by itself; {said}")


def one_fmu(target: str, scenario: object, options: RunOptions) -> tuple[System, Scenario, RunOptions]:
    """Return the system of an FMU (a path or a built-in name), what drives it, and the options that are left.

    Raises ConfigError naming option, rule and value.
    """
    if scenario is not None:
        raise ConfigError(f"{target} is an FMU, which has no scenarios: scenario {scenario}")
    for name in _OF_SYSTEMS:
        if options.get(name):
            raise ConfigError(f"{name} is for a system; {target} is an FMU by itself")
    path = fmu_file(target, units=options.get("units"))
    name = target if target in builtin_names() else path.stem
    fmu = read_fmu(path, options.get("strict", False)).using(options.get("interface"))
    said = Path(target)  # the file of a built-in FMU is in the cache, which nobody wrote
    values = _by_name(options.get("parameters") or {}, "parameter", fmu.interface, said)
    starts = _by_name(options.get("start") or {}, "start", fmu.interface, said)
    inputs = _by_name(options.get("inputs") or {}, "input", fmu.interface, said)
    unit: dict[str, object] = {"fmu": str(path.resolve()), "interface": options.get("interface")}
    data = {
        "name": identifier(name),
        "title": fmu.description.description or "",
        "experiment": _experiment(fmu, options),
        "units": {UNIT: unit | {"tolerance": options.get("tolerance")}},
        "record": _recorded(fmu.interface),
    }
    stimuli = [_stimulus(text, name, x, fmu.interface, said) for name, (text, x) in inputs.items()]
    left: Any = {name: value for name, value in options.items() if name not in ALONE}
    return (
        System(path, validate(data, SystemFile, str(path))),
        Scenario("", None, validate({"stimulus": stimuli}, ScenarioFile, "inputs")),
        left | _as_of_unit(values, starts) | {"record": _patterns(options.get("record"))},
    )


def identifier(name: str) -> str:
    """Return a file's name as a system's, with _ for what no such name has: Tank-2.1 is Tank_2_1."""
    plain = "".join(c if f"a{c}".isidentifier() else "_" for c in name)
    return plain if plain.isidentifier() else f"_{plain}"


def _known(text: str, interface: UnitInterface, place: str, path: Path) -> str:
    """Return the name of a variable, which may be written as the results have it, after `fmu.`."""
    for name in (text, text.removeprefix(f"{UNIT}.")):
        if name in interface.variables:
            return name
        if name in interface.unusable:
            raise ConfigError(f"{place}: {path}: {name} {interface.unusable[name]}")
    raise ConfigError(f"{place}: {path} has no variable '{text}'{nearest(text, interface.variables)}")


def _by_name(
    given: Mapping[str, Any], kind: str, interface: UnitInterface, path: Path
) -> dict[str, tuple[str, Any]]:
    """Return by the name of each variable how it was written, and its value.

    Raises ConfigError for a variable that is given under both its names: `gain` and `fmu.gain`.
    """
    found: dict[str, tuple[str, Any]] = {}
    for text, value in given.items():
        name = _known(text, interface, f"{kind} {text}", path)
        if name in found:
            before, earlier = found[name]
            raise ConfigError(
                f"{kind} {text}: {short(value)} is for {name}, which is given already: {before} = "
                f"{short(earlier)}"
            )
        found[name] = text, value
    return found


def _stimulus(text: str, name: str, value: object, interface: UnitInterface, path: Path) -> dict[str, Any]:
    """Return the stimulus of an input: a constant, or a column of a table FILE.csv (FILE.csv:COLUMN).

    `text` is how the input was written.
    """
    if (causality := interface.variables[name].causality) != "input":
        raise ConfigError(f"input {text}: {path}: {name} is of causality {causality}, not input")
    to = {"to": f"{UNIT}.{name}"}
    if not isinstance(value, str | Path) or ".csv" not in str(value).lower():
        return to | {"constant": value}
    csv, column = _csv(str(value))
    known = CsvFile.of(Path(csv)).named
    if not column and name in known:
        column = name
    if not column and len(known) > 2:
        raise ConfigError(
            f"input {text}: {csv} has no column '{name}': write {csv}:COLUMN; columns: {', '.join(known)}"
        )
    return to | {"csv": csv} | ({"column": column} if column else {})


def _csv(text: str) -> tuple[str, str]:
    """Return file and column ("": none is named) of FILE.csv:COLUMN."""
    end = text.lower().rindex(".csv") + len(".csv")
    return text[:end], text[end:].removeprefix(":")


def _experiment(fmu: Fmu, options: RunOptions) -> dict[str, float]:
    """Return the times [s] of a run: the options', else the FMU's default experiment, else 500 steps of 1 s.

    A step that is not the caller's is shortened until the stop time is a whole number of them, after it was
    doubled until a million are enough.
    """
    declared = fmu.description.defaultExperiment
    start = declared_number(declared, "startTime") or 0.0
    stop = options.get("stop_time")
    if stop is None:
        stop = declared_number(declared, "stopTime")
    if stop is None or (stop <= start and options.get("stop_time") is None):
        stop = start + _DURATION
    if not math.isfinite(stop):
        raise ConfigError(f"stop_time {stop} s is not finite")
    step = options.get("step_size")
    if step is None and 0.0 < stop - start < _SHORTEST:
        raise ConfigError(f"stop_time = {stop:g}: a run from {start:g} s on lasts {_SHORTEST:g} s or more")
    if step is None:
        own = declared_step(declared, "stepSize") or declared_step(fmu.kind, "fixedInternalStepSize")
        step = _whole(stop - start, own)
    return {"start_time": start, "stop_time": float(stop), "step_size": float(step)}


def _whole(duration: float, step: float | None) -> float:
    """Return the step [s], or the longest shorter one of which the duration [s] is a whole number."""
    if not 0.0 < duration < math.inf:
        return step or _DURATION / _STEPS  # the stop time is refused with its place
    if step is None or step > duration:
        decade = 10.0 ** math.floor(math.log10(duration / _STEPS))
        step = next(decade * n for n in (5.0, 2.0, 1.0) if duration / (decade * n) >= _STEPS * (1.0 - 1e-12))
    while duration / step > _MOST_STEPS:
        step *= 2.0
    try:
        steps_in(duration, step, "")
    except ConfigError:
        return duration / math.ceil(duration / step)
    return step


def _as_of_unit(
    values: Mapping[str, tuple[str, Any]], starts: Mapping[str, tuple[str, Any]]
) -> dict[str, dict[str, Any]]:
    """Return the options of the system for what the options of its FMU give, by `_by_name`."""
    return {
        option: {f"{UNIT}.{name}": value for name, (_, value) in given.items()}
        for option, given in (("parameters", values), ("start", starts))
    }


def _patterns(record: Sequence[str] | None) -> list[str] | None:
    """Return the patterns of an FMU's own names as those of its system."""
    if record is None:
        return None
    return [f"!{_prefixed(p[1:])}" if p.startswith("!") else _prefixed(p) for p in record]


def _prefixed(name: str) -> str:
    return name if name.startswith(f"{UNIT}.") else f"{UNIT}.{name}"


def _recorded(interface: UnitInterface) -> list[str]:
    """Return the patterns of what is recorded: inputs and outputs; locals of an FMU that has no outputs."""
    shown = interface.variables.values()
    if any(v.causality == "output" for v in shown):
        return ["*"]
    inner = [v.name for v in shown if v.causality == "local" and v.variability in _VARIES]
    return ["*", *(f"{UNIT}.{name}" for name in inner[:_MOST_LOCALS])]
