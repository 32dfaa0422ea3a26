"""Which figure and metrics a run has: the scenario's own, and the system's without what was left out."""

from __future__ import annotations

from collections.abc import Iterable

from . import figures, metrics
from .figure_spec import FigureSpec
from .metrics import MetricSpec
from .results import ResultVariable
from .scenario import Scenario
from .system import System


def metric_specs(system: System, scenario: Scenario) -> list[MetricSpec]:
    """The metrics of the system that need no unit that the scenario leaves out, then the scenario's.

    A metric of the scenario takes the place of the system's of the same name.
    """
    own = {spec.name for spec in scenario.file.metrics}
    kept = [s for s in system.file.metrics if s.name not in own and not _needs(_signals(s), scenario)]
    return [*kept, *scenario.file.metrics]


def figure_spec(system: System, scenario: Scenario) -> FigureSpec | None:
    """The figure of the scenario, or that of the system without the units that the scenario leaves out.

    None: nothing is asked for, or nothing of it is left.
    """
    spec = system.file.figure
    if scenario.file.figure is not None or spec is None:
        return scenario.file.figure
    panels = [
        panel.model_copy(update={"signals": [s for s in panel.signals if not _needs([s.name], scenario)]})
        for panel in spec.panels
    ]
    shade = None if spec.shade is None or _needs([spec.shade], scenario) else spec.shade
    panels = [panel for panel in panels if panel.signals]
    return spec.model_copy(update={"panels": panels, "shade": shade}) if panels else None


def check_specs(system: System, scenario: Scenario, variables: Iterable[ResultVariable]) -> None:
    """Find before the run what would be wrong after it: a figure or metric of what is not recorded.

    Raises ConfigError naming the files.
    """
    recorded = {v.name: v for v in variables}
    places = [str(path) for path in (system.path, scenario.path) if path is not None]
    metrics.check(metric_specs(system, scenario), recorded, " with ".join(places))
    spec = figure_spec(system, scenario)
    if spec is not None:
        place = system.path if scenario.file.figure is None else scenario.path
        figures.check(spec, recorded, f"{place}: figure")


def _signals(spec: MetricSpec) -> list[str]:
    parts = (spec, spec.per) if spec.per else (spec,)
    return [name for part in parts for name in (part.signal, part.minus) if name is not None]


def _needs(signals: Iterable[str], scenario: Scenario) -> bool:
    return any(name.partition(".")[0] in scenario.file.leave_out for name in signals)
