"""What `evcosim info` says of an FMU, of any FMI version that FMPy reads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .console import counted, number, print_fields, print_table

_DIGITS = 9
_COLUMNS = ("name", "causality", "variability", "type", "unit", "start", "min", "max", "description")

_ABILITIES = {
    "canHandleVariableCommunicationStepSize": "takes steps of changing size",
    "canInterpolateInputs": "interpolates inputs within a step",
    "canGetAndSetFMUstate": "saves and restores its state",
    "canGetAndSetFMUState": "saves and restores its state",
    "canSerializeFMUstate": "writes its state to bytes",
    "canSerializeFMUState": "writes its state to bytes",
    "providesDirectionalDerivative": "gives directional derivatives",
    "providesDirectionalDerivatives": "gives directional derivatives",
    "providesAdjointDerivatives": "gives adjoint derivatives",
    "canRunAsynchronuously": "steps in the background",
    "mightReturnEarlyFromDoStep": "may end a step early",
    "canReturnEarlyAfterIntermediateUpdate": "ends a step early on request",
    "hasEventMode": "has an event mode",
    "providesIntermediateUpdate": "shows values within a step",
    "providesEvaluateDiscreteStates": "evaluates discrete states",
}
_LIMITS = {
    "needsCompletedIntegratorStep": "must be told of completed integrator steps",
    "canBeInstantiatedOnlyOncePerProcess": "one instance in a process",
    "canNotUseMemoryManagementFunctions": "allocates memory by itself",
    "needsExecutionTool": "needs an execution tool",
}
_KINDS = {
    "coSimulation": "Co-Simulation",
    "modelExchange": "Model Exchange",
    "scheduledExecution": "Scheduled Execution",
}


def described(path: Path, causalities: Sequence[str], search: str | None) -> dict[str, Any]:
    """All that is shown of an FMU, with the variables of these causalities (none: all) that hold `search`.

    Raises ConfigError when it is no FMU, or no variable has such a causality.
    """
    from ..fmi.fmu import read_fmu

    fmu = read_fmu(path)
    md = fmu.description
    kinds = {word: getattr(md, key) for key, word in _KINDS.items() if getattr(md, key, None) is not None}
    variables = [_variable(v) for v in md.modelVariables]
    return {
        "file": str(path),
        "size": path.stat().st_size,
        "sha256": fmu.digest,
        "name": md.modelName,
        "description": md.description or "",
        "fmi_version": md.fmiVersion,
        "kinds": list(kinds),
        "tool": md.generationTool or "",
        "version": md.version or "",
        "license": md.license or "",
        "platforms": list(fmu.platforms),
        "python": fmu.holds_python,
        "capabilities": {word: _capabilities(kind) for word, kind in kinds.items()},
        "limits": list(dict.fromkeys(limit for kind in kinds.values() for limit in _true(kind, _LIMITS))),
        "default_experiment": _experiment(md.defaultExperiment),
        "units_of_measure": [unit.name for unit in md.unitDefinitions],
        "number_of_variables": len(variables),
        "variables": _selected(variables, causalities, search),
    }


def _capabilities(kind: Any) -> list[str]:
    words = _true(kind, _ABILITIES)
    if order := int(getattr(kind, "maxOutputDerivativeOrder", 0) or 0):
        words.append(f"output derivatives up to order {order}")
    if step := getattr(kind, "fixedInternalStepSize", None):
        words.append(f"fixed internal step of {step} s")
    return words


def _true(kind: Any, words: dict[str, str]) -> list[str]:
    found = [text for name, text in words.items() if getattr(kind, name, None) in (True, "true")]
    return list(dict.fromkeys(found))  # FMI 2.0 and 3.0 spell some of the names differently


def _experiment(experiment: Any) -> dict[str, float]:
    names = {
        "start_time": "startTime",
        "stop_time": "stopTime",
        "step_size": "stepSize",
        "tolerance": "tolerance",
    }
    values = {name: getattr(experiment, key, None) for name, key in names.items()}
    return {name: float(value) for name, value in values.items() if value is not None}


def _variable(v: Any) -> dict[str, str]:
    """The columns of a variable, as the description writes them; what it leaves open is ""."""
    declared = v.declaredType

    def own_or_declared(name: str) -> str:
        own = getattr(v, name, None)
        value = own if own is not None else getattr(declared, name, None)
        return "" if value is None else str(value)

    about = {name: own_or_declared(name) for name in ("min", "max", "unit")}
    size = "".join(f"[{d.start if d.start is not None else d.variable.name}]" for d in v.dimensions or ())
    about |= {
        "name": str(v.name),
        "causality": str(v.causality or "local"),
        "variability": str(v.variability or ""),
        "type": str(v.type) + size,
        "start": "" if v.start is None else str(v.start),
        "description": str(v.description or ""),
    }
    if declared is not None and declared.items:
        about["description"] += " (" + ", ".join(f"{i.value} {i.name}" for i in declared.items) + ")"
    return {name: about[name] for name in _COLUMNS}


def _selected(
    variables: list[dict[str, str]], causalities: Sequence[str], search: str | None
) -> list[dict[str, str]]:
    from ...cosim.errors import ConfigError, nearest

    known = list(dict.fromkeys(v["causality"] for v in variables))
    for name in causalities:
        if name not in known:
            raise ConfigError(
                f"--causality {name}: no variable has it{nearest(name, known)}; there are {', '.join(known)}"
            )
    text = (search or "").casefold()
    return [
        v
        for v in variables
        if (not causalities or v["causality"] in causalities)
        and text in f"{v['name']} {v['description']}".casefold()
    ]


def show(about: dict[str, Any]) -> None:
    """Print what `described` gave."""
    experiment = about["default_experiment"]
    fields = [
        ("name", about["name"]),
        ("description", about["description"]),
        ("kind", f"FMI {about['fmi_version']} {', '.join(about['kinds'])}"),
        ("tool", about["tool"]),
        ("version", about["version"]),
        ("license", about["license"]),
        ("platforms", ", ".join(about["platforms"]) + (" (runs Python)" if about["python"] else "")),
        *((f"can ({kind})" if len(about["kinds"]) > 1 else "can", ", ".join(words))
          for kind, words in about["capabilities"].items()),
        ("limits", ", ".join(about["limits"])),
        ("experiment", ", ".join(f"{name.replace('_', ' ')} {x:g}" for name, x in experiment.items())),
        ("file", f"{about['file']} ({about['size'] / 1024:.0f} KiB)"),
        ("sha256", about["sha256"]),
    ]  # fmt: skip # one line for each field
    print_fields([(name, value) for name, value in fields if value])
    rows = [tuple(_short(v[column]) for column in _COLUMNS) for v in about["variables"]]
    print()
    if rows:
        print_table(_COLUMNS, rows, right=("start", "min", "max"))
    total = about["number_of_variables"]
    if len(rows) != total:
        print(f"\n{len(rows)} of {counted(total, 'variable')}")


def _short(text: str) -> str:
    """A number of many digits as people read it; the file and --json have them all."""
    try:
        return number(float(text)) if len(text) > _DIGITS else text
    except ValueError:
        return text
