"""`evcosim identify`: gain and pole from any input to any output of a system or an FMU."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import completion
from .options import ALONE, QuietOption, scenario_option, takes_run_options

if TYPE_CHECKING:
    from ...cosim.analysis.first_order import Estimate
    from ...cosim.system.identification_spec import IdentificationSpec
    from ...cosim.system.run_options import RunOptions
    from ..studies.identification import Identification

DATA = "identification.json"

TargetArgument = Annotated[
    str,
    typer.Argument(
        metavar="TARGET",
        help="A system, or an FMU (built-in name, file).",
        autocompletion=completion.systems_and_fmus,
    ),
]
ScenarioOption = Annotated[str | None, scenario_option("Default: 'identification' where there is one.")]
InputOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="The input to sweep: unit.variable; of an FMU variable.")
]
OutputOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="What answers: any recorded Real variable.")
]
UnitOption = Annotated[
    str | None, typer.Option(metavar="U", help="Unit of measure of the output, as km/h; default: its own.")
]
AtOption = Annotated[
    list[float] | None, typer.Option(metavar="Y", help="Working point of the output; can be given again.")
]
AtInputOption = Annotated[
    list[float] | None, typer.Option(metavar="U", help="Working point of the input; can be given again.")
]
AmplitudeOption = Annotated[
    float | None, typer.Option(metavar="A", help="Amplitude of the sweep, in the input's unit.")
]
SweepOption = Annotated[
    str | None, typer.Option(metavar="F0,F1", help="Lowest and highest frequency [Hz]; 0.008,0.6.")
]
DurationOption = Annotated[float | None, typer.Option(metavar="T", help="Duration of the sweep [s]; 900.")]
RepeatsOption = Annotated[int | None, typer.Option(metavar="N", help="Sweep so many times; 1.")]
BandOption = Annotated[
    str | None, typer.Option(metavar="F0,F1", help="Fit in this band [Hz]; 1.5 F0 to F1/2 of the sweep.")
]
ParametersOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="[UNIT.]PARAMETER=VALUE", help="Set a parameter; can be given again."),
]
StartValuesOption = Annotated[
    list[str] | None,
    typer.Option("--start", metavar="[UNIT.]VARIABLE=VALUE", help="Set a start value; can be given again."),
]
FolderOption = Annotated[
    Path | None,
    typer.Option(
        "--output-folder", "-o", metavar="DIR", help="Default: results/<target>-<scenario>-identify."
    ),
]


@takes_run_options("settings", "starts", "stop_time", "record", *ALONE)
def identify(
    target: TargetArgument,
    scenario: ScenarioOption = None,
    input: InputOption = None,
    output: OutputOption = None,
    unit: UnitOption = None,
    at: AtOption = None,
    at_input: AtInputOption = None,
    amplitude: AmplitudeOption = None,
    sweep: SweepOption = None,
    duration: DurationOption = None,
    repeats: RepeatsOption = None,
    band: BandOption = None,
    settings: ParametersOption = None,
    starts: StartValuesOption = None,
    *,
    options: RunOptions,
    folder: FolderOption = None,
    no_plot: Annotated[bool, typer.Option("--no-plot", help="Draw no figures.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was found as JSON.")] = False,
    quiet: QuietOption = False,
) -> int:
    """Identify gain and pole from an input to an output."""
    from ...cosim.analysis.sweep import sweep_of
    from ...cosim.results.repeat import given_options
    from ..studies.identification_target import is_fmu
    from .arguments import as_typed
    from .studies import ended, study_folder, written

    given: dict[str, Any] = {
        "input": input, "output": output, "unit": unit, "at": at, "at_input": at_input,
        "amplitude": amplitude, "duration": duration, "repeats": repeats,
        "sweep": _pair(sweep, "--sweep"), "band": _pair(band, "--band"),
    }  # fmt: skip # related options side by side
    ends = {"input": input, "output": output}
    with as_typed((), names=ends):
        spec = _spec(target, scenario, {k: value for k, value in given.items() if value not in (None, [])})
    sweep_of(spec)
    if is_fmu(target):
        _check_options_of_one_fmu(target, options)
    options = _with_values(options, settings or [], starts or [], is_fmu(target))
    kept = {"target": target, "scenario": scenario, "spec": spec.model_dump(mode="json")}
    kept["options"] = given_options(options)
    named = (*_names(target, scenario), "identify")
    where, remarks = study_folder(folder, named, DATA, kept, "--output-folder")
    bar = not (as_json or quiet)
    with as_typed(settings or [], starts=starts or [], names=ends):
        found = _measure(target, spec, scenario, options, bar)
    files, unwritten = written(_write(where, found, not no_plot, kept))
    _report(found, where, files if as_json or not unwritten else [], as_json, quiet)
    return ended(where, files, unwritten, remarks)


def _with_values(
    options: RunOptions, settings: Sequence[str], starts: Sequence[str], of_fmu: bool
) -> RunOptions:
    """Return the options with the values of `--set` and `--start`. Raises ConfigError."""
    from .arguments import parse_settings

    return {
        **options,
        "parameters": parse_settings(settings, of_fmu),
        "start": parse_settings(starts, of_fmu, "--start", "speed=8"),
    }


def _names(target: str, scenario: str | None) -> tuple[str, str]:
    """Return the names of target and scenario, of which that of the folder is made."""
    from ...cosim.system.scenario import load_scenario
    from ...cosim.system.system import load_system
    from ..studies.identification_target import default_scenario, is_fmu

    if is_fmu(target):
        return Path(target).stem, ""
    system = load_system(target)
    chosen = default_scenario(system, scenario)
    return system.file.name, load_scenario(system, None if chosen is None else str(chosen)).name


def _check_options_of_one_fmu(target: str, options: RunOptions) -> None:
    """Raise ConfigError for an option that makes no sense for an FMU alone."""
    from ...cosim.errors import ConfigError

    if options.get("ideal"):
        raise ConfigError(f"--ideal: {target} is an FMU alone: there is no bus to leave out")
    if options.get("delay"):
        raise ConfigError(f"--delay: {target} is an FMU alone: there is no bus to be late")
    if options.get("algorithm"):
        raise ConfigError(f"--algorithm: {target} is an FMU alone: one unit's steps have no order")


def _pair(text: str | None, option: str) -> tuple[float, float] | None:
    from ...cosim.errors import ConfigError

    if text is None:
        return None
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        raise ConfigError(
            f"{option} {text}: it is written F0,F1, two numbers in Hz, as in 0.05,0.3"
        ) from None
    return low, high


def _spec(target: str, scenario: str | None, given: dict[str, Any]) -> IdentificationSpec:
    """Return the scenario's table with the options given in place of its values. Raises ConfigError."""
    from ...cosim.errors import ConfigError
    from ...cosim.system.identification_spec import IdentificationSpec
    from ...cosim.system.toml import validate
    from ..studies.identification import check_ends
    from ..studies.identification_target import spec_of

    base = spec_of(target, scenario)
    known = base.model_dump() if base is not None else {}
    if {"input", "output"} & given.keys() and base is not None:
        other = [k for k in ("input", "output") if given.get(k, known[k]) != known[k]]
        for key in (
            ("unit", "at", "at_input", "amplitude") if "input" in other else ("unit", "at") if other else ()
        ):
            known.pop(key)  # they belong to what the scenario sweeps or measures
    if {"at", "at_input"} & given.keys():
        known = {k: v for k, v in known.items() if k not in ("at", "at_input")}
    if "sweep" in given:
        known.pop("band", None)  # the scenario's band belongs to its own sweep
    merged = known | given
    for key in ("input", "output", "amplitude"):
        if key not in merged:
            if key == "amplitude":  # a misspelled name is said first
                check_ends(target, validate(merged | {key: 1.0}, IdentificationSpec, target), scenario)
            raise ConfigError(f"{target}: --{key} is needed: no [identification] of a scenario gives it")
    return validate(merged, IdentificationSpec, target)


