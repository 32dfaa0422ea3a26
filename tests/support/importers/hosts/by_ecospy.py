"""Ecos through ecospy: a structure of one or two models."""

from __future__ import annotations

import answers
from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

GETTERS = {"Real": "real", "Integer": "integer", "Boolean": "bool"}  # it shows no Enumeration


def main() -> None:
    """Do the job."""
    job = answers.read()
    EcosLib.set_log_level("warn")
    rows: list[list[dict[str, float]]] = [[] for _ in job.inputs]
    values = {
        f"unit{number}::{name}": value
        for number, inputs in enumerate(job.inputs)
        for name, value in (job.parameters | inputs).items()
    }
    with EcosSimulationStructure() as structure:
        for number in range(len(job.inputs)):
            structure.add_model(f"unit{number}", job.fmu)
        structure.add_parameter_set("initialValues", values)
        with EcosSimulation(structure=structure, step_size=job.step) as simulation:
            simulation.init(parameter_set="initialValues")
            for _ in range(job.count):
                simulation.step()
                for number, of_one in enumerate(rows):
                    of_one.append(
                        {
                            name: getattr(simulation, f"get_{GETTERS[job.variables[name][1]]}")(
                                f"unit{number}::{name}"
                            )
                            for name in job.of_type(*GETTERS)
                        }
                    )
            simulation.terminate()
    answers.answer(rows)


main()
