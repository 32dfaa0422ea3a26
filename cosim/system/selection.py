"""Figure and metrics of a run: the scenario's own, and the system's without what the scenario leaves out."""

from __future__ import annotations

from collections.abc import Iterable

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


def _needs(signals: Iterable[str], scenario: Scenario) -> bool:
    return any(name.partition(".")[0] in scenario.file.leave_out for name in signals)
