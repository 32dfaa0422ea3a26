"""The capabilities that an FMU declares, and their meaning in a run of evcosim."""

from __future__ import annotations

from typing import Any

from ..fmi.fmu import is_true

_UNUSED = "not used here"
_STATE = "not used in a run; 'evcosim check --try' tests it"
_ABILITIES = {
    "canHandleVariableCommunicationStepSize": (
        "takes steps of changing size", "all steps of a run are equal; `substeps` divides them"),
    "canInterpolateInputs": (
        "interpolates inputs within a step", "not used here: inputs are held over a step"),
    "canGetAndSetFMUstate": ("saves and restores its state", _STATE),
    "canGetAndSetFMUState": ("saves and restores its state", _STATE),
    "canSerializeFMUstate": ("writes its state to bytes", _UNUSED),
    "canSerializeFMUState": ("writes its state to bytes", _UNUSED),
    "providesDirectionalDerivative": ("gives directional derivatives", _UNUSED),
    "providesDirectionalDerivatives": ("gives directional derivatives", _UNUSED),
    "providesAdjointDerivatives": ("gives adjoint derivatives", _UNUSED),
    "canRunAsynchronuously": (
        "steps in the background", "not used here: a step that is answered with Pending stops the run"),
    "mightReturnEarlyFromDoStep": (
        "may end a step early", "that is not allowed here: such a step stops the run"),
    "canReturnEarlyAfterIntermediateUpdate": ("ends a step early on request", "never requested here"),
    "hasEventMode": ("has an event mode", "Co-Simulation runs without it here"),
    "providesIntermediateUpdate": ("shows values within a step", _UNUSED),
    "providesEvaluateDiscreteStates": ("evaluates discrete states", _UNUSED),
}  # fmt: skip # a table: attribute, words, what it means here
_LIMITS = {
    "needsCompletedIntegratorStep": (
        "must be told of completed integrator steps", "concerns Model Exchange alone"),
    "canBeInstantiatedOnlyOncePerProcess": (
        "one instance in a process", "further units of it need a process each, the default for others' FMUs"),
    "canNotUseMemoryManagementFunctions": ("allocates memory by itself", "makes no difference here"),
    "needsExecutionTool": ("needs an execution tool", "the tool that made it has to be installed"),
}  # fmt: skip # a table, as above


def capabilities(kind: Any) -> list[dict[str, str]]:
    """Return the capabilities of an interface (FMPy's CoSimulation, ...): `what`, and its effect `here`."""
    found = _true(kind, _ABILITIES)
    if order := int(getattr(kind, "maxOutputDerivativeOrder", 0) or 0):
        found.append(_entry(f"output derivatives up to order {order}", _UNUSED))
    if step := getattr(kind, "fixedInternalStepSize", None):
        here = "choose period and substeps so that the FMU's step is a multiple of it"
        found.append(_entry(f"fixed internal step of {step} s", here))
    return found


def limitations(kind: Any, holds_python: bool) -> list[dict[str, str]]:
    """Return the needs and limits of an interface, in the same form."""
    found = _true(kind, _LIMITS)
    for limit in found if holds_python else ():
        if limit["what"] == _LIMITS["needsExecutionTool"][0]:
            limit["here"] = "Python, which is there: it runs in the interpreter of its process"
    return found


def _true(kind: Any, table: dict[str, tuple[str, str]]) -> list[dict[str, str]]:
    entries = dict(entry for name, entry in table.items() if is_true(kind, name))
    return [_entry(*entry) for entry in entries.items()]  # FMI 2.0 and 3.0 spell some names differently


def _entry(what: str, here: str) -> dict[str, str]:
    return {"what": what, "here": here}
