"""`evcosim run`: a system to its stop time, the results in a folder, and a summary in a few lines."""

from __future__ import annotations

import contextlib
import dataclasses
import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from . import completion
from .can_logs import CanLogOption, CanLogs, CanLogStartOption
from .options import QuietOption, ScenarioOption, takes_run_options
from .repeat import repeating

if TYPE_CHECKING:
    from ...cosim.results.results import Results
    from ...cosim.results.run_folder import RunFolder
    from ...cosim.system.run_options import RunOptions
    from ..simulation import Simulation
    from .console import Show
    from .interrupts import Interrupts

_FIGURE = 100e6  # bytes of memory that drawing takes


@takes_run_options()
def run(
    context: typer.Context,
    system: Annotated[
        str,
        typer.Argument(
            metavar="SYSTEM|FMU",
            help="A system, or an FMU by itself: a file, or a built-in name.",
            autocompletion=completion.systems_and_fmus,
        ),
    ],
    scenario: ScenarioOption = None,
    *,
    options: RunOptions,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Default: results/<system>-<scenario>."),
    ] = None,
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace results of other settings in DIR.")
    ] = False,
    can_log: CanLogOption = None,
    can_log_start: CanLogStartOption = None,
    no_plot: Annotated[bool, typer.Option("--no-plot", help="Draw no figure.")] = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no page (report.html).")] = False,
    profile: Annotated[bool, typer.Option("--profile", help="Show what takes the time of a step.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print what happened as JSON.")] = False,
    quiet: QuietOption = False,
) -> int:
    """Run a system, or an FMU by itself; write results.csv, run.json, a figure and a page (report.html)."""
    bar = not (as_json or quiet)
    files = Wanted(CanLogs.asked(can_log, can_log_start), not no_plot, not no_report)
    command = repeating(context, "output", "replace", "as_json", "quiet", "profile")
    order = Order(system, scenario, options, output, replace, files, profile, bar, command)
    return _carry_out(order, as_json, quiet)


class Wanted(NamedTuple):
    """The files of a run that are wanted beside its results."""

    can_logs: CanLogs
    figure: bool
    report: bool

    def check(self, folder: Path, start: float) -> None:
        """Raise ConfigError before a run from `start` [s] on, where one of them cannot be made after it."""
        from ...cosim.errors import ConfigError

        self.can_logs.check(folder, start)
        if (self.figure or self.report) and importlib.util.find_spec("matplotlib") is None:
            raise ConfigError(
                "figure and page need matplotlib, which is not installed: `pip install matplotlib`, or run "
                "with --no-plot --no-report"
            )


@dataclasses.dataclass(frozen=True)
class Order:
    """A run as the command line describes it; `output` is its folder (None: the default).

    With `replace` the run may replace results of other settings. `profile` measures the parts of a step,
    `bar` shows the progress, `command` does the same run again.
    """

    system: str
    scenario: str | None
    options: RunOptions
    output: Path | None
    replace: bool
    files: Wanted
    profile: bool
    bar: bool
    command: str


@dataclasses.dataclass
class FinishedRun:
    """A run at its end: `error` is its failure (None: none), `files` are the names of written files.

    `unwritten` says why its results are not in the folder, and where they are ("": they are there). `target`
    is the system or FMU as it was typed.
    """

    target: str
    simulation: Simulation
    folder: RunFolder
    results: Results
    error: BaseException | None
    files: list[str] = dataclasses.field(default_factory=list)
    metrics: list[Any] = dataclasses.field(default_factory=list)
    unwritten: str = ""
    remarks: list[str] = dataclasses.field(default_factory=list)


def _carry_out(order: Order, as_json: bool, quiet: bool) -> int:
    from ...cosim.visible import flowing
    from . import summary
    from .console import print_json
    from .failures import FAILED, complain
    from .interrupts import exit_code

    with contextlib.ExitStack() as keeping:
        finished, interrupts = _run(order, keeping)
        with finished.folder:
            _evaluate(finished, order.command)
            _write(finished, order, interrupts, keeping)
    if as_json:
        print_json(summary.as_data(finished))
    for remark in finished.remarks if as_json or quiet else ():
        complain(f"warning: {flowing(remark)}")
    if finished.error is not None:
        complain(summary.of_failure(finished))
        return exit_code(finished.error) if isinstance(finished.error, KeyboardInterrupt) else FAILED
    if not (as_json or quiet):
        summary.show(finished)
    return 0


