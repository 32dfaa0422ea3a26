"""ecospy: the Python interface of Ecos, fixed-step algorithm."""

from __future__ import annotations

import contextlib
import csv
import ctypes
import importlib.metadata
import time
from pathlib import Path

import numpy as np

with contextlib.suppress(importlib.metadata.PackageNotFoundError):  # without the wheel the system may have it
    for _file in importlib.metadata.files("tbb") or ():
        if _file.name == "libtbb.so.12":  # Ecos is linked to it and its wheel does not bring it
            ctypes.CDLL(str(_file.locate()), mode=ctypes.RTLD_GLOBAL)

from ecospy import EcosSimulation, EcosSimulationStructure

from ..case import STEP_SIZE, Case
from ..fmus import fmu_of
from . import Measured, Unable


def version() -> str:
    """The version of ecospy."""
    return importlib.metadata.version("ecospy")


def measure(case: Case, folder: Path) -> Measured:
    """Run a case; what is recorded goes into its CSV writer, the only way that it has."""
    if case.channel:
        raise Unable("has no CAN channel")
    fmu = fmu_of(case, folder)
    structure = EcosSimulationStructure()
    parameters: dict[str, float] = {}
    for i in range(case.units):
        structure.add_model(f"n{i}", str(fmu))
        parameters |= {f"n{i}::{name}": value for name, value in case.parameters(i).items()}
        for s in range(case.signals):
            before = i - 1 if i else case.units - 1
            structure.make_real_connection(f"n{before}::y{s}", f"n{i}::u{s}")
    structure.add_parameter_set("initialValues", parameters)
    names = [[f"n{i}::y{s}" for s in range(case.signals)] for i in range(case.units)]
    table = folder / "ecos.csv"
    simulation = EcosSimulation(structure=structure, step_size=STEP_SIZE)
    if case.record:
        simulation.add_csv_writer(str(table), identifiers=[name for row in names for name in row])
    simulation.init(parameter_set="initialValues")
    begin = time.perf_counter()
    simulation.step(case.steps)
    seconds = time.perf_counter() - begin
    outputs = np.array([[simulation.get_real(name) for name in row] for row in names])
    simulation.terminate()
    simulation.free()
    if case.record:
        return Measured(seconds, _read(table, case), "jacobi", digits=1e-6)  # its CSV has six decimals
    return Measured(seconds, outputs, "jacobi")


def _read(table: Path, case: Case) -> np.ndarray:
    with table.open() as file:
        rows = list(csv.reader(file))
    names = [name.strip() for name in rows[0]]
    places = [
        next(j for j, name in enumerate(names) if name.startswith((f"n{i}::y{s}", f"n{i}.y{s}")))
        for i in range(case.units)
        for s in range(case.signals)
    ]
    values = np.array([[float(row[j]) for j in places] for row in rows[-case.steps :]])
    return values.reshape(case.steps, case.units, case.signals)
