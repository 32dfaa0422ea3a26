"""Co-simulate electric vehicles and their controllers: FMI units on a CAN bus.

    from evcosim import Simulation, simulate

    results = simulate("scooter", scenario="fig8", parameters={"vehicle.mass": 180.0})
    print(results["vehicle.speed"].max(), results.units["vehicle.speed"])

    with Simulation("scooter") as sim:
        sim.step(1000)
        print(sim.time, sim["vehicle.speed"])

The names in `__all__` are the interface, described in docs/python.md; the modules behind them may move. Each
name is imported on first use, so that `import evcosim` loads none of numpy, fmpy, pydantic and cantools.
"""

from __future__ import annotations

import importlib

TYPE_CHECKING = (
    False  # a type checker takes it as true; importing typing is half the time that this module takes
)
if TYPE_CHECKING:
    from .cosim.analysis.bus_budget import Budget, Point, Series
    from .cosim.analysis.first_order import Estimate, FirstOrder, Fit, Prediction
    from .cosim.analysis.frequency_response import FrequencyResponse
    from .cosim.analysis.sweep import Sweep
    from .cosim.can.bus_settings import BusVariation, Resolution, Timing
    from .cosim.clock import Clock
    from .cosim.errors import ConfigError, RunError
    from .cosim.interface import Value
    from .cosim.results.metrics import Metric, Metrics
    from .cosim.results.results import Results
    from .cosim.results.text_table import TextTable
    from .cosim.results.variable import ResultVariable
    from .cosim.row_store import Array, Grid, Table
    from .cosim.system.figure_spec import EndSpec, FigureSpec, PanelSpec, SignalSpec
    from .cosim.system.identification_spec import IdentificationSpec
    from .cosim.system.metric_spec import MetricSpec, Reduction
    from .cosim.system.run_options import RunOptions
    from .cosim.system.scenario import Scenario, ScenarioFile, load_scenario
    from .cosim.system.system import (
        Algorithm,
        EngineName,
        Isolation,
        System,
        SystemFile,
        UnitsName,
        load_system,
    )
    from .cosim.system.toml import FileValue
    from .master.simulation import RunProgress, Simulation, simulate
    from .master.studies.bus_budget import budget
    from .master.studies.identification import Identification, identify
    from .master.studies.identification_run import PhaseProgress
    from .master.studies.parallel import Failure, Outcome, Task, TaskError, TaskProgress, run_all
    from .master.unit import Unit

    __version__: str

__all__ = [
    "Algorithm",
    "Array",
    "Budget",
    "BusVariation",
    "Clock",
    "ConfigError",
    "EndSpec",
    "EngineName",
    "Estimate",
    "Failure",
    "FigureSpec",
    "FileValue",
    "FirstOrder",
    "Fit",
    "FrequencyResponse",
    "Grid",
    "Identification",
    "IdentificationSpec",
    "Isolation",
    "Metric",
    "MetricSpec",
    "Metrics",
    "Outcome",
    "PanelSpec",
    "PhaseProgress",
    "Point",
    "Prediction",
    "Reduction",
    "Resolution",
    "ResultVariable",
    "Results",
    "RunError",
    "RunOptions",
    "RunProgress",
    "Scenario",
    "ScenarioFile",
    "Series",
    "SignalSpec",
    "Simulation",
    "Sweep",
    "System",
    "SystemFile",
    "Table",
    "Task",
    "TaskError",
    "TaskProgress",
    "TextTable",
    "Timing",
    "Unit",
    "UnitsName",
    "Value",
    "__version__",
    "budget",
    "identify",
    "load_scenario",
    "load_system",
    "run_all",
    "simulate",
]

# name -> its module; what stands above for type checkers, and a test compares the two
_MODULES = {
    "Algorithm": "cosim.system.system",
    "Array": "cosim.row_store",
    "Budget": "cosim.analysis.bus_budget",
    "BusVariation": "cosim.can.bus_settings",
    "Clock": "cosim.clock",
    "ConfigError": "cosim.errors",
    "EngineName": "cosim.system.system",
    "UnitsName": "cosim.system.system",
    "Estimate": "cosim.analysis.first_order",
    "Failure": "master.studies.parallel",
    "EndSpec": "cosim.system.figure_spec",
    "FigureSpec": "cosim.system.figure_spec",
    "FileValue": "cosim.system.toml",
    "FirstOrder": "cosim.analysis.first_order",
    "Fit": "cosim.analysis.first_order",
    "FrequencyResponse": "cosim.analysis.frequency_response",
    "Grid": "cosim.row_store",
    "Identification": "master.studies.identification",
    "IdentificationSpec": "cosim.system.identification_spec",
    "Isolation": "cosim.system.system",
    "Metric": "cosim.results.metrics",
    "MetricSpec": "cosim.system.metric_spec",
    "Metrics": "cosim.results.metrics",
    "Outcome": "master.studies.parallel",
    "PanelSpec": "cosim.system.figure_spec",
    "PhaseProgress": "master.studies.identification_run",
    "Point": "cosim.analysis.bus_budget",
    "Prediction": "cosim.analysis.first_order",
    "Reduction": "cosim.system.metric_spec",
    "Resolution": "cosim.can.bus_settings",
    "ResultVariable": "cosim.results.variable",
    "Results": "cosim.results.results",
    "RunError": "cosim.errors",
    "RunOptions": "cosim.system.run_options",
    "RunProgress": "master.simulation",
    "Scenario": "cosim.system.scenario",
    "ScenarioFile": "cosim.system.scenario",
    "Series": "cosim.analysis.bus_budget",
    "SignalSpec": "cosim.system.figure_spec",
    "Simulation": "master.simulation",
    "Sweep": "cosim.analysis.sweep",
    "System": "cosim.system.system",
    "SystemFile": "cosim.system.system",
    "Table": "cosim.row_store",
    "Task": "master.studies.parallel",
    "TaskError": "master.studies.parallel",
    "TaskProgress": "master.studies.parallel",
    "TextTable": "cosim.results.text_table",
    "Timing": "cosim.can.bus_settings",
    "Unit": "master.unit",
    "Value": "cosim.interface",
    "budget": "master.studies.bus_budget",
    "identify": "master.studies.identification",
    "load_scenario": "cosim.system.scenario",
    "load_system": "cosim.system.system",
    "run_all": "master.studies.parallel",
    "simulate": "master.simulation",
}


if not TYPE_CHECKING:  # a type checker that sees this would accept every misspelled name

    def __getattr__(name: str) -> object:
        if name == "__version__":
            from importlib.metadata import version

            return version("evcosim")
        if name in _MODULES:
            found = getattr(importlib.import_module(f".{_MODULES[name]}", __name__), name)
            globals()[name] = found  # so that the next look-up does not come here
            return found
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
