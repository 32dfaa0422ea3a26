"""Descriptions: what can be borne is mended and told, what cannot is a FmuError, and nothing is expanded."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from evcosim.master.fmi.fmu import FmuError, read_fmu

GOOD = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">
<CoSimulation modelIdentifier="m"/>
<TypeDefinitions><SimpleType name="Speed"><Real unit="m/s"/></SimpleType></TypeDefinitions>
<ModelVariables>
<ScalarVariable name="u" valueReference="0" causality="input"><Real start="1.5" unit="km/h"/></ScalarVariable>
<ScalarVariable name="y" valueReference="1" causality="output"><Real declaredType="Speed"/></ScalarVariable>
<ScalarVariable name="n" valueReference="2" causality="parameter" variability="fixed">
<Integer start="3"/></ScalarVariable>
</ModelVariables>
<ModelStructure><Outputs><Unknown index="2" dependencies="1"/></Outputs></ModelStructure>
</fmiModelDescription>"""


def fmu(folder: Path, text: str) -> Path:
    path = folder / "a.fmu"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("modelDescription.xml", text)
    return path


def changed(*changes: tuple[str, str]) -> str:
    text = GOOD
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


def test_a_good_description_has_no_defects(tmp_path: Path) -> None:
    found = read_fmu(fmu(tmp_path, GOOD), strict=True)
    assert found.defects == ()
    assert found.interface.variables["y"].unit == "m/s"
    assert found.interface.variables["y"].depends == ("u",)
    assert found.interface.variables["u"].unit == "km/h"


DEFECTS = [
    (('start="1.5"', 'start="true"'), "u: start = 'true' is no Real; it is ignored"),
    (('start="1.5"', 'start="NaN"'), "u: start = 'NaN' is no Real; it is ignored"),
    (('start="3"', 'start="3.0"'), "n: start = '3.0' is no Integer; it is ignored"),
    (('"Speed"/>', '"Sped"/>'), "y: declaredType 'Sped' is not defined; it is ignored"),
    (('variability="fixed"', 'variability="continuous"'),
     "n: a parameter of variability 'continuous' is not allowed; 'fixed' is assumed"),
    ((' variability="fixed"', ""),
     "n: a parameter of variability 'continuous' is not allowed; 'fixed' is assumed"),
    (('index="2"', 'index="9"'),
     "ModelStructure, line 11: '9' is the index of none of 3 variables; it is left out"),
    (('name="u" ', ""), "line 6: a variable without a name is left out"),
    (('start="1.5"', 'min="2" max="1"'), "u: min = 2 is above max = 1; both are ignored"),
    (('start="1.5"', 'start="1.5" max="1"'), "u: start = 1.5 is above max = 1"),
    (('start="3"', 'start="3" min="4"'), "n: start = 3 is below min = 4"),
    (('<CoSimulation ', '<CoSimulation maxOutputDerivativeOrder="many" '),
     "CoSimulation: maxOutputDerivativeOrder = 'many' is no number; it is ignored"),
    (("<TypeDefinitions>", '<UnitDefinitions><Unit name="km/h"><BaseUnit factor="x"/></Unit>'
      "</UnitDefinitions><TypeDefinitions>"),
     "unit of measure 'km/h': factor = 'x' is no number; its definition is ignored"),
    (("<TypeDefinitions>", '<TypeDefinitions><SimpleType name="Nothing"/>'),
     "type 'Nothing' says nothing; it is left out"),
    (('unit="km/h"', 'derivative="7"'), "u: derivative = '7' is the index of no variable; it is ignored"),
]  # fmt: skip # pairs


@pytest.mark.parametrize(("change", "told"), DEFECTS)
def test_defects_are_mended_and_told(tmp_path: Path, change: tuple[str, str], told: str) -> None:
    text = changed(change)
    if "without a name" in told:
        text = text.replace(' dependencies="1"', "")
    path = fmu(tmp_path, text)
    found = read_fmu(path)
    assert found.defects == (told,)
    assert "y" in found.interface.variables
    with pytest.raises(FmuError, match=r"a.fmu: strict: 1 defect: "):
        read_fmu(path, strict=True)


def test_the_indices_of_the_others_stay_right_when_a_variable_is_left_out(tmp_path: Path) -> None:
    text = changed(
        ("<ModelVariables>", '<ModelVariables><ScalarVariable valueReference="9"><Real/></ScalarVariable>'),
        ('index="2" dependencies="1"', 'index="3" dependencies="2"'),
        ('unit="km/h"', 'derivative="3"'),
    )
    found = read_fmu(fmu(tmp_path, text))
    assert found.interface.variables["y"].depends == ("u",)
    assert [v.derivative.name for v in found.description.modelVariables if v.derivative] == ["y"]


def test_a_parameter_whose_variability_was_wrong_is_fixed(tmp_path: Path) -> None:
    found = read_fmu(fmu(tmp_path, changed(DEFECTS[4][0])))
    assert found.interface.variables["n"].causality == "parameter"


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (("<?xml", "<!-- --><?xml"), "is no well-formed XML"),
        (("</fmiModelDescription>", ""), "is no well-formed XML"),
        (('"2.0"', '"4.0"'), "fmiVersion is '4.0'; 1.0, 2.0, 3.0 are supported"),
        (('name="y"', 'name="u"'), r"variable 'u' \(line 7\) is declared twice"),
        (('valueReference="1" ', ""), "valueReference None; a whole number"),
        (('valueReference="1" ', 'valueReference="-1" '), "valueReference '-1'; a whole number"),
        (
            ('modelIdentifier="m"', 'modelIdentifier="../../m"'),
            r"modelIdentifier is '../../m', which is no plain",
        ),
        (("ModelVariables", "Variables"), "has no <ModelVariables>"),
        (("fmiModelDescription", "model"), "begins with <model>"),
        (("<fmiM", '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><fmiM'), "has a document type"),
    ],
)
def test_what_cannot_be_borne(tmp_path: Path, change: tuple[str, str], reason: str) -> None:
    text = GOOD.replace(*change)
    assert text != GOOD
    with pytest.raises(FmuError, match=rf"a.fmu: modelDescription.xml.*{reason}"):
        read_fmu(fmu(tmp_path, text))


def test_a_document_type_in_another_encoding(tmp_path: Path) -> None:
    text = changed(("<fmiM", "<!DOCTYPE x><fmiM")).replace(
        '<?xml version="1.0"?>', '<?xml version="1.0" encoding="UTF-16"?>'
    )
    path = tmp_path / "a.fmu"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("modelDescription.xml", text.encode("utf-16"))
    with pytest.raises(FmuError, match="has a document type"):
        read_fmu(path)
