"""The report of `evcosim info` on an FMU, of any FMI version that FMPy reads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...cosim.errors import counted
from ..warned import first_kinds, with_count
from .console import number, print_fields, print_table
from .info_capabilities import capabilities, limitations

if TYPE_CHECKING:
    from ..fmi.fmu import Fmu

_DIGITS = 9
_MESSAGES, _LONGEST = 5, 240  # that are printed of a list of defects, and characters of each
_COLUMNS = ("name", "causality", "variability", "type", "unit", "start", "min", "max", "description")

_KINDS = {
    "coSimulation": "Co-Simulation",
    "modelExchange": "Model Exchange",
    "scheduledExecution": "Scheduled Execution",
}


def described(
    path: Path, causalities: Sequence[str], search: str | None, strict: bool = False
) -> dict[str, Any]:
    """Return the report on an FMU, with the variables of these causalities ([]: all) that contain `search`.

    Raises ConfigError if it is no FMU, no variable has such a causality, or with `strict` it has defects.
    """
    from ..builtin import library_of
    from ..fmi.fmu import read_fmu

    fmu = read_fmu(path, strict)
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
        "binary_for_this_machine": _has_binary(fmu),
        "library": library_of(fmu.digest),
        "sources": [name for name in fmu.entries if name.startswith("sources/") and name[-1] != "/"],
        "unpacked_size": fmu.unpacked,
        "python": fmu.holds_python,
        "capabilities": {word: capabilities(kind) for word, kind in kinds.items()},
        "limits": _limitations(kinds.values(), fmu.holds_python),
        "defects": list(fmu.defects),
        "validator": _validated(path),
        "default_experiment": _experiment(md.defaultExperiment),
        "units_of_measure": [unit.name for unit in md.unitDefinitions],
        "number_of_variables": len(variables),
        "variables": _selected(variables, causalities, search),
    }


def _has_binary(fmu: Fmu) -> bool:
    from ..fmi.fmu import FmuError

    try:
        return fmu.binary in fmu.entries
    except FmuError:  # Scheduled Execution alone: no binary is of use
        return False


def _limitations(kinds: Iterable[Any], holds_python: bool) -> list[dict[str, str]]:
    found = [limit for kind in kinds for limit in limitations(kind, holds_python)]
    return [limit for i, limit in enumerate(found) if limit not in found[:i]]


def _validated(path: Path) -> list[str]:
    """Return the messages of FMPy's validator about the description as it is in the file."""
    from ..fmi.validation import validated

    def short(message: str) -> str:
        return re.sub(r"^ERROR \(line (\d+), column \d+\): ", r"line \1: ", " ".join(message.split()))

    return [short(message) for message in validated(path)]


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
    """Return the columns of a variable, as the description writes them; "" for those that it leaves open."""
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
    """Print the report that `described` returned."""
    experiment = about["default_experiment"]
    several = len(about["kinds"]) > 1
    can = [(f"can ({kind})" if several else "can", found) for kind, found in about["capabilities"].items()]
    defects, messages = about["defects"], about["validator"]
    fields = [
        ("name", about["name"]),
        ("description", about["description"]),
        ("kind", f"FMI {about['fmi_version']} {', '.join(about['kinds'])}"),
        ("solver", _solver(about)),
        ("tool", about["tool"]),
        ("version", about["version"]),
        ("license", about["license"]),
        ("platforms", ", ".join(about["platforms"]) + (" (runs Python)" if about["python"] else "")),
        ("native", about["library"]),
        ("sources", _sources(about)),
        *(field for name, found in can for field in _listed(name, map(_with_meaning, found))),
        *_listed("limits", map(_with_meaning, about["limits"])),
        ("experiment", ", ".join(f"{name.replace('_', ' ')} {x:g}" for name, x in experiment.items())),
        *_listed("mended", _by_kind(defects)),
        *_listed("validator", _by_kind(messages)),
        ("file", f"{about['file']} ({_size(about['size'])}, unpacked {_size(about['unpacked_size'])})"),
        ("sha256", about["sha256"]),
    ]
    print_fields([(name, value) for name, value in fields if value])
    rows = [tuple(_short(v[column]) for column in _COLUMNS) for v in about["variables"]]
    print()
    if rows:
        print_table(_COLUMNS, rows, right=("start", "min", "max"))
    total = about["number_of_variables"]
    if len(rows) != total:
        print(f"\n{len(rows)} of {counted(total, 'variable')}")


def _solver(about: dict[str, Any]) -> str:
    """Return a sentence about the solver of Model Exchange; "" without that interface."""
    if _KINDS["modelExchange"] not in about["kinds"]:
        return ""
    asked = "" if len(about["kinds"]) == 1 else ', where interface = "model_exchange" asks for it'
    return f"CVODE with events solves Model Exchange{asked}"


def _sources(about: dict[str, Any]) -> str:
    """Return the source files, and without a binary for this machine the command that makes one."""
    files = ", ".join(_bounded([name.removeprefix("sources/") for name in about["sources"]]))
    if not files or about["binary_for_this_machine"]:
        return files
    return f"{files}; there is no binary for this machine: 'evcosim compile {about['file']}' makes one"


def _with_meaning(entry: dict[str, str]) -> str:
    return f"{entry['what']}: {entry['here']}"


def _listed(name: str, texts: Iterable[str]) -> list[tuple[str, str]]:
    """Return the lines of a field, with the name in the first."""
    return [(name if i == 0 else "", text) for i, text in enumerate(texts)]


def _bounded(texts: Sequence[str]) -> list[str]:
    """Return the first texts; --json has all of them."""
    more = len(texts) - _MESSAGES
    return [*texts[:_MESSAGES], *([f"and {more} more (--json shows all)"] if more > 0 else [])]


def _by_kind(texts: Sequence[str]) -> list[str]:
    """Return the first kinds of texts, shortened, with their counts; --json has all of them whole."""
    kinds, others = first_kinds(texts, _MESSAGES)
    shown = [
        with_count(text if len(text) <= _LONGEST else text[:_LONGEST] + " ...", n)
        for text, n in kinds.items()
    ]
    return [*shown, *([f"and {others} more (--json shows all)"] if others else [])]


def _size(count: int) -> str:
    return f"{count / 1024:.0f} KiB" if count < 10 << 20 else f"{count / (1 << 20):.0f} MiB"


def _short(text: str) -> str:
    """Return a number of many digits with six; the file and --json have all."""
    try:
        return number(float(text)) if len(text) > _DIGITS else text
    except ValueError:
        return text
