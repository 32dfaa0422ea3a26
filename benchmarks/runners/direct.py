"""The lower bound: the FMI calls alone, in C. Nothing is recorded; no master can be faster."""

from __future__ import annotations

import ctypes
import time
import zipfile
from pathlib import Path

import numpy as np

from ..case import STEP_SIZE, Case
from ..fmus import c_fmu, c_library
from . import Measured, Unable


def version() -> str:
    """There is no version: it is a loop of 15 lines (sources/direct.c)."""
    return "-"


def measure(case: Case, folder: Path) -> Measured:
    """Run a case of C units without channel."""
    if case.kind != "c" or case.channel or case.record:
        raise Unable("the bare calls: C units, no channel, nothing recorded")
    node = _node(c_fmu(folder, case.signals), folder)
    units = [node.fmi2Instantiate(b"n", 1, b"", b"", None, 0, 0) for _ in range(case.units)]
    for i, unit in enumerate(units):
        constants = [case.gain(i), *(case.bias(i, s) for s in range(case.signals))]
        references = range(2 * case.signals, 3 * case.signals + 1)
        n = len(constants)
        node.fmi2SetReal(
            ctypes.c_void_p(unit),
            (ctypes.c_uint * n)(*references),
            ctypes.c_size_t(n),
            (ctypes.c_double * n)(*constants),
        )
    ring = ctypes.CDLL(str(c_library("direct.c", folder / "direct.so", f"-DSIGNALS={case.signals}"))).ring
    values = np.zeros((case.units, case.signals))
    inputs = (ctypes.c_uint * case.signals)(*range(case.signals))
    outputs = (ctypes.c_uint * case.signals)(*range(case.signals, 2 * case.signals))
    arguments = (
        (ctypes.c_void_p * case.units)(*units), ctypes.c_size_t(case.units),
        node.fmi2SetReal, node.fmi2DoStep, node.fmi2GetReal, inputs, outputs, ctypes.c_size_t(case.signals),
        values.ctypes.data_as(ctypes.c_void_p), ctypes.c_double(STEP_SIZE), ctypes.c_size_t(case.steps),
    )  # fmt: skip # as the parameters of `ring` stand
    begin = time.perf_counter()
    status = ring(*arguments)
    seconds = time.perf_counter() - begin
    if status:
        raise Unable(f"a call returned status {status}")
    return Measured(seconds, values, "jacobi")


def _node(fmu: Path, folder: Path) -> ctypes.CDLL:
    with zipfile.ZipFile(fmu) as archive:
        library = archive.extract(f"binaries/linux64/{fmu.stem}.so", folder)
    node = ctypes.CDLL(library)
    node.fmi2Instantiate.restype = ctypes.c_void_p
    return node
