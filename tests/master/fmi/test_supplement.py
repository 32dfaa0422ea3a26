"""The parts of a description that FMPy leaves out: FMI 1.0's capabilities and causalities, UInts' limits."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.master.fmi.fmu import is_true, read_fmu
from support.descriptions import described

FIRST = """<fmiModelDescription fmiVersion="1.0" modelName="m" modelIdentifier="m" guid="g"
  numberOfContinuousStates="0" numberOfEventIndicators="0">
<ModelVariables>
<ScalarVariable name="y" valueReference="0" causality="output"><Real/></ScalarVariable>
<ScalarVariable name="back" valueReference="0" causality="output" alias="negatedAlias"><Real/>
</ScalarVariable>
<ScalarVariable name="off" valueReference="1" causality="output" alias="negatedAlias"><Boolean/>
</ScalarVariable>
<ScalarVariable name="mass" valueReference="2" causality="internal" variability="parameter">
<Real start="2"/></ScalarVariable>
<ScalarVariable name="rest" valueReference="3"><Real/></ScalarVariable>
<ScalarVariable name="x" valueReference="4"><!-- a state --><Real start="1"/></ScalarVariable>
<ScalarVariable name="guess" valueReference="5" causality="output"><Real start="1" fixed="false"/>
</ScalarVariable>
<ScalarVariable name="always" valueReference="6" variability="constant"><Real start="1"/></ScalarVariable>
</ModelVariables>
<Implementation>{}</Implementation></fmiModelDescription>"""

ALONE = """<CoSimulation_StandAlone><Capabilities canHandleVariableCommunicationStepSize="true"
  canBeInstantiatedOnlyOncePerProcess="1" maxOutputDerivativeOrder="2"/></CoSimulation_StandAlone>"""
WITH_TOOL = """<CoSimulation_Tool><Capabilities canInterpolateInputs="false"/>
<Model entryPoint="http://model" type="text"/></CoSimulation_Tool>"""


def test_the_capabilities_of_a_slave_of_fmi_1(tmp_path: Path) -> None:
    kind = read_fmu(described(tmp_path, FIRST.format(ALONE))).kind
    assert is_true(kind, "canHandleVariableCommunicationStepSize")
    assert is_true(kind, "canBeInstantiatedOnlyOncePerProcess")
    assert not is_true(kind, "canInterpolateInputs")
    assert not is_true(kind, "needsExecutionTool")
    assert kind.maxOutputDerivativeOrder == 2


OUTPUTS = """<fmiModelDescription fmiVersion="1.0" modelName="m" modelIdentifier="m" guid="g"
  numberOfContinuousStates="0" numberOfEventIndicators="0">
<ModelVariables>
<ScalarVariable name="u" valueReference="0" causality="input"><Real/></ScalarVariable>
<ScalarVariable name="v" valueReference="1" causality="input"><Real/></ScalarVariable>
<ScalarVariable name="y" valueReference="2" causality="output"><Real/>
<DirectDependency><Name> v </Name><Name>gone</Name></DirectDependency></ScalarVariable>
<ScalarVariable name="z" valueReference="3" causality="output"><Real/><DirectDependency/></ScalarVariable>
<ScalarVariable name="w" valueReference="4" causality="output"><Real/></ScalarVariable>
<ScalarVariable name="x" valueReference="5"><Real/></ScalarVariable>
</ModelVariables>{}</fmiModelDescription>"""


def test_the_dependencies_of_model_exchange_of_fmi_1(tmp_path: Path) -> None:
    """What is not declared is not known; a slave's outputs belong to the step that it did."""
    for steps, expected in (
        ("", {"y": ("v",), "z": (), "w": None}),
        (f"<Implementation>{ALONE}</Implementation>", {"y": (), "z": (), "w": ()}),
    ):
        fmu = read_fmu(described(tmp_path, OUTPUTS.format(steps)))
        assert {v.name: v.depends for v in fmu.interface.of_causality("output")} == expected
        assert {v.depends_initially for v in fmu.interface.of_causality("output")} == {()}


def test_model_exchange_of_fmi_1_is_told_of_every_step(tmp_path: Path) -> None:
    assert is_true(read_fmu(described(tmp_path, OUTPUTS.format(""))).kind, "needsCompletedIntegratorStep")


def test_a_slave_of_a_tool_needs_it(tmp_path: Path) -> None:
    kind = read_fmu(described(tmp_path, FIRST.format(WITH_TOOL))).kind
    assert is_true(kind, "needsExecutionTool")
    assert kind.maxOutputDerivativeOrder == 0


def test_a_start_value_of_fmi_1_is_exact_unless_it_is_a_guess(tmp_path: Path) -> None:
    variables = read_fmu(described(tmp_path, FIRST.format(ALONE))).interface.variables
    given = {name: v.initial for name, v in variables.items() if v.causality in ("output", "local")}
    assert given == {"y": "", "back": "", "rest": "", "x": "exact", "guess": "approx", "always": "exact"}
    assert [name for name, v in variables.items() if v.takes_start] == ["x", "guess"]


def test_what_fmi_1_calls_internal_is_local(tmp_path: Path) -> None:
    interface = read_fmu(described(tmp_path, FIRST.format(ALONE))).interface
    assert interface.variables["rest"].causality == "local"
    assert interface.variables["mass"].causality in ("parameter", "local")


def test_a_negated_alias_has_the_other_sign_or_is_refused(tmp_path: Path) -> None:
    fmu = read_fmu(described(tmp_path, FIRST.format(ALONE)))
    assert fmu.negated == {"back", "off"}
    variables = fmu.interface.variables
    assert [variables[name].inverted for name in ("y", "back")] == [False, True]
    assert fmu.interface.unusable == {"off": "is a negated alias of type Boolean, which is not supported"}


@pytest.mark.parametrize("kind", ["UInt8", "UInt16", "UInt32", "UInt64", "Int8", "Int64"])
def test_every_integer_of_fmi_3_has_its_limits(tmp_path: Path, kind: str) -> None:
    text = (
        '<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="t">'
        '<CoSimulation modelIdentifier="m"/><ModelVariables>'
        f'<{kind} name="n" valueReference="1" causality="input" start="3" min="2" max="90"/>'
        f'<{kind} name="free" valueReference="2" causality="input" start="3"/>'
        "</ModelVariables><ModelStructure/></fmiModelDescription>"
    )
    variables = read_fmu(described(tmp_path, text)).interface.variables
    assert (variables["n"].min, variables["n"].max) == (2.0, 90.0)
    assert (variables["free"].min, variables["free"].max) == (None, None)
