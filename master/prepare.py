"""Preparing a run: from its arguments to checked system, scenario, FMUs and plan, without any instance."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Unpack

from ..cosim.can.bus_settings import BusVariation
from ..cosim.can.framing import checksum_sources
from ..cosim.errors import ConfigError, nearest
from ..cosim.figures.check import check_specs
from ..cosim.interface import UnitInterface
from ..cosim.plan.needed import check_needed
from ..cosim.plan.plan import Plan
from ..cosim.plan.resolve import participating, resolve, step_size_of
from ..cosim.plan.steps import steps_in
from ..cosim.plan.turns import TurnTimes
from ..cosim.results.repeat import command_of, given_options
from ..cosim.swap.mapping import present, without_absent, without_open, without_untaken
from ..cosim.swap.requirements import lacking
from ..cosim.swap.sampled import discrete_in, inherited, sampled_in, told, unknown, untold
from ..cosim.swap.swap_file import swapped
from ..cosim.system.outside import read_outside
from ..cosim.system.run_options import RunOptions, check_options, in_floats
from ..cosim.system.scenario import Scenario, load_scenario, scenario_names
from ..cosim.system.selection import recorded_alone, without_undrawn
from ..cosim.system.system import System, load_system
from ..cosim.system.toml import data_file, is_built_in
from ..cosim.system.variation import varied
from .builtin import builtin_names, cache_folder, fmu_file, outdated
from .engine.initialization import ordered_links
from .fmi.doubts import doubts
from .fmi.fmu import Fmu, check_runnable, read_fmu, reading_once
from .isolation.decision import check_trusted
from .single_fmu import check_alone, names_fmu, one_fmu


@dataclasses.dataclass(frozen=True)
class Prepared:
    """A run that is ready to be loaded: everything that can be checked without an instance was checked.

    `outside` are sentences about the files that are read from elsewhere than the folder of who names them;
    `options` are those that the run was given, and `command` repeats it ("": none can). `digest` and `files`
    are of the files as they were read: in the run somebody may remove them.
    """

    system: System
    scenario: Scenario
    fmus: dict[str, Fmu]
    plan: Plan
    outside: tuple[str, ...] = ()
    options: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    command: str = ""
    digest: str = ""
    files: Mapping[str, str] = dataclasses.field(default_factory=dict)


@reading_once()
def prepare(
    system: str | Path | System,
    scenario: str | Path | Scenario | None = None,
    *,
    runnable: bool = True,
    **options: Unpack[RunOptions],
) -> Prepared:
    """Read and check everything that a run needs; the arguments are those of `Simulation`.

    Without `runnable` an FMU that cannot run on this machine is accepted too, to be shown only.
    Raises ConfigError naming place, rule and values; TypeError for an unknown option.
    """
    check_options(options)
    options = in_floats(options)
    given = given_options(options)
    swaps, fmus = options.get("swaps") or {}, options.get("fmus") or {}
    _check_one_fmu(swaps, fmus)
    # the files: system and scenario, with varied buses and swapped units, without absent variables
    read, driven, options = _files(system, scenario, options)
    original = read
    read, opened = without_open(swapped(read, swaps), options.get("allow_open", False))
    read, driven, left_out = without_absent(read, driven)
    # the FMUs, and the interfaces that they present to the system
    loaded = _read_fmus(read, driven, options, runnable)
    if runnable:
        check_trusted(read, loaded, options.get("isolation"), options.get("trust", False))
    interfaces, sampling = {}, []
    for unit, fmu in loaded.items():
        interface = present(fmu.interface, read.file.units[unit], read.keys_of(unit))
        interfaces[unit], said = _sampled(read, original, unit, interface, unit in fmus)
        sampling += said
    for unit, interface in interfaces.items():
        _check_absent(read, unit, interface)
    for unit, path in swaps.items():
        if unit in interfaces:
            _check_complete(read, driven, unit, interfaces[unit], path)
    # optional connections that an FMU has no variable for
    read, untaken = without_untaken(read, interfaces)
    # the plan, and the figures and metrics that name its columns
    plan = _advised(read, driven, interfaces, options)
    check_needed(original, plan, driven, {*fmus, *read.swaps})
    said_before = (*_outdated(loaded), *left_out, *_undriven(plan, opened), *untaken, *sampling)
    warnings = (*said_before, *_doubts(plan, loaded, read), *plan.warnings)
    plan = dataclasses.replace(plan, warnings=warnings)
    names = {v.name for v in (*plan.columns, *plan.text_columns)}
    unmeasured: tuple[str, ...] = ()
    if options.get("record"):
        read, driven, unmeasured = recorded_alone(read, driven, names)
    read, driven, undrawn = without_undrawn(read, driven, names)
    unchecked = check_specs(read, driven, (*plan.columns, *plan.text_columns))
    plan = dataclasses.replace(plan, warnings=(*plan.warnings, *unmeasured, *undrawn, *unchecked))
    ordered_links(plan)  # refuses an algebraic loop
    named = {
        unit: fmu.path for unit, fmu in loaded.items() if unit not in fmus and not _is_a_name(read, unit)
    }
    texts = ["" if isinstance(each, System | Scenario) else str(each or "") for each in (system, scenario)]
    command = "" if isinstance(scenario, Scenario) else command_of(texts[0], texts[1], given)
    outside, digest = read_outside(read, driven, named), _digest(read, driven, given)
    return Prepared(read, driven, loaded, plan, outside, given, command, digest, _own_files(read, driven))


_NO_SETTINGS = {"title", "source", "figure", "metrics", "identification", "budget"}


def _digest(system: System, scenario: Scenario, options: Mapping[str, Any]) -> str:
    """Return SHA-256 of what the files say that counts for the numbers of a run, with the files they name."""
    named: list[tuple[str, Path | None, str]] = []
    named += [(entry.dbc, system.path, "dbc") for entry in system.file.buses.values()]
    named += [(s.csv, scenario.path, "csv") for _, s in scenario.file.stimuli if s.csv is not None]
    named += [(log.can_log, scenario.path, "can_log") for _, log in scenario.file.can_logs]
    digest = hashlib.sha256()
    for model in (system.file, scenario.file):
        digest.update(model.model_dump_json(exclude=_NO_SETTINGS).encode())
    digest.update(repr(options.get("record")).encode() if "record" in options else b"")
    for name, beside, key in named:
        path = data_file(name, beside, key) if beside is not None else Path(name)
        with path.open("rb") as file:  # a CAN log may be large
            digest.update(hashlib.file_digest(file, "sha256").digest())
    for source in checksum_sources(system.file.buses.values(), str(system.path.parent)):
        digest.update(hashlib.sha256(source).digest())
    return digest.hexdigest()


def _own_files(system: System, scenario: Scenario) -> dict[str, str]:
    """Return the paths of the user's own files; the names of built-in ones say enough."""
    paths = {"system": system.path, "scenario": scenario.path}
    return {
        kind: str(path.resolve())
        for kind, path in paths.items()
        if path is not None and not is_built_in(path)
    }


