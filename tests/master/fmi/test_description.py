"""Descriptions: small defects are mended and reported, others are a FmuError, and nothing is expanded."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path

import pytest

from evcosim.master.fmi.description import _mend, parsed_xml
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.fmi.validation import validated
from support.descriptions import GOOD, changed, described


def test_a_good_description_has_no_defects(tmp_path: Path) -> None:
    found = read_fmu(described(tmp_path, GOOD), strict=True)
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
    (('name="u" ', ""), "line 6: a variable without a name is left out"),
    (('start="1.5"', 'min="2" max="1"'), "u: min = 2 is above max = 1; both are ignored"),
    (('start="1.5"', 'start="1.5" max="1"'), "u: start = 1.5 is above max = 1"),
    (('start="3"', 'start="3" min="4"'), "n: start = 3 is below min = 4"),
    (('modelIdentifier="m"', 'modelIdentifier="m-c"'),
     "modelIdentifier is 'm-c', which is no plain name (letters, digits, _); it is taken as it is"),
]  # fmt: skip # pairs


@pytest.mark.parametrize(("change", "sentence"), DEFECTS)
def test_defects_are_mended_and_reported(tmp_path: Path, change: tuple[str, str], sentence: str) -> None:
    text = changed(change)
    if "without a name" in sentence:
        text = text.replace(' dependencies="1"', "")
    path = described(tmp_path, text)
    found = read_fmu(path)
    assert found.defects == (sentence,)
    assert "y" in found.interface.variables
    with pytest.raises(FmuError, match=r"a.fmu: strict: 1 defect: "):
        read_fmu(path, strict=True)


def test_a_parameter_whose_variability_was_wrong_is_fixed(tmp_path: Path) -> None:
    found = read_fmu(described(tmp_path, changed(DEFECTS[4][0])))
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
        (('valueReference="1" ', f'valueReference="{"9" * 5000}" '), "valueReference '999"),
        *(
            (
                ('modelIdentifier="m"', f'modelIdentifier="{name}"'),
                r"modelIdentifier is '.*', which is no plain",
            )
            for name in ("../../m", "a/m", "a\\m", "c:m", ".m", "", "a&#10;m", "a&#x202e;m", "m*")
        ),
        (("ModelVariables", "Variables"), "has no <ModelVariables>"),
        (("fmiModelDescription", "model"), "begins with <model>"),
        (("<fmiM", '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><fmiM'), "has a document type"),
    ],
)
def test_what_has_no_sensible_reading_is_refused(
    tmp_path: Path, change: tuple[str, str], reason: str
) -> None:
    text = GOOD.replace(*change)
    assert text != GOOD
    with pytest.raises(FmuError, match=rf"a.fmu: modelDescription.xml.*{reason}"):
        read_fmu(described(tmp_path, text))


def test_a_variable_that_is_declared_twice_alike_is_taken_once(tmp_path: Path) -> None:
    """The places that the structure counts are those of the file, the left out one's is that of the first."""
    u, y = (line for line in GOOD.splitlines(keepends=True) if 'name="u"' in line or 'name="y"' in line)
    again = u.replace('valueReference="0"', 'valueReference="7"')
    text = GOOD.replace(y, again + y).replace('index="2" dependencies="1"', 'index="3" dependencies="2"')
    found = read_fmu(described(tmp_path, text))
    said = "u: declared twice alike, in lines 6 and 7; that with valueReference 0 is taken, 7 is left out"
    assert found.defects == (said,)
    assert found.interface.variables == read_fmu(described(tmp_path, GOOD)).interface.variables
    assert [v.valueReference for v in found.description.modelVariables] == [0, 1, 2]
    assert read_fmu(described(tmp_path, GOOD.replace(y, u + y))).defects[0].endswith("lines 6 and 7")
    for change in (("1.5", "1.6"), ("input", "local"), ("Real", "Integer")):
        with pytest.raises(FmuError, match=r"variable 'u' \(line 7\) is declared twice"):
            read_fmu(described(tmp_path, GOOD.replace(y, again.replace(*change) + y)))


def test_a_working_folder_whose_name_is_no_utf_8(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / os.fsdecode(b"f\xfcr")
    folder.mkdir()
    described(folder, GOOD)
    monkeypatch.chdir(folder)
    path = Path("a.fmu")
    assert "y" in read_fmu(path).interface.variables
    assert not [message for message in validated(path) if "codec" in message]
    assert Path.cwd() == folder


def test_a_document_type_in_another_encoding(tmp_path: Path) -> None:
    text = changed(("<fmiM", "<!DOCTYPE x><fmiM")).replace(
        '<?xml version="1.0"?>', '<?xml version="1.0" encoding="UTF-16"?>'
    )
    path = tmp_path / "a.fmu"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("modelDescription.xml", text.encode("utf-16"))
    with pytest.raises(FmuError, match="has a document type"):
        read_fmu(path)


@pytest.mark.parametrize(("change", "sentence"), DEFECTS)
def test_what_was_mended_has_no_defect(tmp_path: Path, change: tuple[str, str], sentence: str) -> None:
    """But for a start value beyond a limit, which stays as it is."""
    text = changed(change)
    if "without a name" in sentence:
        text = text.replace(' dependencies="1"', "")
    root = parsed_xml("here", text.encode())
    first = _mend(Path("a.fmu"), root)
    assert first == [sentence]
    assert _mend(Path("a.fmu"), root) == (
        first if ("start = " in sentence and " is no " not in sentence) or "as it is" in sentence else []
    )
