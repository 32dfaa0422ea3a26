"""modelDescription.xml (FMI 2.0), generated from a model's declarations alone.

`Outputs` lists as dependencies the inputs that reach an output within one instant; a sampled model's outputs
hold between steps, so they have none. `InitialUnknowns` lists every parameter and the inputs that reach the
output during initialization: those that `initial` reads and those that feed through, or, in their place,
those that the variable's `initially` lists.
"""

from __future__ import annotations

import enum
import inspect
from collections.abc import Iterable, Sequence
from typing import NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from ..models.base import Model, Variable
from .catalog import Experiment
from .interface import Exposed, exposed
from .slave import ModelSlave
from .unit_definitions import define

_NEEDS_PYTHON = {"needsExecutionTool": "true"}  # an interpreter with the packages that the model imports
_CAPABILITIES = {
    "canHandleVariableCommunicationStepSize": "true",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}


class Origin(NamedTuple):
    """The origin of an FMU: `version` and `license` are the model's, `tool` built it."""

    guid: str
    tool: str
    version: str
    license: str


def describe(
    model: type[Model], origin: Origin, experiment: Experiment, c_sources: Sequence[str] = ()
) -> bytes:
    """Return the file's bytes, UTF-8. Raises ValueError that names model and variable of an unknown unit.

    An FMU that lists its C sources is made of them; any other one needs Python.
    """
    variables = exposed(model)
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=model.__name__,
        guid=origin.guid,
        description=headline(model),
        generationTool=origin.tool,
        variableNamingConvention="structured",
    )
    set_origin(root, origin)
    needed = {} if c_sources else _NEEDS_PYTHON
    slave = SubElement(root, "CoSimulation", {"modelIdentifier": model.__name__, **needed, **_CAPABILITIES})
    if c_sources:
        listed = SubElement(slave, "SourceFiles")
        for name in c_sources:
            SubElement(listed, "File", name=name)
    add_units(root, model, variables)
    _types(root, variables)
    add_log_and_experiment(root, experiment)
    tool = SubElement(SubElement(root, "VendorAnnotations"), "Tool", name="evcosim")
    add_sampled(tool, model, variables)
    declared = SubElement(root, "ModelVariables")
    for entry in variables:
        declared.append(_scalar_variable(entry, model.sampled))
    _structure(root, model, variables)
    return written(root)


def written(root: Element) -> bytes:
    """Return the bytes of an XML file, UTF-8, indented."""
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, "utf-8")
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + content + b"\n"


def set_origin(root: Element, origin: Origin) -> None:
    """Set version and license of a model, where there are any."""
    for name, value in (("version", origin.version), ("license", origin.license)):
        if value:
            root.set(name, value)


def add_log_and_experiment(root: Element, experiment: Experiment) -> None:
    """Add the categories of the log, and the experiment of an importer that is given none."""
    categories = SubElement(root, "LogCategories")
    for name, text in ModelSlave.log_categories.items():
        SubElement(categories, "Category", name=name, description=text)
    SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=repr(experiment.stop_time),
        stepSize=repr(experiment.step_size),
    )


def headline(described: type) -> str:
    """Return the first line of a class's own docstring, without code marks."""
    text = inspect.cleandoc(described.__doc__ or "") or described.__name__
    return text.splitlines()[0].replace("`", "")


def add_sampled(annotation: Element, model: type[Model], variables: Iterable[Exposed]) -> None:
    """Add to evcosim's annotation the outputs which hold from the time of their inputs on."""
    held = [
        entry.variable.name
        for entry in variables
        if entry.causality == "output" and variability(entry, model.sampled) == "discrete"
    ]
    SubElement(annotation, "Sampled", outputs=" ".join(held))


def add_units(root: Element, model: type[Model], variables: Iterable[Exposed]) -> None:
    """Add the definitions of the units of Real variables; no other type carries one.

    Raises ValueError that names model and variable of an unknown unit.
    """
    used = {}
    for _, _, v in variables:
        if v.type == "Real" and v.unit:
            try:
                used[v.unit] = define(v.unit)
            except ValueError as error:
                raise ValueError(f"{model.__name__}.{v.name}: {error}") from None
    if not used:
        return
    definitions = SubElement(root, "UnitDefinitions")
    for name, definition in sorted(used.items()):
        base = SubElement(SubElement(definitions, "Unit", name=name), "BaseUnit")
        for symbol, exponent in definition.exponents:
            base.set(symbol, str(exponent))
        if definition.factor != 1.0:
            base.set("factor", repr(definition.factor))
        if definition.offset != 0.0:
            base.set("offset", repr(definition.offset))


