"""The FMUs that evcosim builds: name -> module of the model and the experiment that fits it.

An FMU has the name of its model's class. One line adds one (docs/how-to/add-a-model.md). Nothing here imports
a model, so that names are listed at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple


class Experiment(NamedTuple):
    """FMI's DefaultExperiment [s]: the stop time and the step size of an importer that is given none."""

    stop_time: float = 10.0
    step_size: float = 0.01


class Entry(NamedTuple):
    """The name of the model's module, below evcosim.models, and its experiment."""

    module: str
    experiment: Experiment


CATALOG = {
    "Scooter": Entry("scooter", Experiment(stop_time=60.0)),
    "BoundController": Entry("bound_controller", Experiment(stop_time=60.0)),
    "BoundPlanner": Entry("bound_planner", Experiment(stop_time=60.0)),
    "Rider": Entry("rider", Experiment(stop_time=60.0)),
    "Battery": Entry("battery", Experiment(stop_time=60.0)),
    "LateralVehicle": Entry("lateral_vehicle", Experiment(stop_time=6.0)),
    "LaneKeepingController": Entry("lane_keeping_controller", Experiment(stop_time=6.0)),
    "TwoMotorVehicle": Entry("two_motor_vehicle", Experiment(stop_time=10.0)),
    "InductionMotorDrive": Entry("induction_motor_drive", Experiment(stop_time=1.0)),
    "Inverter": Entry("inverter", Experiment(stop_time=10.0)),
    "ElectronicDifferential": Entry("electronic_differential", Experiment(stop_time=10.0)),
    "WheelSpeedController": Entry("wheel_speed_controller", Experiment(stop_time=10.0)),
    "TwoWheelerBraking": Entry("two_wheeler_braking", Experiment(stop_time=5.0)),
    "DetailedTwoWheeler": Entry("detailed_two_wheeler", Experiment(stop_time=5.0)),
    "SlipController": Entry("slip_controller", Experiment(stop_time=5.0)),
    "WheelSpeedEstimator": Entry("wheel_speed_estimator", Experiment(stop_time=5.0)),
    "BrakeActuator": Entry("brake_actuator", Experiment(stop_time=5.0)),
}


def model_file(name: str) -> Path:
    """Return the source file of a catalog entry's model."""
    from .. import models  # light: a docstring

    return Path(models.__file__ or "").parent / f"{CATALOG[name].module}.py"


def text(name: str) -> str:
    """Return the first line of a model's docstring, read without importing the model."""
    from .sources import text_of_class  # the parser is needed here only

    return text_of_class(model_file(name), name)