def _is_a_name(system: System, unit: str) -> bool:
    """Return True for a unit whose FMU is built in, and named so."""
    return system.file.units[unit].fmu in builtin_names()


def _outdated(fmus: Mapping[str, Fmu]) -> list[str]:
    """Return a sentence for each FMU of the user's own whose model was changed since it was built."""
    cache = cache_folder().resolve()  # what is in it, is of the sources that there are
    made = [fmu for fmu in fmus.values() if fmu.holds_python or fmu.c_sources]
    own = [fmu for fmu in made if not fmu.path.resolve().is_relative_to(cache)]
    return list(dict.fromkeys(said for fmu in own if (said := outdated(fmu.path, fmu.digest))))


def _doubts(plan: Plan, fmus: Mapping[str, Fmu], system: System) -> list[str]:
    """Return a sentence for each declaration of an FMU that the steps of this run do not respect."""
    found = []
    for unit in plan.units:
        times = TurnTimes(plan.clock, unit.every, unit.substeps, unit.first)
        sizes = [times.size] if times.last is None else [times.size, times.last.size]
        tolerance = system.file.units[unit.name].tolerance
        found += [f"unit '{unit.name}' {doubt}" for doubt in doubts(fmus[unit.name], sizes, tolerance)]
    return found


def _sampled(
    system: System, original: System, unit: str, interface: UnitInterface, put_in: bool
) -> tuple[UnitInterface, list[str]]:
    """Return the interface with its sampled outputs, and sentences about them.

    They are what the unit's key says, what the FMU tells, or those of the place in the `original` system that
    a swap file, or an FMU that is `put_in`, takes.
    """
    wanted = system.file.units[unit].sampled
    if wanted is not None and not put_in:
        return told(interface, unit, wanted, system.keys_of(unit)), []
    if (put_in or unit in system.swaps) and not interface.tells_sampled:
        names = _sampled_in_place(original, unit, interface)
        return (interface, unknown(unit, interface)) if names is None else inherited(interface, unit, names)
    return interface, untold(unit, interface)


