"""CoFmuPy: its coordinator's master, Jacobi without iterations."""

from __future__ import annotations

import importlib.metadata
import time
from pathlib import Path
from typing import Any

import numpy as np
from cofmupy.coordinator import Coordinator

from ..case import STEP_SIZE, Case
from ..fmus import fmu_of
from . import Measured, Unable


def version() -> str:
    """The version of CoFmuPy, and of pythonfmu, on whose release it insists."""
    return f"{importlib.metadata.version('cofmupy')} (pythonfmu {importlib.metadata.version('pythonfmu')})"


def measure(case: Case, folder: Path) -> Measured:
    """Run a case; what is recorded goes into its lists in memory."""
    if case.channel:
        raise Unable("has no CAN channel")
    coordinator = Coordinator()
    coordinator.start(_configuration(case, fmu_of(case, folder)))
    master = coordinator.master
    begin = time.perf_counter()
    for _ in range(case.steps):
        last = master.do_step(STEP_SIZE, record_outputs=case.record)
    seconds = time.perf_counter() - begin
    names = [[(f"n{i}", f"y{s}") for s in range(case.signals)] for i in range(case.units)]
    if case.record:
        found = coordinator.get_results()
        outputs = np.moveaxis(np.array([[found[name] for name in row] for row in names]), 2, 0)
    else:
        outputs = np.array([[last[unit][variable][0] for unit, variable in row] for row in names])
    return Measured(seconds, outputs, "jacobi")


def _configuration(case: Case, fmu: Path) -> dict[str, Any]:
    return {
        "fmus": [
            {"id": f"n{i}", "name": f"n{i}", "path": str(fmu), "initialization": case.parameters(i)}
            for i in range(case.units)
        ],
        "connections": [
            {
                "source": {"id": f"n{i - 1 if i else case.units - 1}", "variable": f"y{s}", "unit": ""},
                "target": [{"id": f"n{i}", "variable": f"u{s}", "unit": ""}],
            }
            for i in range(case.units)
            for s in range(case.signals)
        ],
        "cosim_method": "jacobi",
        "iterative": False,
    }
