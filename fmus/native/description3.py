"""modelDescription.xml of FMI 3.0: the same variables, units, ranges and dependencies as in FMI 2.0.

FMI 3.0 wants the time of every FMU as a variable. The models that use it have it among their inputs; for any
other one it comes last, with the value reference after that of the last variable of the model.
"""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

from ...models.base import Model, Variable
from ..catalog import Experiment
from ..description import (
    Origin,
    add_items,
    add_log_and_experiment,
    add_sampled,
    add_units,
    dependencies,
    enumerations,
    headline,
    set_origin,
    set_value,
    variability,
    written,
)
from ..interface import Exposed, exposed

_TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}
_CAPABILITIES = {
    "canHandleVariableCommunicationStepSize": "true",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
}


def describe_3(model: type[Model], origin: Origin, experiment: Experiment) -> bytes:
    """Return the file's bytes, UTF-8. Raises ValueError that names model and variable of an unknown unit."""
    variables = exposed(model)
    root = Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=model.__name__,
        instantiationToken=origin.guid,
        description=headline(model),
        generationTool=origin.tool,
        variableNamingConvention="structured",
    )
    set_origin(root, origin)
    SubElement(root, "CoSimulation", {"modelIdentifier": model.__name__, **_CAPABILITIES})
    all_variables = _with_time(variables)
    add_units(root, model, all_variables)
    if used := enumerations(variables):
        definitions = SubElement(root, "TypeDefinitions")
        for enumeration in used:
            about = {"name": enumeration.__name__, "description": headline(enumeration)}
            add_items(SubElement(definitions, "EnumerationType", about), enumeration)
    add_log_and_experiment(root, experiment)
    declared = SubElement(root, "ModelVariables")
    for entry in all_variables:
        _add_variable(declared, entry, model.sampled)
    _add_structure(root, model, variables)
    annotation = SubElement(SubElement(root, "Annotations"), "Annotation", type="evcosim")
    add_sampled(annotation, model, variables)
    return written(root)


def _with_time(variables: tuple[Exposed, ...]) -> tuple[Exposed, ...]:
    """Return the variables with the time, where it is not among them."""
    if any(entry.causality == "independent" for entry in variables):
        return variables
    names = {entry.variable.name for entry in variables}
    name = next(name for name in ("time", "simulation_time", "independent_time") if name not in names)
    time = Variable(name, "Real", 0.0, "s", "Time at the end of the last step", independent=True)
    return (*variables, Exposed(len(variables), "independent", time))


def _add_variable(declared: Element, entry: Exposed, sampled: bool) -> None:
    v = entry.variable
    added = SubElement(declared, _TYPES[v.type], name=v.name, valueReference=str(entry.reference))
    added.set("description", v.description)
    added.set("causality", entry.causality)
    added.set("variability", variability(entry, sampled))
    if entry.causality in ("parameter", "output"):
        added.set("initial", "exact" if entry.causality == "parameter" else "calculated")
    set_value(added, entry)


def _add_structure(root: Element, model: type[Model], variables: Iterable[Exposed]) -> None:
    structure = SubElement(root, "ModelStructure")
    unknowns = dependencies(model, tuple(variables))
    at_once = [(output, known) for output, known, _ in unknowns]
    at_first = [(output, known) for output, _, known in unknowns]
    for tag, listed in (("Output", at_once), ("InitialUnknown", at_first)):
        for output, known in listed:
            depends = " ".join(map(str, known))
            SubElement(structure, tag, valueReference=str(output), dependencies=depends)
