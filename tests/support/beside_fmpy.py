"""An FMU in FMPy and in evcosim at equal tolerance: how far they are apart, and each from the limit.

.venv/bin/python tests/support/beside_fmpy.py FILE.fmu --tolerance 1e-4

The limit is what evcosim computes at the finest tolerance; there FMPy is next to it, or the two mean
different things. Distances are shares of an output's range. Nothing drives the inputs; the times are equal.
"""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evcosim import simulate
from evcosim.cosim.interface import InterfaceType
from evcosim.master.fmi.fmu import Fmu, read_fmu
from evcosim.master.fmi.tolerance import tolerance_of

FINEST = 1e-12
_KINDS = {"co_simulation": "CoSimulation", "model_exchange": "ModelExchange"}


@dataclasses.dataclass(frozen=True)
class Course:
    """The outputs of a run, each of shape (n,), by name, over `time` [s], shape (n,)."""

    time: NDArray[np.float64]
    values: dict[str, NDArray[np.float64]]


@dataclasses.dataclass(frozen=True)
class Distance:
    """The largest distance of two courses, as a share of the output's range, with its output and time [s]."""

    share: float
    output: str
    time: float

    def __str__(self) -> str:
        return f"{self.share:.2g} of the range of {self.output}, at t = {self.time:.6g} s"


def in_evcosim(fmu: Fmu, tolerance: float | None, **options: Any) -> Course:
    """Run the FMU in evcosim, over its default experiment where `options` say nothing else."""
    results = simulate(fmu.path, tolerance=tolerance, interface=fmu.interface_type, **options)
    return Course(results.time, {name: results[f"fmu.{name}"].astype(float) for name in outputs(fmu)})


def in_fmpy(fmu: Fmu, tolerance: float | None, time: NDArray[np.float64], **start: float) -> Course:
    """Run the FMU in FMPy, with a row at each of these equidistant times [s], and these start values."""
    from fmpy import simulate_fmu

    found = simulate_fmu(
        str(fmu.path), validate=False, start_time=time[0], stop_time=time[-1],
        output_interval=float((time[-1] - time[0]) / (len(time) - 1)), relative_tolerance=tolerance,
        fmi_type=_KINDS[fmu.interface_type], output=outputs(fmu), record_events=False,
        start_values=start,
    )  # fmt: skip # all that differs from FMPy's defaults
    return Course(found["time"], {name: found[name].astype(float) for name in outputs(fmu)})


def outputs(fmu: Fmu) -> list[str]:
    """Return the outputs that are numbers."""
    return [v.name for v in fmu.interface.of_causality("output") if v.type != "String"]


def distance(one: Course, other: Course) -> Distance:
    """Return the largest distance over the rows that both have; the range is that of `other`."""
    n = min(len(one.time), len(other.time))
    np.testing.assert_allclose(one.time[:n], other.time[:n], atol=1e-9 * max(1.0, abs(other.time[-1])))
    worst = Distance(0.0, "", float(other.time[0]))
    for name, reference in other.values.items():
        apart = np.abs(one.values[name][:n] - reference[:n])
        k, span = int(np.argmax(apart)), float(np.ptp(reference)) or 1.0
        if apart[k] / span > worst.share:
            worst = Distance(float(apart[k] / span), name, float(other.time[k]))
    return worst


def told(path: Path, tolerance: float | None, interface: InterfaceType | None) -> str:
    """Return what the program prints, a line for each distance."""
    fmu = read_fmu(path).using(interface)
    used, _ = tolerance_of(fmu, tolerance)
    ours, limit = in_evcosim(fmu, used), in_evcosim(fmu, FINEST)
    theirs, their_limit = (in_fmpy(fmu, each, ours.time) for each in (used, FINEST))
    return "\n".join(
        [
            f"{path.name}, {_KINDS[fmu.interface_type]}, {len(ours.time)} rows, tolerance {used or 'none'}",
            f"apart                  {distance(theirs, ours)}",
            f"FMPy from the limit    {distance(theirs, limit)}",
            f"evcosim from the limit {distance(ours, limit)}",
            f"apart at {FINEST:g}         {distance(their_limit, limit)}",
        ]
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("fmu", type=Path, metavar="FILE.fmu")
    parser.add_argument("--tolerance", type=float, help="relative; default: as evcosim takes it")
    parser.add_argument("--interface", choices=sorted(_KINDS))
    given = parser.parse_args()
    print(told(given.fmu, given.tolerance, given.interface))
