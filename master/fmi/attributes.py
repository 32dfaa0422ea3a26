"""The parts of a description beside its variables: defects that FMPy does not read are mended."""

from __future__ import annotations

import math
import re
from typing import Any

_WHOLE = r"\s*[+-]?\d+\s*"
_COUNT = r"\s*\+?\d+\s*"
_COUNTED = ("numberOfEventIndicators", "numberOfContinuousStates")
_TIMES = ("startTime", "stopTime", "tolerance", "stepSize")
_CAPABILITIES = {
    "maxOutputDerivativeOrder": _WHOLE,
    "recommendedIntermediateInputSmoothness": _WHOLE,
    "fixedInternalStepSize": "",
}
_OF_TYPES = {"name", "description", "quantity", "unit", "displayUnit", "relativeQuantity", "min", "max"}
_OF_TYPES |= {"nominal", "unbounded", "value"}
_EXPONENT = r"\s*[+-]?\d{1,3}\s*"
_EXPONENTS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


def mend_attributes(root: Any) -> list[str]:
    """Mend the parts of a description beside its variables, and return a sentence for each defect."""
    defects = []
    if root.get("fmiVersion") == "1.0" and root.get("numberOfContinuousStates") is None:
        root.set("numberOfContinuousStates", "0")
    for name in wrong_counts(root):
        defects.append(f"{name} = {root.get(name)!r} is no number; 0 is assumed")
        root.set(name, "0")
    for name, pattern in _CAPABILITIES.items():
        for kind in root.findall(f"*[@{name}]"):
            if not _is_number(kind.get(name), pattern):
                defects.append(f"{kind.tag}: {name} = {kind.get(name)!r} is no number; it is ignored")
                del kind.attrib[name]
    for experiment in root.findall("DefaultExperiment"):
        for name in _TIMES:
            if (given := experiment.get(name)) is not None and not _is_number(given):
                defects.append(f"DefaultExperiment: {name} = {given!r} is no finite number; it is ignored")
                del experiment.attrib[name]
    return defects + _mend_units(root) + _mend_types(root)


def wrong_counts(root: Any) -> list[str]:
    """Return the names of the counts of states and event indicators that are no numbers from 0 on."""
    return [name for name in _COUNTED if (n := root.get(name)) is not None and not _is_number(n, _COUNT)]


def _mend_units(root: Any) -> list[str]:
    """Leave out the definition of a unit of measure whose factor is no number: any other would be a guess."""
    defects = []
    for base in root.findall("UnitDefinitions/Unit/BaseUnit"):
        wrong = [n for n in _EXPONENTS if not _is_number(base.get(n, "0"), _EXPONENT)]
        wrong += [n for n in ("factor", "offset") if not _is_number(base.get(n, "1"))]
        if wrong:
            unit = base.getparent()
            unit.remove(base)
            given = f"{wrong[0]} = {base.get(wrong[0])!r}"
            defects.append(
                f"unit of measure '{unit.get('name')}': {given} is no number; its definition is ignored"
            )
    displayed = "UnitDefinitions/Unit/DisplayUnit", "UnitDefinitions/BaseUnit/DisplayUnitDefinition"
    for element in [e for path in displayed for e in root.findall(path)]:
        if not all(_is_number(element.get(n, "1")) for n in ("factor", "offset", "gain")):
            element.getparent().remove(element)  # nothing here shows values in it
    return defects


def _mend_types(root: Any) -> list[str]:
    """Leave out types without content, and attributes that no type has."""
    defects = []
    for declared in [*root.findall("TypeDefinitions/SimpleType"), *root.findall("TypeDefinitions/Type")]:
        if not [child for child in declared if isinstance(child.tag, str)]:
            defects.append(f"type '{declared.get('name')}' says nothing; it is left out")
            declared.getparent().remove(declared)
    for content in [e for path in ("*", "*/*", "*/*/Item") for e in root.findall(f"TypeDefinitions/{path}")]:
        for name in set(content.attrib) - _OF_TYPES:
            del content.attrib[name]
    return defects + _mend_items(root)


def _mend_items(root: Any) -> list[str]:
    """Leave out the items of enumerations that have no name, or no number; those of FMI 1.0 are counted."""
    defects = []
    counted = root.get("fmiVersion") == "1.0"
    for item in [e for path in ("*/Item", "*/*/Item") for e in root.findall(f"TypeDefinitions/{path}")]:
        name, value = item.get("name"), item.get("value")
        if name is not None and (counted or re.fullmatch(_WHOLE, value or "")):
            continue
        said = "without a name" if name is None else f"'{name}' with the value {value!r}, no whole number"
        defects.append(f"line {item.sourceline}: an item {said}, is left out")
        item.getparent().remove(item)
    return defects


def _is_number(text: str, pattern: str = "") -> bool:
    try:
        finite = math.isfinite(float(text)) and "_" not in text
        return finite and (not pattern or re.fullmatch(pattern, text) is not None)
    except ValueError:
        return False
