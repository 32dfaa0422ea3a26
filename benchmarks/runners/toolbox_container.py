"""The container FMU of fmu-manipulation-toolbox, in its default (parallel) schedule."""

from __future__ import annotations

import ctypes
import importlib.metadata
import json
import subprocess
import sys
import time
from pathlib import Path

import fmpy  # loads the container; the loop calls it directly
import fmu_manipulation_toolbox  # noqa: F401 - ImportError where it is not installed
import numpy as np
from fmpy.fmi2 import FMU2Slave

from ..case import STEP_SIZE, Case
from ..fmus import fmu_of
from . import Measured, Unable


def version() -> str:
    """The version of fmu-manipulation-toolbox."""
    return importlib.metadata.version("fmu-manipulation-toolbox")


def measure(case: Case, folder: Path) -> Measured:
    """Run a case: the container does one step of its own in each call, or all of them in one."""
    if case.channel:
        raise Unable("has no CAN channel")
    if case.record:
        raise Unable("its data log is written to a file without an end that can be told apart")
    path = _container(case, folder)
    description = fmpy.read_model_description(str(path))
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(path)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="ring",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    references = {v.name: v.valueReference for v in description.modelVariables}
    for i in range(case.units):
        for name, value in case.parameters(i).items():
            slave.setReal([references[f"n{i}_{name}"]], [value])
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    step = ctypes.CDLL(None, handle=slave.dll._handle).fmi2DoStep
    arguments = (
        ctypes.c_void_p(slave.component),
        ctypes.c_double(0.0),
        ctypes.c_double(case.steps * STEP_SIZE),
    )
    begin = time.perf_counter()
    status = step(*arguments, ctypes.c_int(1))
    seconds = time.perf_counter() - begin
    if status:
        raise Unable(f"its step returned status {status}")
    names = [references[f"n{i}_y{s}"] for i in range(case.units) for s in range(case.signals)]
    outputs = np.array(slave.getReal(names)).reshape(case.units, case.signals)
    return Measured(seconds, outputs, "jacobi")


def _container(case: Case, folder: Path) -> Path:
    fmu = fmu_of(case, folder)
    inner = folder / "inner"
    inner.mkdir()
    names = [f"n{i}.fmu" for i in range(case.units)]
    for name in names:
        (inner / name).write_bytes(fmu.read_bytes())
    signals = range(case.signals)
    links = [[names[i - 1], f"y{s}", names[i], f"u{s}"] for i in range(case.units) for s in signals]
    outputs = [[names[i], f"y{s}", f"n{i}_y{s}"] for i in range(case.units) for s in signals]
    parameters = [
        [f"n{i}_{name}", names[i], name]
        for i in range(case.units)
        for name in ("gain", *(f"bias{s}" for s in signals))
    ]
    description = {
        "name": "ring.fmu", "fmu": names, "step_size": STEP_SIZE, "link": links, "output": outputs,
        "input": parameters, "auto_link": False, "auto_input": False, "auto_output": False,
        "auto_parameter": False, "auto_local": False,
    }  # fmt: skip # one table
    (inner / "ring.json").write_text(json.dumps(description))
    tool = Path(sys.executable).with_name("fmucontainer")
    command = [str(tool), "-fmu-directory", str(inner), "-container", "ring.json"]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    path = inner / "ring.fmu"
    if not path.exists():
        raise Unable(f"fmucontainer: {(made.stdout + made.stderr).strip().splitlines()[-1]}")
    return path
