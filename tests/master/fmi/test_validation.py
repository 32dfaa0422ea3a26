"""The validator of descriptions: names are judged as FMPy judges them, and the rest is FMPy's own."""

from __future__ import annotations

import random
import zipfile
from pathlib import Path

import fmpy.validation
import pytest
from fmpy.model_description import ModelDescription, ModelVariable

from evcosim.master.fmi.validation import is_structured_name, validated

PIECES = (
    *("a", "Z9", "_", "der", "der(", ")", ",", ",2", "[1]", "[1,23]", "[", "]", ".", "'x y'", "'", "\\'"),
    *(
        "\\",
        "\\a",
        '"',
        '\\"',
        "?",
        "0",
        "1a",
        " ",
        "\n",
        "\t",
        "\r",
        "\f",
        "\v",
        "\a",
        "ä",
        "\u0661",
        "$",
        "`",
    ),
)
EDGES = (
    *("", "der", "der(a)", "der(a,2)", "der(a, 2)", "der(der(a))", "a.der(b)", "der(a).b", "a[01]", "a[]"),
    *(
        "''",
        "'''",
        "''''",
        "'\\'",
        "'\\\\'",
        "'\\''",
        "'a\\'b'",
        "'a'b'",
        "'a'.'b'[2].c",
        "'\\x'",
        "a..b",
        "a.",
    ),
)


def _as_fmpy_judges(names: list[str]) -> list[bool]:
    variables = [ModelVariable(name=name, valueReference=0, type="Real") for name in names]
    about = ModelDescription(
        fmiVersion="2.0", modelVariables=variables, variableNamingConvention="structured"
    )
    problems = iter(fmpy.validation._validate_variable_names(about))
    found, problem = [], next(problems, None)
    for name in names:
        legal = problem is None or not problem.startswith(f'"{name}" (line')
        found.append(legal)
        if not legal:
            problem = next(problems, None)
    assert problem is None
    return found


def test_structured_names_are_judged_as_fmpy_judges_them():
    chance = random.Random(3)
    names = [*EDGES, *("".join(chance.choices(PIECES, k=chance.randint(1, 6))) for _ in range(500))]
    names += [f"'{''.join(chance.choices(PIECES, k=3))}'" for _ in range(200)]
    names = list(dict.fromkeys(names))
    judged = _as_fmpy_judges(names)
    assert 50 < sum(judged) < len(names) - 50
    assert {n: is_structured_name(n) for n in names} == dict(zip(names, judged, strict=True))


@pytest.mark.parametrize("text", ["'" + "\\'.'" * 5_000 + "!", "a[1,1]." * 5_000, "'" + "\\" * 20_000 + "'["])
def test_a_hostile_name_is_judged_at_once(text):
    assert not is_structured_name(text)


DESCRIPTION = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="{version}" modelName="m" {token}="g"{convention}>
<CoSimulation modelIdentifier="m"/><ModelVariables>{variables}</ModelVariables>
<ModelStructure/></fmiModelDescription>"""


def _fmu(path: Path, version: str, names: list[str], convention: str, more: str = "") -> Path:
    if version == "2.0":
        lines = [
            f'<ScalarVariable name="{name}" valueReference="{i}"><Real/></ScalarVariable>'
            for i, name in enumerate(names)
        ]
    else:
        lines = [f'<Float64 name="{name}" valueReference="{i}"/>' for i, name in enumerate(names)]
        lines.append('<Float64 name="time" valueReference="99" causality="independent">')
        lines.append('<Alias name="also time"/></Float64>')
    text = DESCRIPTION.format(
        version=version,
        token="guid" if version == "2.0" else "instantiationToken",
        convention=f' variableNamingConvention="{convention}"' if convention else "",
        variables="\n".join(lines) + more,
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text)
    return path


@pytest.mark.parametrize("convention", ["structured", "flat", ""])
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_the_messages_are_fmpys(tmp_path, version, convention):
    names = ["a.b[1]", "a b", "a&#9;b", "x&#10;y", "a b", "der(x)"]  # one of them twice
    path = _fmu(tmp_path / "m.fmu", version, names, convention)

    def short(messages: list[str]) -> list[str]:  # that of a name ends with what its parser expected
        return [m.split("(U+")[0].split('"structured".')[0].rstrip(" .") for m in messages]

    ours = [m.removesuffix(" character.") + " character" * m.endswith("character.") for m in validated(path)]
    assert short(ours) == short(fmpy.validation.validate_fmu(str(path)))
    assert len(ours) > 1


def test_a_description_against_its_schema_gets_these_messages_alone(tmp_path):
    path = _fmu(tmp_path / "m.fmu", "2.0", ["a b"], "structured", '<ScalarVariable name="c"/>')
    assert validated(path) == fmpy.validation.validate_fmu(str(path)) != []


def test_no_problem_is_no_message(tmp_path):
    assert validated(_fmu(tmp_path / "m.fmu", "2.0", ["a.b", "der(a.b)"], "structured")) == []


def test_a_large_description_is_validated_name_by_name(tmp_path, monkeypatch):
    def refused(*_):
        raise AssertionError("FMPy's parser takes 10 ms for each name")

    monkeypatch.setattr(fmpy.validation, "_validate_variable_names", refused)
    names = [f"body[{i}].frame_a.'r x'[{i % 3}]" for i in range(20_000)]
    assert validated(_fmu(tmp_path / "m.fmu", "2.0", [*names, "1x"], "structured")) == [
        '"1x" (line 20003) is not a legal variable name for naming convention "structured".'
    ]
