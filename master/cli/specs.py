"""Which figure and metrics a run has: the scenario's, or else the system's without what was left out."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...cosim.figure_spec import FigureSpec
    from ...cosim.metrics import MetricSpec
    from ...cosim.results import ResultVariable
    from ...cosim.scenario import Scenario
    from ...cosim.system import System


def metric_specs(system: System, scenario: Scenario) -> list[MetricSpec]:
    """The metrics of the scenario, or those of the system that need no unit that the scenario leaves out."""
    if scenario.file.metrics is not None:
        return scenario.file.metrics
    return [spec for spec in system.file.metrics if not _needs(_signals(spec), scenario)]


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

    Raises ConfigError naming the file.
    """
    from ...cosim import figures, metrics

    recorded = {v.name: v for v in variables}
    place = str(system.path if scenario.file.metrics is None else scenario.path)
    metrics.check(metric_specs(system, scenario), recorded, place)
    spec = figure_spec(system, scenario)
    if spec is not None:
        place = str(system.path if scenario.file.figure is None else scenario.path)
        figures.check(spec, recorded, f"{place}: figure")


def _signals(spec: MetricSpec) -> list[str]:
    parts = (spec, spec.per) if spec.per else (spec,)
    return [name for part in parts for name in (part.signal, part.minus) if name is not None]


def _needs(signals: Iterable[str], scenario: Scenario) -> bool:
    return any(name.partition(".")[0] in scenario.file.leave_out for name in signals)
