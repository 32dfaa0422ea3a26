"""`evcosim check`: the fit of an FMU in the place of a system's unit, and its behavior there."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import completion
from .options import ScenarioOption, StrictOption

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...cosim.interface import UnitInterface
    from ...cosim.swap.matching import Match
    from ...cosim.swap.swap_file import SwapFile
    from ...cosim.system.scenario import Scenario
    from ...cosim.system.system import System, UnitEntry
    from ..fmi.fmu import Fmu
    from ..studies.trial.probes import Finding
    from ..studies.trial.trial import Trial


def check(
    file: Annotated[str, typer.Argument(metavar="FILE", help="An FMU, or a swap file that maps one.")],
    place: Annotated[
        str,
        typer.Option(
            "--as",
            metavar="SYSTEM.UNIT",
            help="Whose place it would take.",
            autocompletion=completion.places,
        ),
    ],
    scenario: ScenarioOption = None,
    trial: Annotated[
        str | None,
        typer.Option(
            "--try", metavar="T", help="Run it too, for a time such as 5s, beside the present unit."
        ),
    ] = None,
    write: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a swap file, ready to edit.")
    ] = None,
    likeness: Annotated[
        float,
        typer.Option(metavar="X", min=0.0, max=1.0, help="Write guesses of a lower likeness as comments."),
    ] = 0.45,
    strict: StrictOption = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> int:
    """Show whether an FMU fits in the place of a unit.

    Exit code 0: it fits, and the trial found no problem; 1: something is missing, to choose or a problem;
    2: it cannot be checked at all.
    """
    from ...cosim.swap.matching import fits
    from .arguments import seconds
    from .console import print_json

    duration = None if trial is None else seconds("--try", trial)
    if write is not None:
        _check_new(write, file)
    checked = _checked(file, place, scenario, strict)
    if not as_json:
        _show_matches(place, checked.matches)
        _show_sampled(checked)
        _show_warnings(checked)
    tried = None if duration is None else _tried(checked, duration)
    if tried is not None and not as_json:
        _show_trial(tried)
    if write is not None:
        _write(checked, write, tried, likeness)
    complete = fits(checked.matches)
    if as_json:
        print_json(_as_data(checked, complete, tried))
    else:
        _conclude(complete, checked, file, scenario, write, tried, likeness)
    return 0 if complete and (tried is None or tried.passed) else 1


@dataclasses.dataclass(frozen=True)
class _Checked:
    """An FMU (by itself, or with a swap file) that was read, and a match for each need of the system."""

    place: str
    system: System
    scenario: Scenario
    unit: str
    fmu: Path
    entry: SwapFile | None
    matches: list[Match]
    sampled: list[str]
    """The outputs that the FMU, which does not tell, has sampled since those of the place are."""
    warnings: list[str]
    """Sentences on defects of the FMU, and on declarations that the steps of the place do not respect."""


def _checked(file: str, place: str, scenario: str | None, strict: bool) -> _Checked:
    from ...cosim.errors import ConfigError, nearest
    from ...cosim.swap.matching import matches
    from ...cosim.swap.requirements import requirements
    from ...cosim.swap.sampled import sampled_in
    from ...cosim.swap.swap_file import SwapFile
    from ...cosim.system.scenario import load_scenario
    from ...cosim.system.system import load_system
    from ...cosim.system.toml import read_toml
    from ..builtin import fmu_file
    from ..fmi.fmu import check_runnable, read_fmu

    name, _, unit = place.rpartition(".")
    if not name:
        raise ConfigError(f"--as {place}: it is written SYSTEM.UNIT, as in scooter.vehicle")
    system = load_system(name)
    if unit not in system.file.units:
        raise ConfigError(f"--as {place}: there is no unit '{unit}'{nearest(unit, system.file.units)}")
    driven = load_scenario(system, scenario)
    entry = read_toml(Path(file), SwapFile) if file.endswith(".toml") else None
    path = fmu_file(entry.fmu, Path(file), f"{file}: fmu") if entry else fmu_file(file)
    fmu = read_fmu(path, strict or (entry is not None and entry.strict))
    check_runnable(fmu)
    there = _there_now(system, unit)
    found = matches(requirements(system, driven, unit, there), fmu.interface, entry)
    names = [m.need for m in found if m.variable and m.verdict != "missing" and m.need in sampled_in(there)]
    silent = not fmu.interface.tells_sampled and (entry is None or entry.sampled is None)
    warnings = _warnings(fmu, entry or system.file.units[unit], system, driven, unit)
    return _Checked(place, system, driven, unit, path, entry, found, names if silent else [], warnings)


def _warnings(fmu: Fmu, entry: UnitEntry, system: System, scenario: Scenario, unit: str) -> list[str]:
    """Return what a run warns of: defects, and declarations that the FMU's steps do not respect.

    The steps are those of its entry, or of the place's.
    """
    from ..fmi.doubts import defects_of, doubts

    step_size = scenario.file.experiment.step_size or system.file.experiment.step_size
    period = entry.period or system.file.units[unit].period or step_size
    said = doubts(fmu, [period / entry.substeps], entry.tolerance)
    return [*defects_of(fmu), *(f"the FMU {doubt}" for doubt in said)]


def _there_now(system: System, unit: str) -> UnitInterface:
    """Return the interface of the system's present unit. Raises ConfigError if it cannot be read."""
    from ...cosim.errors import ConfigError
    from ...cosim.swap.mapping import present
    from ...cosim.swap.sampled import told
    from ..builtin import fmu_file
    from ..fmi.fmu import read_fmu

    entry, keys = system.file.units[unit], system.keys_of(unit)
    try:
        interface = read_fmu(fmu_file(entry.fmu, system.path)).interface
    except ConfigError as error:
        raise ConfigError(
            f"{keys}fmu = '{entry.fmu}' cannot be read, so that the interface of this unit, which its "
            "place needs, is unknown:",
            *error.lines,
            "put an FMU there that can be read, or a built-in one",
        ) from error
    interface = present(interface, entry, keys)
    return interface if entry.sampled is None else told(interface, unit, entry.sampled, keys)


