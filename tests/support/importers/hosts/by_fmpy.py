"""FMPy's simulate_fmu; for two instances and saved states, its binding of the functions of FMI."""

from __future__ import annotations

import answers
import fmpy
from fmpy.simulation import apply_start_values, instantiate_fmu, simulate_fmu


def simulated(job: answers.Job) -> list[dict[str, float]]:
    """Return the rows of simulate_fmu without that of the start."""
    result = simulate_fmu(
        job.fmu,
        stop_time=job.time(job.count),
        output_interval=job.step,
        start_values=job.parameters | job.inputs[0],
        output=job.outputs,
    )
    return [dict(zip(result.dtype.names[1:], list(row)[1:], strict=True)) for row in result[1:]]


class Stepped:
    """An instance that is stepped by the functions of FMI."""

    def __init__(self, job: answers.Job, inputs: dict[str, float], folder: str) -> None:
        description = fmpy.read_model_description(job.fmu)
        self.job, self.fmi = job, job.fmi
        self.fmu = instantiate_fmu(folder, description, "CoSimulation")
        if self.fmi == 2:
            self.fmu.setupExperiment(startTime=0.0)
        apply_start_values(self.fmu, description, job.parameters | inputs)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def step(self, k: int) -> dict[str, float]:
        """Return the outputs after step k."""
        self.fmu.doStep(self.job.time(k), self.job.step)
        return {name: self.value(name) for name in self.job.outputs}

    def value(self, name: str) -> float:
        """Return the value of a variable."""
        reference, kind = self.job.variables[name]
        if kind == "Enumeration":
            kind = "Integer" if self.fmi == 2 else "Int64"
        elif self.fmi == 3:
            kind = {"Real": "Float64", "Integer": "Int32"}.get(kind, kind)
        return getattr(self.fmu, f"get{kind}")([reference])[0]


def main() -> None:
    """Do the job."""
    job = answers.read()
    if len(job.inputs) == 1 and not job.saves:
        answers.answer([simulated(job)])
        return
    folder = fmpy.extract(job.fmu)
    units = [Stepped(job, inputs, folder) for inputs in job.inputs]
    half = job.count // 2 if job.saves else job.count
    rows = [[unit.step(k) for unit in units] for k in range(half)]
    if job.saves:
        fmu = units[0].fmu
        state = fmu.getFMUState()
        write, parse = (
            (fmu.serializeFMUstate, fmu.deSerializeFMUstate)
            if job.fmi == 2
            else (fmu.serializeFMUState, fmu.deserializeFMUState)
        )
        data = write(state)
        for k in range(half, job.count):
            units[0].step(k)
        fmu.setFMUState(parse(data))
        rows += [[units[0].step(k)] for k in range(half, job.count)]
    answers.answer([list(of_one) for of_one in zip(*rows, strict=True)])


main()
