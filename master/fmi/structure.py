"""The ModelStructure of a description: entries for variables that are not there are left out and reported."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

_NUMBERS_ONLY = re.compile(r"\d+")
_OF_FMI_3 = ("Output", "ContinuousStateDerivative", "ClockedState", "InitialUnknown", "EventIndicator")


def mend_structure(root: Any, places: Mapping[int, int]) -> list[str]:
    """Leave out unknowns that name no variable, and return a sentence for each.

    `places` are the indices of the variables of FMI 2.0, from 1 on, as the file counts them, and as they are
    without those that were left out.
    """
    if root.get("fmiVersion") == "2.0":
        return _by_index(root, places)
    if root.get("fmiVersion") != "1.0":
        return _by_reference(root)
    return []


def _by_index(root: Any, places: Mapping[int, int]) -> list[str]:
    defects, known = [], {str(old): str(new) for old, new in places.items()}
    states = len(root.findall("ModelStructure/Derivatives/Unknown"))
    root.set("numberOfContinuousStates", str(states))  # as the FMU counts them, whatever is left out below
    for unknown in list(root.iter("Unknown")):
        if wrong := _unknown_numbers(unknown, "index", known):
            what = f"is the index of none of {len(known)} variables"
            defects.append(f"ModelStructure, line {unknown.sourceline}: {wrong[0]!r} {what}; it is left out")
            unknown.getparent().remove(unknown)
            continue
        unknown.set("index", known[unknown.get("index")])
        if unknown.get("dependencies"):
            unknown.set("dependencies", " ".join(known[n] for n in unknown.get("dependencies").split()))
    for variable in root.findall("ModelVariables/ScalarVariable/Real[@derivative]"):
        state = variable.get("derivative")
        if state in known:
            variable.set("derivative", known[state])
        else:
            del variable.attrib["derivative"]
            name = variable.getparent().get("name")
            defects.append(f"{name}: derivative = {state!r} is the index of no variable; it is ignored")
    return defects


def _by_reference(root: Any) -> list[str]:
    defects = []
    references = {v.get("valueReference"): "" for v in root.find("ModelVariables")}
    for unknown in [u for name in _OF_FMI_3 for u in root.findall(f"ModelStructure/{name}")]:
        if wrong := _unknown_numbers(unknown, "valueReference", references):
            what = "is the value reference of no variable"
            defects.append(f"ModelStructure, line {unknown.sourceline}: {wrong[0]!r} {what}; it is left out")
            unknown.getparent().remove(unknown)
    for variable in root.findall("ModelVariables/*[@derivative]"):
        if (state := variable.get("derivative")) not in references:
            del variable.attrib["derivative"]
            name = variable.get("name")
            defects.append(
                f"{name}: derivative = {state!r} is the value reference of no variable; it is ignored"
            )
    return defects


def _unknown_numbers(unknown: Any, attribute: str, known: Mapping[str, str]) -> list[str]:
    numbers = [unknown.get(attribute) or "", *(unknown.get("dependencies") or "").split()]
    return [n for n in numbers if not _NUMBERS_ONLY.fullmatch(n) or n not in known]