def _sampled_in_place(system: System, unit: str, taking: UnitInterface) -> Collection[str] | None:
    """Return the sampled outputs of the unit whose place another FMU is `taking`; None for unknown ones."""
    entry, keys = system.file.units[unit], system.keys_of(unit)
    try:
        interface = present(read_fmu(fmu_file(entry.fmu, system.path)).interface, entry, keys)
    except ConfigError:  # the place of an FMU that is not there is taken by another one
        if isinstance(entry.sampled, bool):
            return discrete_in(taking) if entry.sampled else ()
        return entry.sampled
    return sampled_in(interface if entry.sampled is None else told(interface, unit, entry.sampled, keys))


def _undriven(plan: Plan, opened: Sequence[str]) -> list[str]:
    """Return a sentence on the inputs that nothing drives, for each of the units with `open` names."""
    said = []
    for unit in opened:
        names = [n for n, p in plan.inputs.items() if n.startswith(f"{unit}.") and not p.driver]
        if names:
            said.append(f"open: nothing drives {', '.join(names)}, which keep their start values")
    return said


def _check_one_fmu(swaps: Mapping[str, str | Path], fmus: Mapping[str, str | Path]) -> None:
    """Raise ConfigError for a unit that is given an FMU in both ways."""
    for unit in swaps:
        if unit in fmus:
            raise ConfigError(
                f"--swap {unit}={swaps[unit]} (swaps) and --fmu {unit}={fmus[unit]} (fmus) both put an FMU "
                f"in the place of unit '{unit}': give one of them"
            )


def _files(
    system: str | Path | System, scenario: str | Path | Scenario | None, options: RunOptions
) -> tuple[System, Scenario, RunOptions]:
    """Read system and scenario, unless they were made in memory, and vary the buses as `bus` says.

    An FMU is a system of itself, for which some options are used up.
    """
    if names_fmu(system):
        return one_fmu(str(system), scenario, options)
    check_alone(options)
    read = system if isinstance(system, System) else load_system(str(system))
    if isinstance(scenario, Scenario):
        driven = scenario
    else:
        driven = load_scenario(read, None if scenario is None else str(scenario))
    bus, delay = options.get("bus"), options.get("delay")
    for name, value in (("bus", bus), ("delay", delay)):
        if value and options.get("ideal", False):
            raise ConfigError(f"'ideal' leaves the buses out, so that '{name}' has none to vary")
    if delay and not read.file.buses:
        raise ConfigError(f"delay = {delay:g} s: {read.path} has no bus")
    step_size = step_size_of(read, driven, options)
    if bus is not None:
        read = varied(read, bus, step_size)
    if delay:
        read = varied(read, BusVariation(delay_steps=steps_in(delay, step_size, "delay")), step_size)
    return read, driven, options


def _check_absent(system: System, unit: str, interface: UnitInterface) -> None:
    """Raise ConfigError for a variable that the system file declares absent and the FMU has."""
    for name in system.file.units[unit].absent:
        if name in interface.variables:
            raise ConfigError(f"{system.keys_of(unit)}absent: {interface.place} has '{name}'")


