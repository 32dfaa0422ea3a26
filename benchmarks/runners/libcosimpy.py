"""libcosimpy: the Python interface of libcosim, fixed-step algorithm."""

from __future__ import annotations

import importlib.metadata
import time
from pathlib import Path

import numpy as np
from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from ..case import STEP_SIZE, Case
from ..fmus import fmu_of
from . import Measured, Unable


def version() -> str:
    """The version of libcosimpy."""
    return importlib.metadata.version("libcosimpy")


def measure(case: Case, folder: Path) -> Measured:
    """Run a case; what is recorded goes into a time-series observer in memory."""
    if case.channel:
        raise Unable("has no CAN channel")
    fmu = fmu_of(case, folder)
    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_step_size(round(STEP_SIZE * 1e9))
    slaves = [execution.add_local_slave(CosimLocalSlave(str(fmu), f"n{i}")) for i in range(case.units)]
    references = {v.name.decode(): v.reference for v in execution.slave_variables(slaves[0])}
    for i, slave in enumerate(slaves):
        for name, value in case.parameters(i).items():
            execution.real_initial_value(slave, references[name], value)
        for s in range(case.signals):
            execution.connect_real_variables(slaves[i - 1], references[f"y{s}"], slave, references[f"u{s}"])
    outputs = [references[f"y{s}"] for s in range(case.signals)]
    observer = _observer(case, execution, slaves, outputs)
    begin = time.perf_counter()
    if not execution.step(case.steps):
        raise Unable("its step failed")
    seconds = time.perf_counter() - begin
    if case.record:
        found = [
            [observer.time_series_real_samples(slave, r, 1, case.steps)[2] for r in outputs]
            for slave in slaves
        ]
        return Measured(seconds, np.moveaxis(np.array(found), 2, 0), "jacobi")
    last = [observer.last_real_values(slave, outputs) for slave in slaves]
    return Measured(seconds, np.array(last), "jacobi")


def _observer(case: Case, execution: CosimExecution, slaves: list[int], outputs: list[int]) -> CosimObserver:
    if not case.record:
        observer = CosimObserver.create_last_value()
        execution.add_observer(observer)
        return observer
    observer = CosimObserver.create_time_series(buffer_size=case.steps + 1)
    execution.add_observer(observer)
    for slave in slaves:
        for reference in outputs:
            observer.start_time_series(slave, reference, CosimVariableType.REAL)
    return observer
