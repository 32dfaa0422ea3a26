"""The options that several verbs share, each declared once, and the translation of those of a run.

A new option of a run is declared in `cosim.system.run_options` and in `_run_options` here: every verb that
`takes_run_options` has it.
"""

from __future__ import annotations

import enum
import functools
import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from . import completion

if TYPE_CHECKING:
    from ...cosim.system.run_options import RunOptions

T = TypeVar("T")

ALONE = ("inputs", "interface", "tolerance")
"""The options that are for an FMU by itself."""


class AlgorithmChoice(enum.StrEnum):
    """The master algorithms."""

    gauss_seidel = "gauss_seidel"
    jacobi = "jacobi"


SystemArgument = Annotated[
    str,
    typer.Argument(
        metavar="SYSTEM", help="A built-in system, or a TOML file.", autocompletion=completion.systems
    ),
]


def scenario_option(text: str) -> Any:
    """Return the declaration of `--scenario`; `text` is its help."""
    return typer.Option("--scenario", "-s", metavar="S", help=text, autocompletion=completion.scenarios)


ScenarioOption = Annotated[str | None, scenario_option("Name or TOML file; default: the system's own.")]


class InterfaceChoice(enum.StrEnum):
    """The interfaces of an FMU."""

    co_simulation = "co_simulation"
    model_exchange = "model_exchange"


class EngineChoice(enum.StrEnum):
    """The engines."""

    compiled = "compiled"
    python = "python"


class UnitsChoice(enum.StrEnum):
    """The kinds of FMUs that evcosim builds of its models."""

    python = "python"
    native = "native"
    auto = "auto"


class IsolationChoice(enum.StrEnum):
    """The kinds of processes that units run in."""

    process = "process"
    none = "none"


IsolationOption = Annotated[
    IsolationChoice | None,
    typer.Option(
        help="Each unit in a process of its own, or none; default: other tools' FMUs.", show_default=False
    ),
]
TrustOption = Annotated[
    bool, typer.Option("--trust", help='Let a file say isolation = "none" for other tools\' FMUs.')
]
SettingsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="UNIT.PARAMETER=VALUE", help="Set a parameter or initial state; can be repeated."
    ),
]
FmusOption = Annotated[
    list[str] | None,
    typer.Option("--fmu", metavar="UNIT=PATH", help="Put another FMU in; can be given again."),
]
SwapsOption = Annotated[
    list[str] | None,
    typer.Option("--swap", metavar="UNIT=FILE", help="Put an FMU in by its swap file; can be given again."),
]
AllowOpenOption = Annotated[
    bool,
    typer.Option("--allow-open", help="Run although a swap file leaves names open; say what is undriven."),
]
IdealOption = Annotated[bool, typer.Option("--ideal", help="Leave the buses out: unit conversion only.")]
AlgorithmOption = Annotated[
    AlgorithmChoice | None,
    typer.Option(help="The order of steps; default: the system's own.", show_default=False),
]
EngineOption = Annotated[
    EngineChoice | None,
    typer.Option(help="What does the steps; default: compiled, python without numba.", show_default=False),
]
UnitsOption = Annotated[
    UnitsChoice | None,
    typer.Option(
        help="How evcosim's own FMUs run: in Python, compiled, or compiled where proven equal; default: "
        "python, in studies auto.",
        show_default=False,
    ),
]
StopTimeOption = Annotated[float | None, typer.Option(metavar="T", help="When to stop [s].")]
WorkersOption = Annotated[
    int | None, typer.Option(metavar="N", min=1, help="Processes at a time; default: one for each core.")
]
InputsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--input", metavar="NAME=X", help="FMU: what an input receives, 3.5 or table.csv; can be given again."
    ),
]
StepSizeOption = Annotated[
    float | None, typer.Option(metavar="H", help="The communication step [s]; default: as the files say.")
]
StartsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--start",
        metavar="UNIT.VARIABLE=VALUE",
        help="Set a start value, of a state or input; can be repeated.",
    ),
]
DelayOption = Annotated[
    float | None, typer.Option(metavar="T", help="Let every bus message arrive later by T [s].")
]
RecordOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="PATTERN", help="Record these, as in 'vehicle.*' or '!ecu.*' (not); can be given again."
    ),
]
InterfaceOption = Annotated[
    InterfaceChoice | None,
    typer.Option(help="FMU: which interface of two; default: co_simulation.", show_default=False),
]
ToleranceOption = Annotated[
    float | None, typer.Option(metavar="R", help="FMU: relative tolerance of its solver; default: its own.")
]
StrictOption = Annotated[
    bool, typer.Option("--strict", help="Refuse an FMU whose description has defects that could be mended.")
]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors and warnings only.")]


