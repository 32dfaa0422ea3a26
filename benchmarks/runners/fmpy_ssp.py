"""FMPy's `simulate_ssp`: a system of FMUs described by an SSP file, stepped in Python."""

from __future__ import annotations

import time
import zipfile
from pathlib import Path
from types import SimpleNamespace

import fmpy
import numpy as np
from fmpy.ssp import simulation

from ..case import STEP_SIZE, Case
from ..fmus import fmu_of
from . import Measured, Unable


def version() -> str:
    """The version of FMPy."""
    return str(fmpy.__version__)


def measure(case: Case, folder: Path) -> Measured:
    """Run a case. It records every connector always; extraction and instantiation are not timed."""
    if case.channel:
        raise Unable("has no CAN channel")
    if not case.record:
        raise Unable("records always")
    ssp = _write_ssp(case, folder)
    marks: list[float] = []
    step = simulation.do_step

    def first_step(*arguments: object) -> None:
        marks.append(time.perf_counter())
        simulation.do_step = step
        step(*arguments)

    free = simulation.free_fmu

    def first_free(component: object) -> None:
        if len(marks) == 1:
            marks.append(time.perf_counter())
        free(component)

    simulation.do_step, simulation.free_fmu = first_step, first_free
    try:
        rows = simulation.simulate_ssp(
            str(ssp),
            stop_time=(case.steps - 0.5) * STEP_SIZE,
            step_size=STEP_SIZE,
            parameter_set=_parameters(case),
        )
    finally:
        simulation.do_step, simulation.free_fmu = step, free
    outputs = np.array([[rows[f"{_name(i)}.y{s}"] for s in range(case.signals)] for i in range(case.units)])
    return Measured(marks[1] - marks[0], np.moveaxis(outputs, 2, 0), "jacobi")


def _name(unit: int) -> str:
    return f"n{unit:04d}"  # no name may begin with another one: parameters are found by it


def _parameters(case: Case) -> SimpleNamespace:
    parameters = []
    for i in range(case.units):
        parameters += [
            SimpleNamespace(name=f"{_name(i)}.{name}", value=x) for name, x in case.parameters(i).items()
        ]
    return SimpleNamespace(parameters=parameters)


def _write_ssp(case: Case, folder: Path) -> Path:
    fmu = fmu_of(case, folder)
    parts = []
    for i in range(case.units):
        kinds = [("input", f"u{s}") for s in range(case.signals)]
        kinds += [("output", f"y{s}") for s in range(case.signals)]
        connectors = "".join(
            f'<ssd:Connector name="{name}" kind="{kind}"><ssc:Real/></ssd:Connector>' for kind, name in kinds
        )
        parts.append(
            f'<ssd:Component name="{_name(i)}" type="application/x-fmu-sharedlibrary" '
            f'source="resources/{fmu.name}">'
            f"<ssd:Connectors>{connectors}</ssd:Connectors></ssd:Component>"
        )
    wires = "".join(
        f'<ssd:Connection startElement="{_name(i - 1 if i else case.units - 1)}" startConnector="y{s}" '
        f'endElement="{_name(i)}" endConnector="u{s}"/>'
        for i in range(case.units)
        for s in range(case.signals)
    )
    text = (
        '<?xml version="1.0" encoding="UTF-8"?><ssd:SystemStructureDescription '
        'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" '
        'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" '
        'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" name="ring" version="1.0">'
        f'<ssd:System name="ring"><ssd:Elements>{"".join(parts)}</ssd:Elements>'
        f"<ssd:Connections>{wires}</ssd:Connections></ssd:System></ssd:SystemStructureDescription>"
    )
    path = folder / "ring.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", text)
        archive.write(fmu, f"resources/{fmu.name}")
    return path
