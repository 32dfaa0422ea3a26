"""Co-simulate electric vehicles and their controllers: FMI units on a CAN bus.

    from evcosim import Simulation, simulate

    results = simulate("scooter", scenario="fig8", parameters={"vehicle.mass": 180.0})
    print(results["vehicle.speed"].max(), results.units["vehicle.speed"])

    with Simulation("scooter") as sim:
        sim.step(1000)
        print(sim.time, sim["vehicle.speed"])

The names in `__all__` are the interface; the rooms behind them may move. docs/python.md describes them.
Each is imported on first use, so that `import evcosim` loads none of numpy, fmpy, pydantic and cantools.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .cosim.analysis.bus_budget import Budget as Budget
    from .cosim.errors import ConfigError as ConfigError
    from .cosim.errors import RunError as RunError
    from .cosim.results.results import Results as Results
    from .cosim.results.results import ResultVariable as ResultVariable
    from .cosim.system.identification_spec import IdentificationSpec as IdentificationSpec
    from .cosim.system.scenario import Scenario as Scenario
    from .cosim.system.scenario import load_scenario as load_scenario
    from .cosim.system.system import System as System
    from .cosim.system.system import load_system as load_system
    from .cosim.system.variation import BusVariation as BusVariation
    from .master.simulation import Simulation as Simulation
    from .master.simulation import simulate as simulate
    from .master.studies.bus_budget import budget as budget
    from .master.studies.identification import Identification as Identification
    from .master.studies.identification import identify as identify
    from .master.studies.parallel import run_all as run_all

    __version__: str
