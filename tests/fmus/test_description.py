"""modelDescription.xml says what the declarations say."""

from __future__ import annotations

import fmpy
import pytest

from evcosim.fmus.interface import exposed
from evcosim.models.base import variables


@pytest.fixture(scope="module")
def mixed(toy):
    return toy("Mixed")


def test_every_declared_variable_is_described_as_declared(subject):
    description = fmpy.read_model_description(subject.path)
    declared = exposed(subject.model)
    assert [v.name for v in description.modelVariables] == [d.variable.name for d in declared]
    for v, (reference, causality, about) in zip(description.modelVariables, declared, strict=True):
        assert (v.valueReference, v.causality, v.type) == (reference, causality, about.type)
        assert v.description == about.description
        if about.type == "Real":
            assert (v.unit or "") == about.unit
        for attribute in ("min", "max", "nominal"):
            written, wanted = getattr(v, attribute), getattr(about, attribute)
            assert (written is None) == (wanted is None)
            assert wanted is None or float(written) == wanted
        if causality in ("parameter", "input"):
            start = {"true": 1.0, "false": 0.0}.get(v.start, v.start)
            assert float(start) == float(about.start)
        else:
            assert v.start is None


def test_variability_tells_sampled_from_continuous(subject):
    description = fmpy.read_model_description(subject.path)
    for v in description.modelVariables:
        if v.causality == "parameter":
            assert v.variability == "fixed"
        elif v.type != "Real" or (subject.model.sampled and v.causality == "output"):
            assert v.variability == "discrete"
        else:
            assert v.variability == "continuous"


def test_dependencies_are_the_declared_ones(subject):
    description = fmpy.read_model_description(subject.path)
    parameters = {v.name for v in variables(subject.model.Parameters)}
    outputs = {v.name: v for v in variables(subject.model.Outputs)}
    for unknown in description.outputs:
        about = outputs[unknown.variable.name]
        assert {v.name for v in unknown.dependencies} == (
            set() if subject.model.sampled else set(about.depends)
        )
    for unknown in description.initialUnknowns:
        about = outputs[unknown.variable.name]
        reached = about.initially
        if reached is None:
            reached = (*subject.model.initial_inputs, *about.depends)
        assert {v.name for v in unknown.dependencies} == parameters | set(reached)


def test_capabilities_and_experiment(subject):
    description = fmpy.read_model_description(subject.path)
    able = description.coSimulation
    assert able.canGetAndSetFMUstate
    assert able.canSerializeFMUstate
    assert able.canHandleVariableCommunicationStepSize
    assert able.needsExecutionTool
    assert not able.canBeInstantiatedOnlyOncePerProcess
    assert float(description.defaultExperiment.stepSize) == 0.01
    assert description.generationDateAndTime is None


def test_text_units_and_enumerations_of_the_toy(mixed):
    description = fmpy.read_model_description(mixed.path)
    assert description.description == "Sums what it is given."
    assert [unit.name for unit in description.unitDefinitions] == ["kg", "km/h", "s"]
    (gear,) = description.typeDefinitions
    assert gear.name == "Gear"
    assert [(i.name, int(i.value)) for i in gear.items] == [("reverse", -1), ("neutral", 0), ("forward", 2)]
    by_name = {v.name: v for v in description.modelVariables}
    assert by_name["weight"].description == "A Real <parameter> & more"
    assert by_name["clock"].causality == "independent"
    assert by_name["lever"].declaredType is gear
