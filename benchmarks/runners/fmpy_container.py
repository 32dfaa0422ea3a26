"""FMPy's container FMU: the units inside one FMU, which a master calls once for the whole run."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import attrs
import fmpy
import numpy as np
from fmpy import extract, read_model_description
from fmpy.container_fmu import Configuration
from fmpy.container_fmu.cli import create_container_fmu
from fmpy.container_fmu.config import Component, Connection
from fmpy.fmi2 import FMU2Slave
from fmpy.model_description import CoSimulation, DefaultExperiment, ModelDescription, ModelVariable

from ..case import STEP_SIZE, Case
from ..fmus import fmu_of
from . import Measured, Unable


def version() -> str:
    """The version of FMPy."""
    return str(fmpy.__version__)


def measure(case: Case, folder: Path) -> Measured:
    """Run a case by one call of fmi2DoStep. Nothing can be recorded in between."""
    if case.channel:
        raise Unable("has no CAN channel")
    if case.record:
        raise Unable("records nothing: one call does all steps")
    container = _container(case, folder)
    description = read_model_description(container)
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=extract(container),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="ring",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    references = {v.name: v.valueReference for v in description.modelVariables}
    begin = time.perf_counter()
    slave.doStep(currentCommunicationPoint=0.0, communicationStepSize=case.steps * STEP_SIZE)
    seconds = time.perf_counter() - begin
    names = [references[f"n{i}_y{s}"] for i in range(case.units) for s in range(case.signals)]
    outputs = np.array(slave.getReal(names)).reshape(case.units, case.signals)
    return Measured(seconds, outputs, "jacobi")


def _container(case: Case, folder: Path) -> Path:
    fmu = fmu_of(case, folder)
    inner = read_model_description(str(fmu))
    known = {v.name: v for v in inner.modelVariables}
    # each unit from a file of its own: the container extracts them by the names of their files
    parts = []
    for i in range(case.units):
        copy = folder / f"part{i}.fmu"
        shutil.copy(fmu, copy)
        parts.append(Component(name=f"n{i}", filename=copy, modelDescription=inner))
    mappings: dict[ModelVariable, list[tuple[Component, ModelVariable]]] = {}
    for i, part in enumerate(parts):
        for name, value in case.parameters(i).items():
            mappings[_variable(f"n{i}_{name}", "parameter", str(value))] = [(part, known[name])]
        for s in range(case.signals):
            mappings[_variable(f"n{i}_y{s}", "output", None)] = [(part, known[f"y{s}"])]
    # the connections are read by the names of types of FMI 3.0 alone
    ys, us = (
        [attrs.evolve(known[f"{letter}{s}"], type="Float64") for s in range(case.signals)] for letter in "yu"
    )
    configuration = Configuration(
        parallelDoStep=False,
        modelDescription=ModelDescription(
            fmiVersion="2.0",
            modelName="ring",
            instantiationToken="",
            unitDefinitions=[],
            typeDefinitions=[],
            defaultExperiment=DefaultExperiment(stopTime="1", stepSize=str(STEP_SIZE)),
            coSimulation=CoSimulation(fixedInternalStepSize=STEP_SIZE),
            modelVariables=[
                ModelVariable(type="Real", variability="continuous", causality="independent", name="time"),
                *mappings,
            ],
        ),
        components=parts,
        connections=[Connection(parts[i - 1], ys, parts[i], us) for i in range(case.units)],
        variableMappings=mappings,
    )
    scratch = folder / "container"
    scratch.mkdir()
    path = folder / "container.fmu"
    create_container_fmu(configuration, scratch, path)
    return path


def _variable(name: str, causality: str, start: str | None) -> ModelVariable:
    fixed = causality == "parameter"
    return ModelVariable(
        type="Real",
        name=name,
        causality=causality,
        variability="fixed" if fixed else "continuous",
        initial="exact" if fixed else "calculated",
        start=start,
    )
