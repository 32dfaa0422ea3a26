"""Measuring a bus budget: a run for every point of every series, on all cores.

The record `Budget` and its arithmetic stand in `cosim.analysis.bus_budget`, its command in `cli.budget`.
"""

from __future__ import annotations

import dataclasses
from numbers import Integral
from pathlib import Path
from typing import Unpack

from ...cosim.analysis.bus_budget import Budget, Point, Series, chance_series, series
from ...cosim.can.bus_settings import BusVariation
from ...cosim.errors import ConfigError, ShortageError, nearest, short
from ...cosim.results.metrics import Metric, evaluate
from ...cosim.system.metric_spec import MetricSpec
from ...cosim.system.run_options import RunOptions
from ...cosim.system.scenario import Scenario
from ...cosim.system.selection import metric_specs
from ...cosim.system.system import BudgetEntry, System
from ..prepare import Prepared, prepare
from ..simulation import simulate
from .parallel import Outcome, Task, TaskError, TaskProgress, run_all

_MOST_SEEDS = 1000
_OF_THE_MACHINE = (ShortageError.__name__, "MemoryError", "OSError", "ImportError")  # a failure's kinds


def budget(
    system: str | Path | System,
    scenario: str | Path | Scenario | None = None,
    *,
    workers: int | None = None,
    progress: TaskProgress | None = None,
    seeds: int = 0,
    **options: Unpack[RunOptions],
) -> Budget:
    """Measure the bus budget of a system: its buses varied, judged by the metric of its [budget] table.

    With `seeds` timing, jitter and losses are varied too, those of chance over so many seeds.
    The arguments are those of `simulate`, except for `bus` and `ideal`, which a budget sets itself, and
    `record`, since it keeps no results;
    `workers` and `progress` are those of `parallel.run_all` (a script needs `if __name__ == "__main__":`).
    Raises ConfigError before any run; a run that fails is a broken point, but TaskError where this machine
    lacks memory or room.
    """
    for name in ("bus", "ideal"):
        if options.get(name):
            raise ConfigError(f"a bus budget varies the buses itself, so that '{name}' cannot be given")
    if options.get("record"):
        raise ConfigError("a bus budget keeps no results, so that 'record' cannot be given")
    if not (isinstance(seeds, Integral) and not isinstance(seeds, bool) and 0 <= seeds <= _MOST_SEEDS):
        raise ConfigError(f"seeds = {short(seeds)}: it is a whole number from 0 to {_MOST_SEEDS}")
    options["units"] = options.get("units") or "auto"
    prepared = prepare(system, scenario, **options)
    entry, spec = _criterion(prepared)
    planned = series(prepared.plan.experiment.step_size)
    if seeds:
        planned += _of_chance(prepared, int(seeds))
    names: dict[BusVariation, str] = {}
    for each in planned:
        for point in each.points:
            for n, run in enumerate(point.runs()):
                seed = f" seed {n}" if point.seeds > 1 else ""
                names.setdefault(run, f"{each.name} {point.label}{seed}")  # the nominal point is run once
    tasks = [
        Task(name, measure, (system, scenario, spec), {**options, "bus": bus}) for bus, name in names.items()
    ]
    found = dict(zip(names, run_all(tasks, workers, progress), strict=True))
    return Budget(
        system=prepared.plan.system,
        scenario=prepared.plan.scenario,
        metric=spec.name,
        unit=spec.unit,
        limit=entry.limit,
        kind=entry.kind,
        series=tuple(
            dataclasses.replace(
                each,
                points=tuple(
                    p.of_seeds([_judged(p, found[run]) for run in p.runs()], entry.kind) for p in each.points
                ),
            )
            for each in planned
        ),
    )


def _of_chance(prepared: Prepared, seeds: int) -> tuple[Series, ...]:
    """Return the series of chance, by the timing and the shortest cycle time of the messages."""
    messages = prepared.plan.messages
    timing = "frame" if any(message.timed for message in messages) else "instant"
    shortest = min(prepared.plan.clock.length(message.every) for message in messages)
    return chance_series(timing, shortest, seeds)


def measure(
    system: str | Path | System,
    scenario: str | Path | Scenario | None,
    spec: MetricSpec,
    **options: Unpack[RunOptions],
) -> Metric:
    """Run a system with the options of `simulate` and return one metric. Raises as `simulate` does."""
    results = simulate(system, scenario, **options)
    return evaluate(results, [spec])[0]


def _judged(point: Point, outcome: Outcome[Metric]) -> Point:
    """Return the point with the value of its run, or marked as failed with the reason.

    Raises TaskError for a run that this machine had no memory or room for: it says nothing of the buses.
    """
    if outcome.failure is not None and outcome.failure.kind in _OF_THE_MACHINE:
        raise TaskError(outcome.name, outcome.failure)
    if outcome.failure is not None:
        return dataclasses.replace(point, reason=outcome.failure.reason, failed=True)
    metric = outcome.result()
    return dataclasses.replace(point, value=metric.value, reason=metric.reason)


def _criterion(prepared: Prepared) -> tuple[BudgetEntry, MetricSpec]:
    """Return the [budget] table and its metric. Raises ConfigError without them, or without a bus to vary."""
    path, entry = prepared.system.path, prepared.system.file.budget
    if entry is None:
        raise ConfigError(
            f"{path}: the system does not say what it is judged by; give it a table [budget] with 'metric', "
            "the name of one of its metrics, and 'limit'"
        )
    specs = {spec.name: spec for spec in metric_specs(prepared.system, prepared.scenario)}
    if entry.metric not in specs:
        raise ConfigError(
            f"{path}: budget.metric: scenario '{prepared.scenario.name}' has no metric '{entry.metric}'"
            f"{nearest(entry.metric, specs)}; there are: {', '.join(specs) or 'none'}"
        )
    if not any(route.sinks for message in prepared.plan.messages for route in message.routes):
        raise ConfigError(f"{path}: no unit receives anything over a bus, so that there is nothing to vary")
    return entry, specs[entry.metric]
