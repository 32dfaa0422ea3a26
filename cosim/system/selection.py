"""Figure and metrics of a run: the scenario's own, and the system's without what the scenario leaves out."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterable

from .figure_spec import FigureSpec
from .metric_spec import MetricSpec
from .scenario import Scenario
from .system import System


def metric_specs(system: System, scenario: Scenario) -> list[MetricSpec]:
    """Return the metrics of the system that need no unit that the scenario leaves out, then the scenario's.

    A metric of the scenario takes the place of the system's of the same name.
    """
    own = {spec.name for spec in scenario.file.metrics}
    kept = [s for s in system.file.metrics if s.name not in own and not _needs(s.all_signals, scenario)]
    return [*kept, *scenario.file.metrics]


def figure_spec(system: System, scenario: Scenario) -> FigureSpec | None:
    """Return the figure of the scenario, or that of the system without the units that it leaves out.

    None: neither has one, or nothing of it is left.
    """
    spec = system.file.figure
    if scenario.file.figure is not None or spec is None:
        return scenario.file.figure
    return spec.without(lambda name: _needs([name], scenario))


def recorded_alone(
    system: System, scenario: Scenario, recorded: Collection[str]
) -> tuple[System, Scenario, tuple[str, ...]]:
    """Return both without the metrics and lines of figures that need more than is recorded, and a remark.

    It is for a run whose recorded variables are its caller's choice; () where nothing is left out.
    """
    gone = [s.name for s in metric_specs(system, scenario) if not set(s.all_signals) <= set(recorded)]
    figure = figure_spec(system, scenario)

    def drawn(spec: FigureSpec | None) -> FigureSpec | None:
        return spec and spec.without(lambda name: name not in recorded)

    def changes(metrics: list[MetricSpec], spec: FigureSpec | None) -> dict[str, object]:
        return {"metrics": [m for m in metrics if m.name not in gone], "figure": drawn(spec)}

    of_system, of_scenario = system.file, scenario.file
    of_system = of_system.model_copy(update=changes(of_system.metrics, of_system.figure))
    of_scenario = of_scenario.model_copy(update=changes(of_scenario.metrics, of_scenario.figure))
    what = [f"the metrics {', '.join(gone)}"] if gone else []
    what += ["lines of the figure"] if drawn(figure) != figure else []
    said = (f"left out for want of what `record` leaves out: {' and '.join(what)}",) if what else ()
    return dataclasses.replace(system, file=of_system), dataclasses.replace(scenario, file=of_scenario), said


def without_undrawn(
    system: System, scenario: Scenario, recorded: Collection[str]
) -> tuple[System, Scenario, tuple[str, ...]]:
    """Return both without the `optional` lines of figures whose variable is not recorded, and a sentence for
    each that the run would have drawn."""
    drawn = figure_spec(system, scenario)
    gone = sorted(drawn.optional() - set(recorded)) if drawn else []
    if not gone:
        return system, scenario, ()

    def left(spec: FigureSpec | None) -> FigureSpec | None:
        return spec and spec.without(gone.__contains__)

    of_system = system.file.model_copy(update={"figure": left(system.file.figure)})
    of_scenario = scenario.file.model_copy(update={"figure": left(scenario.file.figure)})
    said = tuple(f"left out of the figure, since it is not recorded: {name}" for name in gone)
    return dataclasses.replace(system, file=of_system), dataclasses.replace(scenario, file=of_scenario), said


def _needs(signals: Iterable[str], scenario: Scenario) -> bool:
    return any(name.partition(".")[0] in scenario.file.leave_out for name in signals)
