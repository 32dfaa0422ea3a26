"""The parts that FMPy's reader of descriptions leaves out: most of FMI 1.0, the limits of FMI 3.0's UInts,
which variables are differences (relativeQuantity), and evcosim's own annotation of sampled outputs."""

from __future__ import annotations

from typing import Any

from .types import INTEGER, fmi_type

_CAPABILITIES = (
    "canHandleVariableCommunicationStepSize",
    "canBeInstantiatedOnlyOncePerProcess",
    "canNotUseMemoryManagementFunctions",
    "canInterpolateInputs",
)


def supplement(description: Any, root: Any) -> None:
    """Complete FMPy's ModelDescription from the root element that it was read from."""
    if root.get("fmiVersion") == "1.0":
        _capabilities(description, root)
        if description.modelExchange is not None:
            description.modelExchange.needsCompletedIntegratorStep = True
            _dependencies(description, root)
        _causalities(description)
        _initial(description, root)
    else:
        _limits(description, root)
    _differences(description, root)


def sampled_outputs(root: Any) -> frozenset[str] | None:
    """Return the names of the sampled outputs that evcosim's annotation lists; None without one."""
    for path, key in (("VendorAnnotations/Tool", "name"), ("Annotations/Annotation", "type")):
        for annotation in root.iterfind(path):
            found = annotation.find("Sampled") if annotation.get(key) == "evcosim" else None
            if found is not None:
                return frozenset(found.get("outputs", "").split())
    return None


def _capabilities(description: Any, root: Any) -> None:
    """Read those of a slave of FMI 1.0; one of the type CoSimulation_Tool needs its tool."""
    for found in root.findall("Implementation/*"):
        if found.tag == "CoSimulation_Tool":
            description.coSimulation.needsExecutionTool = True
        for capabilities in found.findall("Capabilities"):
            for name in _CAPABILITIES:
                setattr(description.coSimulation, name, capabilities.get(name) in ("true", "1"))
            order = capabilities.get("maxOutputDerivativeOrder", "")
            description.coSimulation.maxOutputDerivativeOrder = int(order) if order.isdecimal() else 0


def _causalities(description: Any) -> None:
    for variable in description.modelVariables:
        if variable.causality in ("none", "internal"):
            variable.causality = "local"


def _dependencies(description: Any, root: Any) -> None:
    """List the outputs of Model Exchange with the inputs that reach them directly, where they are declared.

    A slave's outputs belong to its last step, whatever its inputs became.
    """
    from fmpy.model_description import Unknown

    inputs = {v.name: v for v in description.modelVariables if v.causality == "input"}
    declared = {v.get("name"): v.find("DirectDependency") for v in root.iter("ScalarVariable")}
    for variable in description.modelVariables:
        if variable.causality == "output":
            output = Unknown(variable=variable)
            if (given := declared.get(variable.name)) is not None:
                names = [(name.text or "").strip() for name in given.findall("Name")]
                output.dependencies = [inputs[name] for name in names if name in inputs]
            description.outputs.append(output)


def _initial(description: Any, root: Any) -> None:
    """Give variables with a start value the `initial` of FMI 2.0: `fixed` is true unless it says false."""
    typed = [(v.get("name"), c) for v in root.iter("ScalarVariable") for c in v if isinstance(c.tag, str)]
    guesses = {name for name, value in typed if value.get("fixed") in ("false", "0")}
    for variable in description.modelVariables:
        if variable.start is not None and variable.causality in ("output", "local"):
            variable.initial = "approx" if variable.name in guesses else "exact"


def _limits(description: Any, root: Any) -> None:
    limits = {v.get("name"): v for v in root.find("ModelVariables") if _is_unsigned(root, str(v.tag))}
    for variable in description.modelVariables if limits else ():
        if (found := limits.get(variable.name)) is not None:
            variable.min, variable.max = found.get("min"), found.get("max")


def _is_unsigned(root: Any, name: str) -> bool:
    kind = fmi_type(root.get("fmiVersion"), name)
    return kind is not None and kind.kind is INTEGER and kind.low == 0


def _differences(description: Any, root: Any) -> None:
    """Read relativeQuantity of variables: FMPy looks for it among the children of their elements."""
    given = {v.get("name"): _own_difference(v) for v in root.find("ModelVariables")}
    for variable in description.modelVariables:
        if (own := given.get(variable.name)) is not None:
            variable.relativeQuantity = own in ("true", "1")


def _own_difference(v: Any) -> str | None:
    """Return the attribute of a variable, which FMI 3.0 has on it and the others on its type's element."""
    return next((e.get("relativeQuantity") for e in (v, *v) if e.get("relativeQuantity") is not None), None)


def negated_aliases(root: Any) -> frozenset[str]:
    """Return the variables of FMI 1.0 whose value is that of their reference with the other sign."""
    return frozenset(v.get("name") for v in root.iter("ScalarVariable") if v.get("alias") == "negatedAlias")
