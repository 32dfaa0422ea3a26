"""PathSim with pathsim-fmi: a block of co-simulation between constants and a scope."""

from __future__ import annotations

import answers
from pathsim import Connection, Simulation
from pathsim.blocks import Constant, Scope
from pathsim_fmi import CoSimulationFMU


def main() -> None:
    """Do the job."""
    job = answers.read()
    units = [
        CoSimulationFMU(job.fmu, f"unit{number}", start_values=job.parameters | inputs, dt=job.step)
        for number, inputs in enumerate(job.inputs)
    ]
    sources, connections = [], []
    for unit, inputs in zip(units, job.inputs, strict=True):
        for name in unit.fmu_wrapper.input_refs:  # without a connection an input is 0
            sources.append(Constant(float(inputs[name])))
            connections.append(Connection(sources[-1], unit[name]))
    scopes = []
    for unit in units:
        scopes.append(Scope(labels=list(unit.fmu_wrapper.output_refs)))
        connections += [
            Connection(unit[name], scopes[-1][n]) for n, name in enumerate(unit.fmu_wrapper.output_refs)
        ]
    Simulation([*sources, *units, *scopes], connections, dt=job.step, log=False).run(job.time(job.count))
    rows = []
    for unit, scope in zip(
        units, scopes, strict=True
    ):  # the step that begins at a time is taken at that time: no row of the start
        values = dict(zip(unit.fmu_wrapper.output_refs, scope.read()[1], strict=True))
        rows.append([{name: values[name][k] for name in job.outputs} for k in range(job.count)])
    answers.answer(rows)


main()
