"""fmuloader: its binding of the functions of FMI."""

from __future__ import annotations

from typing import Any

import answers
import fmuloader.fmi2
import fmuloader.fmi3
from lxml import etree

GETTERS = {
    "Real": ("real", "float64"),
    "Enumeration": ("integer", "int64"),
    "Boolean": ("boolean", "boolean"),
}
GETTERS["Integer"] = ("integer", "int32")


class Stepped:
    """An instance; `named` is its description's identifier and token."""

    def __init__(self, job: answers.Job, inputs: dict[str, Any], named: tuple[str, str]) -> None:
        self.job = job
        if job.fmi == 2:
            self.fmu: Any = fmuloader.fmi2.Fmi2Slave(job.fmu, model_identifier=named[0])
            self.fmu.instantiate("unit", fmuloader.fmi2.Fmi2Type.CO_SIMULATION, named[1])
            self.fmu.setup_experiment(start_time=0.0)
        else:
            self.fmu = fmuloader.fmi3.Fmi3Slave(job.fmu, model_identifier=named[0])
            self.fmu.instantiate_co_simulation("unit", instantiation_token=named[1])
        for name, value in (job.parameters | inputs).items():
            getattr(self.fmu, f"set_{self.kind(name)}")([job.variables[name][0]], [value])
        self.fmu.enter_initialization_mode()
        self.fmu.exit_initialization_mode()

    def kind(self, name: str) -> str:
        """Return the type in the names of the functions."""
        return GETTERS[self.job.variables[name][1]][self.job.fmi - 2]

    def step(self, k: int) -> dict[str, float]:
        """Return the outputs after step k."""
        self.fmu.do_step(self.job.time(k), self.job.step)
        return {
            name: getattr(self.fmu, f"get_{self.kind(name)}")([self.job.variables[name][0]])[0]
            for name in self.job.outputs
        }


def named(path: str) -> tuple[str, str]:
    """Return identifier and token of an FMU."""
    import zipfile

    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("modelDescription.xml"))
    token = root.get("guid") or root.get("instantiationToken")
    return root.find("CoSimulation").get("modelIdentifier"), token


def main() -> None:
    """Do the job."""
    job = answers.read()
    units = [Stepped(job, inputs, named(job.fmu)) for inputs in job.inputs]
    half = job.count // 2 if job.saves else job.count
    rows = [[unit.step(k) for unit in units] for k in range(half)]
    if job.saves:
        fmu = units[0].fmu
        data = fmu.serialize_fmu_state(fmu.get_fmu_state())
        for k in range(half, job.count):
            units[0].step(k)
        fmu.set_fmu_state(fmu.deserialize_fmu_state(data))
        rows += [[units[0].step(k)] for k in range(half, job.count)]
    answers.answer([list(of_one) for of_one in zip(*rows, strict=True)])


main()