def _types(root: Element, variables: Iterable[Exposed]) -> None:
    if not (used := enumerations(variables)):
        return
    definitions = SubElement(root, "TypeDefinitions")
    for enumeration in used:
        about = {"name": enumeration.__name__, "description": headline(enumeration)}
        add_items(SubElement(SubElement(definitions, "SimpleType", about), "Enumeration"), enumeration)


def enumerations(variables: Iterable[Exposed]) -> list[type[enum.IntEnum]]:
    """Return the enumerations of variables, by their names."""
    found = {v.enumeration.__name__: v.enumeration for _, _, v in variables if v.enumeration is not None}
    return [found[name] for name in sorted(found)]


def add_items(definition: Element, enumeration: type[enum.IntEnum]) -> None:
    """Add the items of an enumeration to its definition."""
    for item in enumeration:
        about = {"name": item.name.lower(), "value": str(int(item)), **_text_of(item)}
        SubElement(definition, "Item", about)


def _text_of(item: enum.IntEnum) -> dict[str, str]:
    """Return an item's text as an attribute, where the enumeration gives its members a `text`."""
    text = getattr(item, "text", None)
    return {} if text is None else {"description": str(text)}


def _scalar_variable(entry: Exposed, sampled: bool) -> Element:
    v = entry.variable
    scalar = Element("ScalarVariable", name=v.name, valueReference=str(entry.reference))
    scalar.set("description", v.description)
    scalar.set("causality", entry.causality)
    scalar.set("variability", variability(entry, sampled))
    if entry.causality in ("parameter", "output"):
        scalar.set("initial", "exact" if entry.causality == "parameter" else "calculated")
    typed = SubElement(scalar, v.type)
    set_value(typed, entry)
    return scalar


def set_value(typed: Element, entry: Exposed) -> None:
    """Set the attributes of a variable that depend on its type: start value, range, unit of measure."""
    v = entry.variable
    if v.enumeration is not None:
        typed.set("declaredType", v.enumeration.__name__)
    if v.type == "Real":
        _set(typed, v, "unit", "nominal")
    if v.type != "Boolean":
        _set(typed, v, "min", "max")
    if entry.causality in ("parameter", "input"):
        typed.set("start", _number(v.start, v.type))


def variability(entry: Exposed, sampled: bool) -> str:
    """Return FMI's word for when a variable changes."""
    if entry.causality == "parameter":
        return "fixed"
    if entry.variable.type != "Real" or (sampled and entry.causality == "output"):
        return "discrete"
    return "continuous"


def _set(typed: Element, v: Variable, *attributes: str) -> None:
    for attribute in attributes:
        value = getattr(v, attribute)
        if value not in (None, ""):
            typed.set(attribute, value if attribute == "unit" else _number(value, v.type))


def _number(value: float, kind: str) -> str:
    """Return a number in FMI's form: Boolean in words, Integer and Enumeration as integers, Real lossless."""
    if kind == "Boolean":
        return "true" if value else "false"
    return repr(float(value)) if kind == "Real" else str(int(value))


def _structure(root: Element, model: type[Model], variables: tuple[Exposed, ...]) -> None:
    structure = SubElement(root, "ModelStructure")
    unknowns = dependencies(model, variables)
    if not unknowns:
        return
    now, initially = SubElement(structure, "Outputs"), SubElement(structure, "InitialUnknowns")
    for output, at_once, at_first in unknowns:
        for parent, known in ((now, at_once), (initially, at_first)):
            listed = " ".join(str(reference + 1) for reference in known)  # FMI 2.0 counts from 1
            SubElement(parent, "Unknown", index=str(output + 1), dependencies=listed)


def dependencies(model: type[Model], variables: Iterable[Exposed]) -> list[tuple[int, list[int], list[int]]]:
    """Return by value references each output, and on what it depends within an instant and at the start."""
    reference = {entry.variable.name: entry.reference for entry in variables}
    parameters = [entry.variable.name for entry in variables if entry.causality == "parameter"]
    found = []
    for entry in variables:
        v = entry.variable
        if entry.causality != "output":
            continue
        instant = () if model.sampled else v.depends
        reached = v.initially if v.initially is not None else (*model.initial_inputs, *v.depends)
        at_once, at_first = (
            sorted({reference[name] for name in names}) for names in (instant, (*parameters, *reached))
        )
        found.append((entry.reference, at_once, at_first))
    return found
