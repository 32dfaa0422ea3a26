"""libcosim through libcosimpy: an execution with a fixed step."""

from __future__ import annotations

import answers
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

GETTERS = {"Real": "real", "Integer": "integer", "Enumeration": "integer", "Boolean": "boolean"}


def main() -> None:
    """Do the job."""
    job = answers.read()
    execution = CosimExecution.from_step_size(round(job.step * 1e9))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    manipulator = CosimManipulator.create_override()
    execution.add_manipulator(manipulator)
    indices = []
    for number, inputs in enumerate(job.inputs):
        index = execution.add_local_slave(CosimLocalSlave(job.fmu, f"unit{number}"))
        indices.append(index)
        for name, value in (job.parameters | inputs).items():
            reference, kind = job.variables[name]
            if not getattr(execution, f"{GETTERS[kind]}_initial_value")(index, reference, value):
                raise RuntimeError(f"{name} is not set")
        for name, value in inputs.items():  # initial values are those of the initialization alone
            getattr(manipulator, f"slave_{GETTERS[job.variables[name][1]]}_values")(
                index, [job.variables[name][0]], [value]
            )
    rows: list[list[dict[str, float]]] = [[] for _ in indices]
    for k in range(job.count):
        if not execution.step():
            raise RuntimeError(f"step {k} failed: {execution.status()}")
        for index, of_one in zip(indices, rows, strict=True):
            of_one.append(
                {
                    name: getattr(observer, f"last_{GETTERS[kind]}_values")(index, [reference])[0]
                    for name in job.of_type("Real", "Integer", "Boolean")  # it shows no Enumeration
                    for reference, kind in [job.variables[name]]
                }
            )
    answers.answer(rows)


main()