def _run(order: Order, keeping: contextlib.ExitStack) -> tuple[FinishedRun, Interrupts]:
    """Prepare everything, then step; `keeping` is left when the results are written.

    An error in the steps, or a signal, is kept in the finished run. Before the run has a folder, an error is
    raised, and a signal ends the process.
    """
    from ...cosim.errors import ConfigError, RunError
    from ..prepare import check_decodable
    from ..simulation import Simulation
    from .interrupts import Interrupted, Interrupts
    from .outputs import default_folder, run_folder, suffix_of

    if order.files.can_logs and order.options.get("ideal"):
        raise ConfigError("--can-log and --ideal contradict each other: without buses there are no frames")
    error: BaseException | None = None
    simulation = Simulation(
        order.system,
        order.scenario,
        log_frames=bool(order.files.can_logs),
        profile=order.profile,
        to_stop=True,
        **order.options,
    )
    with contextlib.ExitStack() as running:
        running.enter_context(simulation)
        if order.files.can_logs:
            check_decodable(simulation.system)
        named = default_folder(simulation.system.file.name, simulation.scenario.name)
        suffix = suffix_of(order.options, order.scenario if order.output else None)
        about = simulation.manifest()
        folder, remarks = run_folder(order.output or named, about, suffix, order.replace)
        interrupts = keeping.enter_context(Interrupts(folder.rescue))
        try:
            order.files.check(folder.path, simulation.plan.clock.start)
            with running.pop_all():
                simulation.keep_in(folder)
                _step(simulation, interrupts, order.bar)
        except (RunError, KeyboardInterrupt) as failure:
            # a signal that everybody got may have ended a unit as well
            error = Interrupted(interrupts.number) if interrupts.number else failure
        except BaseException:
            folder.release()
            raise
    remarks += simulation.warnings
    finished = FinishedRun(order.system, simulation, folder, simulation.results, error, remarks=remarks)
    return finished, interrupts


def _step(simulation: Simulation, interrupts: Interrupts, bar: bool) -> None:
    """Step to the stop time; every 0.1 s, or after a longer step, show the progress and look at Ctrl-C."""
    from .console import progress_bar

    experiment = simulation.plan.experiment
    title = " ".join(name for name in (simulation.system.file.name, simulation.scenario.name) if name)
    show: Show
    with progress_bar(title, experiment.start_time, experiment.stop_time, bar) as show:

        def look(now: float, stop: float) -> None:
            show(now)
            interrupts.check()

        simulation.run(look)


def _evaluate(finished: FinishedRun, command: str) -> None:
    """Note for run.json the metrics of a whole run, or the error of a failed one, and the command."""
    from ..keeping import ended

    manifest = finished.results.manifest
    manifest["command"] = command
    if finished.error is None:
        finished.metrics = finished.results.metrics
        manifest["metrics"] = {m.name: {"value": m.value, "unit": m.unit} for m in finished.metrics}
    ended(finished.results, True, finished.error)


def _write(
    finished: FinishedRun, order: Order, interrupts: Interrupts, keeping: contextlib.ExitStack
) -> None:
    """Write results, CAN logs and, unless a signal came, figure and page.

    Raises RunError naming what is there.
    """
    from ...cosim.errors import ConfigError, RunError
    from .interrupts import Interrupted, say
    from .outputs import write_results

    folder = finished.folder
    try:
        finished.files += write_results(folder, finished.results)
    except RunError as error:
        finished.unwritten = str(error)
        finished.error = finished.error or error
        return
    finished.remarks += [folder.remark] if folder.remark else []
    try:
        _write_logs(finished, order)
        say(f"; in {folder.path}: {', '.join(finished.files)}")
        keeping.close()
        if interrupts.number:
            finished.error = finished.error or Interrupted(interrupts.number)
        else:
            _draw(finished, order.files)
    except ConfigError as error:
        raise RunError(f"{error}\nin {folder.path}: {', '.join(finished.files)}") from error


def _draw(finished: FinishedRun, wanted: Wanted) -> None:
    """Write the figure and the page of a run, if there is memory for it. Raises ConfigError."""
    from ...cosim.shortage import too_little_memory
    from .outputs import figure_of, write_figure, write_report

    if not (wanted.figure or wanted.report):
        return
    if said := too_little_memory(_FIGURE, "drawing", "matplotlib.figure"):
        finished.remarks.append(f"no figure and no page: {said}")
        return
    results, folder = finished.results, finished.folder.path
    results.figure = figure_of(results)  # which both draw
    if wanted.figure and not results.variables:
        finished.remarks.append("no figure: the run records no numbers")
    elif wanted.figure and len(results) > 1:
        finished.files += write_figure(folder, results)
    if wanted.report:
        finished.files += write_report(folder, results)


def _write_logs(finished: FinishedRun, order: Order) -> None:
    logs = order.files.can_logs
    if logs and not finished.simulation.plan.messages:
        finished.remarks.append("no CAN log: no connection of the system is over a bus")
    elif logs:
        finished.files += logs.write(finished.folder.path, finished.simulation)