def _tried(checked: _Checked, duration: float) -> Trial:
    from ...cosim.swap.swap_file import entry_of
    from ..studies.trial.trial import try_unit

    entry = entry_of(str(checked.fmu.resolve()), checked.matches, checked.entry)
    if checked.sampled and entry.sampled is None:
        entry = entry.model_copy(update={"sampled": checked.sampled})
    names = [match.need for match in checked.matches if match.need and match.role != "parameter"]
    return try_unit(checked.system, checked.scenario, checked.unit, entry, names, duration)


def _check_new(path: Path, checked: str) -> None:
    """Raise ConfigError where a file is there that somebody may have edited, other than the one checked, or
    none can be written."""
    from ...cosim.errors import ConfigError
    from ...cosim.reading import is_file
    from ...cosim.writing import check_writable

    check_writable(path)
    if path.is_file() and not (is_file(Path(checked)) and path.samefile(checked)):
        raise ConfigError(
            f"--write {path}: the file is there, and what was edited in it would be lost; remove it, name "
            f"another one, or check what it says: evcosim check {path}"
        )


def _write(checked: _Checked, path: Path, tried: Trial | None, likeness: float) -> None:
    from ...cosim.swap.swap_file import write

    proposal = tried.proposal if tried else None
    place = f"{checked.system.file.name}.{checked.unit}"  # --as may name the file
    write(path, str(checked.fmu), place, checked.matches, checked.entry, proposal, likeness)


def _as_data(checked: _Checked, complete: bool, tried: Trial | None) -> dict[str, object]:
    data: dict[str, object] = {
        "fmu": str(checked.fmu),
        "place": checked.place,
        "fits": complete,
        "sampled": checked.sampled,
        "warnings": checked.warnings,
        "rows": list(map(dataclasses.asdict, checked.matches)),
    }
    if tried is not None:
        proposal = tried.proposal
        data["trial"] = {
            "duration": tried.duration,
            "passed": tried.passed,
            "findings": list(map(dataclasses.asdict, tried.findings)),
            "proposed": {"substeps": proposal.substeps, "invert": [".".join(n) for n in proposal.invert]},
        }
    return data


def _show_matches(place: str, matches: Sequence[Match]) -> None:
    from .console import print_table

    table = [(m.need or "-", m.role, m.variable or "-", m.verdict, _reason(m)) for m in matches]
    print_table((place, "role", "variable of the FMU", "verdict", "why"), table)
    print()


def _show_sampled(checked: _Checked) -> None:
    """Print which outputs are taken as sampled, since those of the place are."""
    from .console import print_paragraph

    if checked.sampled:
        print_paragraph(
            f"taken as sampled, as in {checked.place}: {', '.join(checked.sampled)}; they hold from the time "
            "of the inputs on, and `sampled = false` in a swap file says otherwise"
        )
        print()


