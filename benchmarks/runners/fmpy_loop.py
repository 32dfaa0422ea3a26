"""A loop of one's own over FMPy: its raw calls with arguments made once, as a careful script has them."""

from __future__ import annotations

import ctypes
import time
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from ..case import STEP_SIZE, Case
from ..fmus import fmu_of
from . import Measured, Unable


def version() -> str:
    """The version of FMPy."""
    return str(fmpy.__version__)


def measure(case: Case, folder: Path) -> Measured:
    """Run a case: all units take their inputs, then all step and show their outputs."""
    if case.channel:
        raise Unable("has no CAN channel")
    fmu = fmu_of(case, folder)
    description = read_model_description(str(fmu))
    references = {v.name: v.valueReference for v in description.modelVariables}
    units = [_unit(case, i, str(fmu), description, references) for i in range(case.units)]
    n = case.signals
    values = np.zeros((case.units, n))
    rows = np.empty((case.steps if case.record else 1, case.units, n))
    parts = [(ctypes.c_double * n).from_buffer(values[i].data) for i in range(case.units)]
    ins = (ctypes.c_uint * n)(*(references[f"u{s}"] for s in range(n)))
    outs = (ctypes.c_uint * n)(*(references[f"y{s}"] for s in range(n)))
    count, h, flag, now = ctypes.c_size_t(n), ctypes.c_double(STEP_SIZE), ctypes.c_int(1), ctypes.c_double()
    setters = [(u.dll.fmi2SetReal, (u.component, ins, count, parts[i - 1])) for i, u in enumerate(units)]
    steppers = [
        (u.dll.fmi2DoStep, (u.component, now, h, flag), u.dll.fmi2GetReal, (u.component, outs, count, part))
        for u, part in zip(units, parts, strict=True)
    ]
    status = 0
    begin = time.perf_counter()
    for k in range(case.steps):
        now.value = k * STEP_SIZE
        for function, arguments in setters:
            status |= function(*arguments)
        for step, to_step, get, to_get in steppers:
            status |= step(*to_step) | get(*to_get)
        if case.record:
            rows[k] = values
    seconds = time.perf_counter() - begin
    if status:
        raise Unable(f"a call returned status {status}")
    return Measured(seconds, rows if case.record else values, "jacobi")


def _unit(case: Case, unit: int, fmu: str, description: Any, references: dict[str, int]) -> FMU2Slave:
    """An initialized instance; its functions return their status and check nothing."""
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=extract(fmu),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=f"n{unit}",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    given = case.parameters(unit)
    slave.setReal([references[name] for name in given], list(given.values()))
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.dll = ctypes.PyDLL(None, handle=slave.dll._handle)
    slave.component = ctypes.c_void_p(slave.component)
    return slave