def _check_complete(
    system: System, scenario: Scenario, unit: str, interface: UnitInterface, path: str | Path
) -> None:
    """Raise ConfigError that names every variable that a swapped unit lacks."""
    if missing := lacking(system, scenario, unit, interface):
        first, *lines = (f"unit '{unit}' has no variable {name}" for name in missing)
        advice = f"map them, or declare them absent; {_advice(system, scenario, unit, path)}"
        raise ConfigError(f"{path}: {first}", *lines, advice)


def _advice(system: System, scenario: Scenario, unit: str, path: str | Path) -> str:
    """Return the command that checks a swap file against the place of the unit in a scenario."""
    name = system.file.name if is_built_in(system.path) else system.path
    known = scenario.name != system.file.scenario and scenario.name in scenario_names(system)
    in_it = f" --scenario {scenario.name}" if known else ""
    return f"'evcosim check {path} --as {name}.{unit}{in_it}' shows what the system needs and what fits"


_OF_STEPS = ("communication step {} s", " steps of {:g} s with ")
"""Texts in the messages of `steps_in` and `check_kept`, which name a stop time where the step is wrong."""


def _advised(
    system: System,
    scenario: Scenario,
    interfaces: Mapping[str, UnitInterface],
    options: RunOptions,
) -> Plan:
    """Return the plan; add to an error, if FMUs are put in, the command that shows everything missing."""
    swaps, fmus = options.get("swaps") or {}, options.get("fmus") or {}
    try:
        return resolve(system, scenario, interfaces, options)
    except ConfigError as error:
        step = options.get("step_size")
        files = step_size_of(system, scenario, {})  # of an FMU by itself it is the option's
        if step is not None and any(said.format(float(step)) in str(error) for said in _OF_STEPS):
            instead = f", where the files have {files:g} s" if step != files else ""
            raise ConfigError(f"step_size = {step:g} s{instead}: {error}") from error
        if swaps:
            unit, path = next(iter(swaps.items()))
            raise ConfigError(*error.lines, _advice(system, scenario, unit, path)) from error
        for unit, path in fmus.items():
            if lacking(system, scenario, unit, interfaces[unit]):
                raise ConfigError(
                    *error.lines,
                    f"{_advice(system, scenario, unit, path)}; with --write it makes a swap file for an FMU "
                    f"with other names: --swap {unit}=FILE, or in Python `swaps`",
                ) from error
        raise


def _read_fmus(system: System, scenario: Scenario, options: RunOptions, runnable: bool) -> dict[str, Fmu]:
    """Read the FMUs of the units that take part, those of the option `fmus` in place of the system's."""
    entries, fmus = participating(system, scenario), options.get("fmus") or {}
    strict, units = options.get("strict", False), options.get("units")
    for unit in fmus:
        if unit not in entries:
            raise ConfigError(
                f"fmus: there is no unit '{unit}'{nearest(unit, entries)}: {', '.join(entries)}"
            )
    read = {}
    for unit, entry in entries.items():
        if unit in fmus:
            path = fmu_file(str(fmus[unit]), place=f"fmus.{unit}", units=units)
        else:
            path = fmu_file(entry.fmu, system.path, f"{system.keys_of(unit)}fmu", units)
        read[unit] = read_fmu(path, strict or entry.strict).using(entry.interface)
        if runnable:
            check_runnable(read[unit])
    return read


def check_frames(system: System) -> None:
    """Raise ConfigError for a bus whose values are not quantized."""
    for name, entry in system.file.buses.items():
        if entry.resolution == "ideal":
            raise ConfigError(
                f'{system.path}: buses.{name}.resolution = "ideal": values that are not quantized make no '
                "frames that could be kept"
            )


def check_decodable(system: System) -> None:
    """Raise ConfigError for a bus whose frames, in a log, would not mean what its database says."""
    for name, entry in system.file.buses.items():
        if entry.resolution not in (1.0, "ideal"):
            raise ConfigError(
                f"{system.path}: buses.{name}.resolution = {entry.resolution:g}: its raw values count "
                "coarser steps than those of the database, by which whoever reads a CAN log decodes it: no "
                "log is written with this setting; change the scale in the DBC instead"
            )