def _measure(
    target: str,
    spec: IdentificationSpec,
    scenario: str | None,
    options: RunOptions,
    bar: bool,
) -> list[Identification]:
    """Identify the target at each working point of the spec, with a bar over all of them."""
    from ..studies.identification import each_working_point, identify
    from .console import progress_bar
    from .interrupts import Interrupts

    points = each_working_point(spec)
    found = []
    with Interrupts() as interrupts, progress_bar(target, 0.0, float(len(points)), bar) as show:
        for done, point in enumerate(points):

            def progress(phase: str, share: float, done: int = done) -> None:
                begin, length = _SHARES.get(phase, (0.0, 0.1))
                show(done + begin + length * share)
                interrupts.check()

            found.append(identify(target, point, scenario, progress=progress, **options))
    return found


_SHARES = {"sweep": (0.1, 0.7), "test": (0.8, 0.2)}
"""Begin and length of a phase, as shares of the time of one working point; others share the first 10 %."""


def _write(
    folder: Path, found: list[Identification], figures: bool, settings: dict[str, Any]
) -> Iterator[str]:
    """Write data and figures and yield the names of the files. Raises ConfigError."""
    from ...cosim.writing import finite, write_text
    from .studies import with_settings

    data = [with_settings(each.as_data(), settings) for each in found]
    text = json.dumps(finite(data), indent=2, allow_nan=False)
    write_text(folder / DATA, text + "\n")
    yield DATA
    if figures:
        yield from (path.name for path in _draw(folder, found))