def _run_options(
    settings: SettingsOption = None,
    starts: StartsOption = None,
    fmus: FmusOption = None,
    swaps: SwapsOption = None,
    allow_open: AllowOpenOption = False,
    ideal: IdealOption = False,
    delay: DelayOption = None,
    algorithm: AlgorithmOption = None,
    isolation: IsolationOption = None,
    trust: TrustOption = False,
    engine: EngineOption = None,
    units: UnitsOption = None,
    stop_time: StopTimeOption = None,
    step_size: StepSizeOption = None,
    record: RecordOption = None,
    inputs: InputsOption = None,
    interface: InterfaceOption = None,
    tolerance: ToleranceOption = None,
    strict: StrictOption = False,
    *,
    of_fmu: bool = False,
) -> RunOptions:
    """Return the options of a run, `of_fmu` by itself or not, as the library takes them.

    Raises ConfigError.
    """
    from .arguments import parse_files, parse_inputs, parse_settings

    return {
        "parameters": parse_settings(settings or [], of_fmu),
        "start": parse_settings(starts or [], of_fmu, "--start", "speed=8"),
        "inputs": parse_inputs(inputs or []),
        "delay": delay,
        "step_size": step_size,
        "record": record,
        "interface": interface.value if interface else None,
        "tolerance": tolerance,
        "fmus": parse_files("--fmu", fmus or [], "my/Vehicle.fmu"),
        "swaps": parse_files("--swap", swaps or [], "my/swap.toml"),
        "allow_open": allow_open,
        "ideal": ideal,
        "algorithm": algorithm.value if algorithm else None,
        "isolation": isolation.value if isolation else None,
        "trust": trust,
        "engine": engine.value if engine else None,
        "units": units.value if units else None,
        "stop_time": stop_time,
        "strict": strict,
    }


def takes_run_options(*without: str) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Declare the options of a run on a verb, which receives them together as its argument `options`.

    They stand in the place of that argument, all but those named in `without`. An error about a parameter
    or an FMU names the `--set` or `--fmu` option that was typed.
    """
    known = inspect.signature(_run_options, locals={"RunOptions": Any}, eval_str=True).parameters
    declared = [p for name, p in known.items() if name not in without and p.kind is not p.KEYWORD_ONLY]

    def declare(verb: Callable[..., T]) -> Callable[..., T]:
        @functools.wraps(verb)
        def called(**arguments: Any) -> T:
            from ..single_fmu import names_fmu
            from .arguments import as_typed

            given = {parameter.name: arguments.pop(parameter.name) for parameter in declared}
            of_fmu = "inputs" in given and names_fmu(arguments.get("system"))
            with as_typed(*(given.get(name) or [] for name in ("settings", "fmus", "inputs", "starts"))):
                return verb(**arguments, options=_run_options(**given, of_fmu=of_fmu))

        own = inspect.signature(verb, locals={"RunOptions": Any}, eval_str=True).parameters.values()
        parameters = [p for each in own for p in (declared if each.name == "options" else [each])]
        # typer declares what the signature says, and looks types up in the annotations
        called.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined] # it may be set
        called.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        return called

    return declare