def _show_warnings(checked: _Checked) -> None:
    from .console import print_paragraph

    for warning in checked.warnings:
        print_paragraph(f"warning: {warning}")
    if checked.warnings:
        print()


def _reason(match: Match) -> str:
    open_ = match.verdict in ("your choice", "missing") and match.others
    others = f"; others: {', '.join(match.others)}" if open_ else ""
    return f"{match.reason}{others}" + (f" ({'; '.join(match.needed)})" if match.needed else "")


def _show_trial(tried: Trial) -> None:
    from .console import print_table

    findings = [(f.what, f.verdict, f.text) for f in tried.findings]
    print_table((f"trial of {tried.duration:g} s", "verdict", "what was seen"), findings)
    print()


def _conclude(
    complete: bool,
    checked: _Checked,
    file: str,
    scenario: str | None,
    write: Path | None,
    tried: Trial | None,
    likeness: float,
) -> None:
    from ...cosim.errors import counted
    from ...cosim.swap.swap_file import open_names

    counts: dict[str, int] = {}
    for match in checked.matches:
        counts[match.verdict] = counts.get(match.verdict, 0) + 1
    left = sum(counts.get(verdict, 0) for verdict in ("your choice", "missing"))
    problems = [f for f in tried.findings if f.verdict == "problem"] if tried else []
    remaining = [f"{counted(left, 'row')} to decide"] if left else []
    remaining += [counted(len(problems), "problem")] if problems else []
    system, _, unit = checked.place.rpartition(".")
    in_it = f" --scenario {scenario}" if scenario else ""
    print(", ".join(f"{n} {verdict}" for verdict, n in counts.items()))
    # not wrapped: the commands can be copied
    conclusion = " and ".join(remaining) or "it fits"
    if write is not None:
        left_open = open_names(checked.matches, likeness)
        allowed = (" --allow-open" if left_open else "") + _trust(checked, write)
        run = f"evcosim run {system}{in_it} --swap {unit}={write}{allowed}"
        if not remaining:
            print(f"{conclusion}; written: {write}; then: {run}")
            return
        print(f"{conclusion}; written: {write}")
        to_do = _to_do(checked, write, left_open, problems)
        print("\n".join(f"{'' if i else 'first':5}  {line}" for i, line in enumerate(to_do)))
        tried_again = f" --try {tried.duration:g}s" if tried else ""
        print(f"then   evcosim check {write} --as {checked.place}{in_it}{tried_again}\n       {run}")
    elif problems and file.endswith(".toml"):
        again = f"evcosim check {file} --as {checked.place}{in_it} --try {tried.duration:g}s" if tried else ""
        print(f"{conclusion}: {again} --write {file} writes what the trial proposes")
    elif complete and file.endswith(".toml"):
        run = f"evcosim run {system}{in_it} --swap {unit}={file}"
        print(f"{conclusion}: {run}{_trust(checked, Path(file))}")
    else:
        again = f"evcosim check {file} --as {checked.place}{in_it} --write swap.toml"
        print(f"{conclusion}: {again} writes the mapping")


def _to_do(checked: _Checked, swap: Path, left_open: list[str], problems: Sequence[Finding]) -> list[str]:
    """Return a sentence on each kind of thing to solve before a run with a swap file that was written."""
    missing = [m.need or m.variable or "" for m in checked.matches if m.verdict == "missing"]
    chosen = [m.need or "" for m in checked.matches if m.verdict == "your choice" and m.need not in left_open]
    found = [finding.what for finding in problems]
    return [
        text + ", ".join(names)
        for names, text in (
            (missing, f"map what {swap} leaves out as absent, or run without it: "),
            (left_open, f"choose in {swap}, where each guess stands as a comment: "),
            (chosen, f"look in {swap} whether the choice is right: "),
            (found, f"solve what the trial found, for which {swap} has what it proposes: "),
        )
        if names
    ]


def _trust(checked: _Checked, swap: Path) -> str:
    """Return the option without which a swap file cannot put this FMU into evcosim's process."""
    from ..fmi.fmu import read_fmu
    from ..isolation.decision import needs_trust

    if checked.entry is None or checked.entry.isolation != "none":
        return ""
    return " --trust" if needs_trust(read_fmu(checked.fmu), checked.entry, swap) else ""
