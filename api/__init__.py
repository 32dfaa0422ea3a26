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
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .cosim.analysis.bus_budget import Budget
    from .cosim.can.bus_settings import BusVariation
    from .cosim.errors import ConfigError, RunError
    from .cosim.results.metrics import Metric
    from .cosim.results.results import Results
    from .cosim.results.variable import ResultVariable
    from .cosim.system.identification_spec import IdentificationSpec
    from .cosim.system.run_options import RunOptions
    from .cosim.system.scenario import Scenario, load_scenario
    from .cosim.system.system import System, load_system
    from .master.simulation import Simulation, simulate
    from .master.studies.bus_budget import budget
    from .master.studies.identification import Identification, identify
    from .master.studies.parallel import Outcome, Task, run_all

    __version__: str

__all__ = [
    "Budget",
    "BusVariation",
    "ConfigError",
    "Identification",
    "IdentificationSpec",
    "Metric",
    "Outcome",
    "ResultVariable",
    "Results",
    "RunError",
    "RunOptions",
    "Scenario",
    "Simulation",
    "System",
    "Task",
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
    "Budget": "cosim.analysis.bus_budget",
    "BusVariation": "cosim.can.bus_settings",
    "ConfigError": "cosim.errors",
    "Identification": "master.studies.identification",
    "IdentificationSpec": "cosim.system.identification_spec",
    "Metric": "cosim.results.metrics",
    "Outcome": "master.studies.parallel",
    "ResultVariable": "cosim.results.variable",
    "Results": "cosim.results.results",
    "RunError": "cosim.errors",
    "RunOptions": "cosim.system.run_options",
    "Scenario": "cosim.system.scenario",
    "Simulation": "master.simulation",
    "System": "cosim.system.system",
    "Task": "master.studies.parallel",
    "budget": "master.studies.bus_budget",
    "identify": "master.studies.identification",
    "load_scenario": "cosim.system.scenario",
    "load_system": "cosim.system.system",
    "run_all": "master.studies.parallel",
    "simulate": "master.simulation",
}


if not TYPE_CHECKING:  # a type checker that sees this would accept every misspelled name

    def __getattr__(name: str) -> Any:
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
