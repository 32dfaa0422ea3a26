"""The parts of a description beside its variables: each defect is mended, reported once, and then gone."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.master.fmi.attributes import mend_attributes
from evcosim.master.fmi.description import parsed_xml
from evcosim.master.fmi.fmu import read_fmu
from support.descriptions import GOOD, changed, described

UNIT = '<UnitDefinitions><Unit name="km/h">{}</Unit></UnitDefinitions><TypeDefinitions>'
ENUMERATION = '<SimpleType name="State"><Enumeration>{}<Item name="on" value="2"/></Enumeration></SimpleType>'

DEFECTS = [
    (
        ("<CoSimulation ", '<CoSimulation maxOutputDerivativeOrder="many" '),
        "CoSimulation: maxOutputDerivativeOrder = 'many' is no number; it is ignored",
    ),
    (
        ("<CoSimulation ", '<CoSimulation fixedInternalStepSize="nan" '),
        "CoSimulation: fixedInternalStepSize = 'nan' is no number; it is ignored",
    ),
    (
        ("<ModelVariables>", '<DefaultExperiment startTime="0" stepSize="a.b.c.d"/><ModelVariables>'),
        "DefaultExperiment: stepSize = 'a.b.c.d' is no finite number; it is ignored",
    ),
    (
        ("<ModelVariables>", '<DefaultExperiment stopTime="1e400"/><ModelVariables>'),
        "DefaultExperiment: stopTime = '1e400' is no finite number; it is ignored",
    ),
    (
        ("<TypeDefinitions>", UNIT.format('<BaseUnit factor="INF"/>')),
        "unit of measure 'km/h': factor = 'INF' is no number; its definition is ignored",
    ),
    (
        ("<TypeDefinitions>", UNIT.format('<BaseUnit factor="1_0"/>')),
        "unit of measure 'km/h': factor = '1_0' is no number; its definition is ignored",
    ),
    (
        ('guid="g"', 'guid="g" numberOfEventIndicators="1.5"'),
        "numberOfEventIndicators = '1.5' is no number; 0 is assumed",
    ),
    (
        ("<TypeDefinitions>", UNIT.format('<BaseUnit factor="x"/>')),
        "unit of measure 'km/h': factor = 'x' is no number; its definition is ignored",
    ),
    (
        ("<TypeDefinitions>", UNIT.format('<BaseUnit m="1" s="-1.5"/>')),
        "unit of measure 'km/h': s = '-1.5' is no number; its definition is ignored",
    ),
    (
        ("<TypeDefinitions>", UNIT.format('<BaseUnit m="9999"/>')),
        "unit of measure 'km/h': m = '9999' is no number; its definition is ignored",
    ),
    *(
        (
            ("<TypeDefinitions>", f"<TypeDefinitions>{ENUMERATION.format(item)}"),
            f"line 4: an item {said}, is left out",
        )
        for item, said in (
            ('<Item name="a"/>', "'a' with the value None, no whole number"),
            ('<Item name="a" value=""/>', "'a' with the value '', no whole number"),
            ('<Item name="a" value="1.5"/>', "'a' with the value '1.5', no whole number"),
            ('<Item value="1"/>', "without a name"),
        )
    ),
    (
        ("<TypeDefinitions>", '<TypeDefinitions><SimpleType name="Nothing"/>'),
        "type 'Nothing' says nothing; it is left out",
    ),
]


@pytest.mark.parametrize(("change", "sentence"), DEFECTS)
def test_a_defect_is_reported_once(tmp_path: Path, change: tuple[str, str], sentence: str) -> None:
    root = parsed_xml("here", changed(change).encode())
    assert mend_attributes(root) == [sentence]
    assert mend_attributes(root) == []
    assert read_fmu(described(tmp_path, changed(change))).defects == (sentence,)


def test_a_good_description_stays_as_it_is() -> None:
    root = parsed_xml("here", GOOD.encode())
    before = [(element.tag, dict(element.attrib)) for element in root.iter()]
    assert mend_attributes(root) == []
    assert [(element.tag, dict(element.attrib)) for element in root.iter()] == before


def test_another_unit_of_measure_keeps_its_definition(tmp_path: Path) -> None:
    units = (
        '<UnitDefinitions><Unit name="km/h"><BaseUnit m="1" s="-1" factor="0.2777777777777778"/></Unit>'
        '<Unit name="bad"><BaseUnit m="one"/></Unit></UnitDefinitions><TypeDefinitions>'
    )
    found = read_fmu(described(tmp_path, changed(("<TypeDefinitions>", units))))
    known = found.interface.units_of_measure
    assert known["km/h"].factor == pytest.approx(1.0 / 3.6)
    assert known["bad"].exponents is None


def test_attributes_that_no_type_has_are_left_out_without_a_word() -> None:
    text = changed(('<Real unit="m/s"/>', '<Real unit="m/s" colour="blue"/>'))
    root = parsed_xml("here", text.encode())
    assert mend_attributes(root) == []
    assert dict(root.find("TypeDefinitions/SimpleType/Real").attrib) == {"unit": "m/s"}


def test_display_units_that_are_no_numbers_are_left_out(tmp_path: Path) -> None:
    """Nothing shows values in them."""
    unit = '<BaseUnit m="1"/><DisplayUnit name="ft" factor="many"/><DisplayUnit name="cm" factor="100"/>'
    root = parsed_xml("here", changed(("<TypeDefinitions>", UNIT.format(unit))).encode())
    assert mend_attributes(root) == []
    assert [each.get("name") for each in root.iter("DisplayUnit")] == ["cm"]


@pytest.mark.parametrize("version", ["1.0", "2.0", "3.0"])
def test_the_items_that_stay(tmp_path: Path, version: str) -> None:
    """FMI 1.0 gives items no values; they are counted from 1 on."""
    first = version == "1.0"
    values = ("", "") if first else ('value="7"', 'value="9"')
    items = f'<Item name="off" {values[0]}/><Item name="on" {values[1]}/><Item name="lost"/>'
    variable = '<ScalarVariable name="s" valueReference="0"><Enumeration declaredType="S"/></ScalarVariable>'
    kind = '<CoSimulation modelIdentifier="m"/>'
    if first:
        types = f'<Type name="S"><EnumerationType>{items}</EnumerationType></Type>'
        kind = "<Implementation><CoSimulation_StandAlone/></Implementation>"
    elif version == "2.0":
        types = f'<SimpleType name="S"><Enumeration>{items}</Enumeration></SimpleType>'
    else:
        types = f'<EnumerationType name="S">{items}</EnumerationType>'
        variable = '<Enumeration name="s" valueReference="0" declaredType="S"/>'
    text = (
        f'<fmiModelDescription fmiVersion="{version}" modelName="m" guid="g" modelIdentifier="m">'
        f"{'' if first else kind}<TypeDefinitions>{types}</TypeDefinitions>"
        f"<ModelVariables>{variable}</ModelVariables>{kind if first else '<ModelStructure/>'}"
        "</fmiModelDescription>"
    )
    found = read_fmu(described(tmp_path, text)).interface.variables["s"].items
    assert found == (((1, "off"), (2, "on"), (3, "lost")) if first else ((7, "off"), (9, "on")))
