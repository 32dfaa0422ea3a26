"""The ModelStructure: entries for variables that are not there are left out, and the others stay right."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.master.fmi.description import parsed_xml
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.fmi.structure import mend_structure
from support.descriptions import GOOD, changed, described

PLACES = {1: 1, 2: 2, 3: 3}

OF_FMI_2 = [
    (
        ('index="2"', 'index="9"'),
        "ModelStructure, line 11: '9' is the index of none of 3 variables; it is left out",
    ),
    (
        ('index="2" dependencies="1"', 'index="2" dependencies="1 4"'),
        "ModelStructure, line 11: '4' is the index of none of 3 variables; it is left out",
    ),
    (('unit="km/h"', 'derivative="7"'), "u: derivative = '7' is the index of no variable; it is ignored"),
]

THIRD = """<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="t">
<CoSimulation modelIdentifier="m"/>
<ModelVariables><Float64 name="u" valueReference="10" causality="input" start="0"/>
<Float64 name="y" valueReference="20" causality="output"/></ModelVariables>
<ModelStructure><Output valueReference="20" dependencies="10"/></ModelStructure></fmiModelDescription>"""


@pytest.mark.parametrize(("change", "sentence"), OF_FMI_2)
def test_a_defect_is_reported_once(tmp_path: Path, change: tuple[str, str], sentence: str) -> None:
    root = parsed_xml("here", changed(change).encode())
    assert mend_structure(root, PLACES) == [sentence]
    assert mend_structure(root, PLACES) == []
    assert read_fmu(described(tmp_path, changed(change))).defects == (sentence,)


def test_the_indices_of_the_others_stay_right_when_a_variable_is_left_out(tmp_path: Path) -> None:
    text = changed(
        ("<ModelVariables>", '<ModelVariables><ScalarVariable valueReference="9"><Real/></ScalarVariable>'),
        ('index="2" dependencies="1"', 'index="3" dependencies="2"'),
        ('unit="km/h"', 'derivative="3"'),
    )
    found = read_fmu(described(tmp_path, text))
    assert found.interface.variables["y"].depends == ("u",)
    assert [v.derivative.name for v in found.description.modelVariables if v.derivative] == ["y"]


def test_the_number_of_states_is_that_of_the_derivatives() -> None:
    text = changed(
        ("<Outputs>", '<Derivatives><Unknown index="1"/></Derivatives><Outputs>'),
        ('guid="g"', 'guid="g" numberOfContinuousStates="7"'),
    )
    root = parsed_xml("here", text.encode())
    assert mend_structure(root, PLACES) == []
    assert root.get("numberOfContinuousStates") == "1"


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            'Output valueReference="20"',
            'Output valueReference="21"',
            "line 5: '21' is the value reference of",
        ),
        ('dependencies="10"', 'dependencies="10 x"', "line 5: 'x' is the value reference of no variable"),
        ('causality="output"', 'causality="output" derivative="3"', "y: derivative = '3' is the value ref"),
    ],
)
def test_fmi_3_counts_by_value_references(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    assert read_fmu(described(tmp_path, THIRD)).defects == ()
    root = parsed_xml("here", THIRD.replace(old, new).encode())
    (found,) = mend_structure(root, {})
    assert sentence in found
    assert mend_structure(root, {}) == []


def test_fmi_1_has_none_of_it() -> None:
    root = parsed_xml("here", GOOD.replace('fmiVersion="2.0"', 'fmiVersion="1.0"').encode())
    assert mend_structure(root, {}) == []
