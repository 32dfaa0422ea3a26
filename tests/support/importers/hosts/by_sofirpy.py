"""sofirpy's simulate: FMUs of FMI 2.0 beside models in Python, here one that holds the inputs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import answers
from sofirpy import SimulationEntity, simulate

JOB = answers.read()


class Held(SimulationEntity):
    """Gives the inputs, which sofirpy sets by connections alone."""

    def set_parameter(self, parameter_name: str, parameter_value: Any) -> None:
        """Take nothing."""

    def get_parameter_value(self, output_name: str) -> Any:
        """Return an input, whose name begins with the number of its instance."""
        number, _, name = output_name.partition(":")
        return JOB.inputs[int(number)][name]

    def do_step(self, time: float) -> None:
        """Do nothing."""


def main() -> None:
    """Do the job."""
    units = {f"unit{number}": inputs for number, inputs in enumerate(JOB.inputs)}
    outputs = JOB.of_type("Real", "Integer", "Boolean")  # it has no getter for an Enumeration
    frame = simulate(
        stop_time=JOB.time(JOB.count),
        step_size=JOB.step,
        fmu_paths={unit: Path(JOB.fmu) for unit in units},
        model_classes={"held": Held},
        connections_config={
            unit: [
                {
                    "parameter_name": name,
                    "connect_to_system": "held",
                    "connect_to_external_parameter": f"{n}:{name}",
                }
                for name in inputs
            ]
            for n, (unit, inputs) in enumerate(units.items())
        },
        start_values={unit: JOB.parameters | inputs for unit, inputs in units.items()},
        parameters_to_log=dict.fromkeys(units, outputs),
    )
    rows = [
        [{name: row[f"{unit}.{name}"] for name in outputs} for _, row in frame.iloc[1:].iterrows()]
        for unit in units
    ]
    answers.answer(rows)


main()
