"""The relative tolerance that a unit gets: the system's, else the FMU's own, else that of our solver."""

from __future__ import annotations

from typing import Literal

from .fmu import Fmu, declared_number

Origin = Literal["system", "fmu", "default", "none"]
"""Who says the tolerance: the system file, the FMU's DefaultExperiment, our solver, or nobody."""

_OF_SOLVER = 1e-6


def takes_tolerance(fmu: Fmu) -> bool:
    """Return False for a slave of FMI 1.0, which nobody can tell one."""
    return fmu.interface_type == "model_exchange" or not fmu.description.fmiVersion.startswith("1")


def tolerance_of(fmu: Fmu, wanted: float | None) -> tuple[float | None, Origin]:
    """Return the relative tolerance for an FMU and who says it; `wanted` is the system's, if it says one.

    None where no unit gets one: a slave of FMI 1.0, and one in Co-Simulation whose FMU declares none.
    """
    if not takes_tolerance(fmu):
        return None, "none"
    if wanted is not None:
        return wanted, "system"
    solved = fmu.interface_type == "model_exchange"
    declared = declared_number(fmu.description.defaultExperiment, "tolerance")
    if declared is not None and 0.0 < declared < 1.0:
        return declared, "fmu"
    return (_OF_SOLVER, "default") if solved else (None, "none")
