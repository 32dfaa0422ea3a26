"""Warnings of an FMU's description: its defects, and declarations that a run may not respect.

These are the tool that it needs, the step that it can take, and a tolerance that it cannot be told.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ...cosim.errors import counted
from ..warned import first_kinds, with_count
from .fmu import Fmu, declared_step, is_true
from .tolerance import takes_tolerance

_SAME = 1e-9  # of a step: what differs by rounding alone
_SHOWN_DEFECTS = 5


def defects_of(fmu: Fmu) -> list[str]:
    """Return the first kinds of tolerated defects of the description, and the number of the others."""
    shown, others = first_kinds(fmu.defects, _SHOWN_DEFECTS)
    texts = [with_count(text, n) for text, n in shown.items()]
    texts += [counted(others, "more defect")] if others else []
    return [f"{fmu.path.name}: {text}" for text in texts]


def doubts(fmu: Fmu, steps: Sequence[float], tolerance: float | None = None) -> list[str]:
    """Return a clause for each declaration that the FMU's steps in a run, of these sizes [s], do not respect.

    The first of `steps` is that of all but the last. Only an interface for Co-Simulation has such.
    `tolerance` is that of the system file, if it has one.
    """
    said = [*_needs_tool(fmu), *_untold(fmu, tolerance)]
    if fmu.interface_type != "co_simulation":
        return said
    return [*said, *_other_step(fmu, steps[0]), *_changing_step(fmu, steps)]


def _untold(fmu: Fmu, tolerance: float | None) -> list[str]:
    if tolerance is None or takes_tolerance(fmu):
        return []
    return [f"is not told tolerance = {tolerance:g}: Co-Simulation of FMI 1.0 knows none"]


def _needs_tool(fmu: Fmu) -> list[str]:
    if not is_true(fmu.kind, "needsExecutionTool") or fmu.holds_python:
        return []
    tool = fmu.description.generationTool or "its tool"
    return [f"needs {tool} on the machine where it runs (needsExecutionTool)"]


def _other_step(fmu: Fmu, step: float) -> list[str]:
    """Return what is said of a step that is not the declared one."""
    internal = declared_step(fmu.kind, "fixedInternalStepSize")
    if internal is not None and abs(step / internal - round(step / internal)) > _SAME * step / internal:
        return [
            f"has internal steps of {internal:g} s (fixedInternalStepSize), of which its steps here, "
            f"{step:g} s, are no multiple{_ADVICE}"
        ]
    declared = declared_step(fmu.description.defaultExperiment, "stepSize")
    if internal is not None or declared is None or abs(step - declared) <= _SAME * declared:
        return []
    if is_true(fmu.kind, "canHandleVariableCommunicationStepSize"):
        return []
    return [f"takes steps of {declared:g} s{_FIXED}, and its steps here are of {step:g} s{_ADVICE}"]


def _changing_step(fmu: Fmu, steps: Sequence[float]) -> list[str]:
    """Return what is said of a last step that is shorter than the others."""
    if is_true(fmu.kind, "canHandleVariableCommunicationStepSize"):
        return []
    if all(math.isclose(step, steps[0], rel_tol=_SAME) for step in steps):
        return []
    return [
        f"takes steps of one size{_FIXED}, and its last step is of {steps[-1]:g} s, not of {steps[0]:g} s"
    ]


_FIXED = " only (canHandleVariableCommunicationStepSize is not true)"
_ADVICE = "; `step_size`, `period` and `substeps` make them"
