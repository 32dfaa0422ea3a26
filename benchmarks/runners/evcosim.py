"""This project."""

from __future__ import annotations

import contextlib
import importlib.metadata
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from evcosim.cosim.system.system import EngineName
from evcosim.master.engine.compiled import straight
from evcosim.master.simulation import Simulation

from ..case import STEP_SIZE, Case
from ..fmus import fmu_of
from . import Measured


def version() -> str:
    """The version of evcosim."""
    return importlib.metadata.version("evcosim")


def measure(case: Case, folder: Path, engine: EngineName = "compiled") -> Measured:
    """Run a case, all units in this process."""
    system = write_system(case, folder)
    with as_in_a_long_run(), Simulation(system, engine=engine, trust=True) as simulation:
        simulation.step(1)  # what is made in the first step is no cost of a step
        before = simulation.loop_seconds
        simulation.run()
        seconds = simulation.loop_seconds - before
        outputs = _outputs(case, simulation)
    return Measured(seconds * case.steps / (case.steps - 1), outputs, "jacobi")


@contextlib.contextmanager
def as_in_a_long_run() -> Iterator[None]:
    """Let runs of any length within the block have the machine code that is made for long ones."""
    before, straight.WORTH = straight.WORTH, 0
    try:
        yield
    finally:
        straight.WORTH = before


def _outputs(case: Case, simulation: Simulation) -> NDArray[np.float64]:
    names = [[f"n{i}.y{s}" for s in range(case.signals)] for i in range(case.units)]
    if not case.record:
        return np.array([[simulation[name] for name in row] for row in names])
    # row k holds what is valid at t_k: what a unit shows after step k stands in row k + 1
    results = simulation.results
    return np.stack([np.stack([results[name][1:] for name in row], axis=-1) for row in names], axis=1)


def write_system(case: Case, folder: Path, algorithm: str = "jacobi", isolation: str = "none") -> Path:
    """The system file of a case, in a folder that gets all that it needs."""
    fmu = fmu_of(case, folder)
    lines = ['name = "ring"', "[experiment]", f"step_size = {STEP_SIZE}", f'algorithm = "{algorithm}"']
    lines.append('algebraic_loops = "iterate"')  # pythonfmu declares no dependencies
    lines.append(f"stop_time = {case.steps * STEP_SIZE!r}")
    for i in range(case.units):
        lines += [f"[units.n{i}]", f'fmu = "{fmu}"', f'isolation = "{isolation}"', f"[units.n{i}.parameters]"]
        lines += [f"{name} = {value!r}" for name, value in case.parameters(i).items()]
    if case.channel:
        _write_dbc(case, folder / "ring.dbc")
        lines += ["[buses.can0]", f'dbc = "{folder / "ring.dbc"}"']
    for i in range(case.units):
        for s in range(case.signals):
            lines += [
                "[[connect]]",
                f'from = "n{i - 1 if i else case.units - 1}.y{s}"',
                f'to = ["n{i}.u{s}"]',
            ]
            if case.channel:
                lines.append(f'via = "can0.M{i}_{s // 4}.S{i}_{s}"')
    if not case.record:
        lines.insert(1, "record = []")
    path = folder / "ring.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def _write_dbc(case: Case, path: Path) -> None:
    """Four signals of 16 bits to a message, one for each unit and four signals, sent at every step."""
    lines = ['VERSION ""', "", "BU_: N", ""]
    cycle = round(1000 * STEP_SIZE)
    messages = []
    for i in range(case.units):
        for first in range(0, case.signals, 4):
            number = len(messages)
            messages.append(number)
            lines.append(f"BO_ {100 + number} M{i}_{first // 4}: 8 N")
            for place, s in enumerate(range(first, min(first + 4, case.signals))):
                lines.append(f' SG_ S{i}_{s} : {16 * place}|16@1- (0.0009765625,0) [-30|30] "" N')
            lines.append("")
    lines.append('BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;')
    lines.append('BA_DEF_DEF_ "GenMsgCycleTime" 0;')
    lines += [f'BA_ "GenMsgCycleTime" BO_ {100 + number} {cycle};' for number in messages]
    path.write_text("\n".join(lines) + "\n")