def _draw(folder: Path, found: list[Identification]) -> Iterator[Path]:
    from ...cosim.figures import draw as figures
    from ...cosim.figures import identification as drawing

    for number, each in enumerate(found, 1):
        mark = f"-{number}" if len(found) > 1 else ""
        title = f"{each.target}: {each.input} to {each.output} at {_point(each)}"
        swept = (each.sweep.start, each.sweep.stop)
        yield from figures.save(
            drawing.bode(each.response, each.fit, swept, each.gain_unit, title), folder, f"bode{mark}"
        )
        shown = drawing.prediction(each.prediction, each.output_unit, each.output, title)
        yield from figures.save(shown, folder, f"prediction{mark}")
    if len(found) > 1:
        yield from figures.save(
            drawing.over_working_points(
                [each.working_point[1] for each in found],
                [each.fit for each in found],
                f"{found[0].output} [{found[0].output_unit}]",
                found[0].gain_unit,
                f"{found[0].target}: gain and pole over working points",
            ),
            folder,
            "working_points",
        )


def _report(found: list[Identification], folder: Path, files: list[str], as_json: bool, quiet: bool) -> None:
    from ...cosim.visible import flowing
    from .console import print_fields, print_json, print_paragraph, print_title
    from .failures import complain

    if as_json:
        print_json([each.as_data() | {"folder": str(folder), "files": files} for each in found])
    if as_json or quiet:
        for each in found:
            for warning in each.warnings:
                complain(f"warning: at {_point(each)}: {flowing(warning)}")
        return
    for number, each in enumerate(found):
        title = f"{each.target}: {each.input} [{each.input_unit}] to {each.output} [{each.output_unit}]"
        print_title(title, first=number == 0)
        print_fields(_fields(each))
    if len(found) > 1:
        _print_points(found)
    if files:
        print()
        print_paragraph(f"in {folder}: {', '.join(files)}")


def _fields(each: Identification) -> list[tuple[str, str]]:
    from .console import number

    fit, sweep = each.fit, each.sweep
    times = f", {sweep.repeats} times" if sweep.repeats > 1 else ""
    esr = each.prediction.mean_esr
    return [
        ("working point", _point(each) + (", ideal (no buses)" if each.ideal else "")),
        (
            "sweep",
            f"{sweep.start:g} to {sweep.stop:g} Hz in {sweep.duration:g} s{times}, amplitude "
            f"{sweep.amplitude:g} {each.input_unit}".rstrip(),
        ),
        (
            "fit",
            f"{fit.points} points in {fit.band[0]:g} to {fit.band[1]:g} Hz; rms error "
            f"{100 * fit.residual:.1f} %, coherence {fit.coherence:.3f}",
        ),
        ("gain", _interval(fit.gain, each.gain_unit)),
        ("pole", f"{_interval(fit.pole, 'Hz')}; T = {number(fit.model.time_constant)} s"),
        ("gain x pole", f"{_interval(fit.product, '')}, {fit.product.percentage}"),
        *([("ESR", f"{esr:.2f} % on average in accelerations")] if esr == esr else []),
        *(("switched off" if i == 0 else "", text) for i, text in enumerate(each.switched_off)),
        *(("warning", warning) for warning in each.warnings if warning not in each.switched_off),
    ]


def _point(each: Identification) -> str:
    u, y = each.working_point
    return f"{u:.4g} {each.input_unit}, {y:.4g} {each.output_unit}".replace(" ,", ",").rstrip()


def _interval(estimate: Estimate, unit: str) -> str:
    shown = f"{estimate.value:.4g} {unit}".rstrip()
    return f"{shown} (95 %: {estimate.low:.4g} to {estimate.high:.4g})"


def _print_points(found: list[Identification]) -> None:
    from .console import print_table

    first = found[0]
    headers = [
        f"{first.input} [{first.input_unit}]",
        f"{first.output} [{first.output_unit}]",
        f"gain [{first.gain_unit}]",
        "pole [Hz]",
    ]
    rows = [
        [
            f"{e.working_point[0]:.4g}",
            f"{e.working_point[1]:.4g}",
            f"{e.fit.gain.value:.4g}",
            f"{e.fit.pole.value:.4g}",
        ]
        for e in found
    ]
    print()
    print_table(headers, rows, right=headers)
