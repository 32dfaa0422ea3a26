"""The JSON schemas: every file that evcosim reads is right by them, and what they refuse evcosim refuses too."""

from __future__ import annotations

import inspect
import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from jsonschema.exceptions import best_match
from pydantic import BaseModel, ValidationError

from evcosim.cosim.swap.swap_file import SwapFile
from evcosim.cosim.system.problems import spelled
from evcosim.cosim.system.scenario import ScenarioFile
from evcosim.cosim.system.schema import json_schema, key_texts, type_text
from evcosim.cosim.system.system import SystemFile
from evcosim.cosim.system.toml import DATA

ROOT = Path(__file__).parents[3]
FILES = {"system": SystemFile, "scenario": ScenarioFile, "swap": SwapFile}
SCHEMAS = {kind: json_schema(model, f"evcosim {kind} file") for kind, model in FILES.items()}
HEAD = "name = 'x'\n[units.a]\nfmu = 'A'\n"


def records(schema: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield each table of a schema by name."""
    yield "file", schema
    yield from ((name, table) for name, table in schema["$defs"].items() if "properties" in table)


RECORDS = [pytest.param(t, id=f"{kind}-{name}") for kind, s in SCHEMAS.items() for name, t in records(s)]


@pytest.mark.parametrize("table", RECORDS)
def test_every_table_and_every_key_has_its_text(table: dict[str, Any]) -> None:
    assert table["description"]
    for key, about in table["properties"].items():
        text = about["description"]
        assert text[0].isupper() and text.endswith("."), (key, text)
        assert "\n" not in text


def test_texts_stand_under_the_keys_of_a_base_too() -> None:
    """`period` is declared in UnitEntry, `replaces` in SwapFile itself."""
    texts = key_texts(SwapFile)
    assert all(texts.values())
    assert inspect.getsource(SwapFile).count(texts["replaces"]) == 1
    assert texts["period"] not in inspect.getsource(SwapFile)


def test_keys_are_spelled_as_in_the_file() -> None:
    assert "from" in SCHEMAS["system"]["$defs"]["Connection"]["properties"]
    assert {"stimulus", "event"} <= set(SCHEMAS["scenario"]["properties"])


def test_there_is_no_null_and_no_default_that_is_a_table() -> None:
    """TOML has no null, and a table that is not there has no text."""

    def check(part: object) -> None:
        if isinstance(part, dict):
            assert part.get("type") != "null"
            assert not isinstance(part.get("default"), dict) or "properties" in part["default"]
            for inner in part.values():
                check(inner)
        elif isinstance(part, list):
            for inner in part:
                check(inner)

    for schema in SCHEMAS.values():
        check(schema)


# ---- files


def example_files() -> Iterator[tuple[str, Path]]:
    """Yield the kind and path of all files that come with evcosim."""
    yield from (("system", path) for path in sorted((DATA / "systems").glob("*.toml")))
    yield from (("scenario", path) for path in sorted((DATA / "scenarios").glob("*/*.toml")))
    yield from (("swap", path) for path in sorted((ROOT / "examples").glob("*/*.toml")))


EXAMPLES = [pytest.param(kind, path, id=f"{path.parent.name}/{path.stem}") for kind, path in example_files()]


@pytest.mark.parametrize("kind", FILES)
def test_the_schema_is_one(kind: str) -> None:
    assert SCHEMAS[kind]["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert SCHEMAS[kind]["title"] == f"evcosim {kind} file"
    Draft202012Validator.check_schema(SCHEMAS[kind])


@pytest.mark.parametrize(("kind", "path"), EXAMPLES)
def test_every_file_is_right(kind: str, path: Path) -> None:
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    assert [error.message for error in Draft202012Validator(SCHEMAS[kind]).iter_errors(data)] == []
    FILES[kind].model_validate(data)


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*/*.toml")), ids=lambda path: path.stem)
def test_an_example_names_the_schema_that_lies_beside_it(path: Path) -> None:
    """Made by `evcosim schema swap -o examples/modelica`."""
    marked = path.read_text(encoding="utf-8").splitlines()[0].partition("#:schema ")[2]
    kind = marked.removeprefix("./").removesuffix(".schema.json")
    assert json.loads((path.parent / marked).read_text(encoding="utf-8")) == SCHEMAS[kind]


def test_there_are_examples_of_every_kind() -> None:
    assert {kind for kind, _ in example_files()} == set(FILES)


# what is right by the schema and by evcosim, and in no file
RIGHT = [
    ("system", HEAD + "memory_limit = inf\nparameters = { a = 1, b = true, c = 'x', d = 0.5 }\n"),
    ("system", HEAD + "map.inputs.x = 'y'\nmap.outputs.z = { variable = 'y', invert = true }\n"),
    ("system", HEAD.replace("a]", "'größe']")),
    ("system", HEAD + "[buses.can0]\ndbc = 'x'\nresolution = 'ideal'\n[[connect]]\nfrom = 'a.b'\nvia = 'can0.M.S'\n"),
    ("system", HEAD + "[[connect]]\nfrom = 'a.der(x.y)'\nto = ['a.c']\n"),
    ("scenario", ""),
    ("scenario", "[[event]]\ntime = 1\naction = 'reset'\nvariable = 'a.b'\n"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\ncsv = 'x.csv'\ncolumn = 'x'\n"),
    ("scenario", "[[metrics]]\nname = 'm'\nsignal = 'a.b'\nreduce = 'settling'\nthreshold = 1\nthreshold_unit = 'm'\n"),
    ("scenario", "[[metrics]]\nname = 'm'\nsignal = 'a.b'\nreduce = 'share_equal'\nvalue = 'idle'\nper.signal = 'a.c'\n"),
    ("swap", "fmu = 'F'\n"),
]  # fmt: skip # one file a line


@pytest.mark.parametrize(("kind", "text"), RIGHT)
def test_other_files_are_right(kind: str, text: str) -> None:
    data = tomllib.loads(text)
    Draft202012Validator(SCHEMAS[kind]).validate(data)
    FILES[kind].model_validate(data)


BROKEN = [
    ("system", "name = 'x'\n"),
    ("system", "name = 'x'\nunits = {}\n"),
    ("system", "[units.a]\nfmu = 'A'\n"),
    ("system", HEAD.replace("'x'", "'my-car'")),
    ("system", HEAD.replace(".a]", ".my-car]")),
    ("system", HEAD.replace("fmu", "fnu")),
    ("system", HEAD + "period = 0.0\n"),
    ("system", HEAD + "substeps = 1.5\n"),
    ("system", HEAD + "tolerance = 1.0\n"),
    ("system", HEAD + "isolation = 'thread'\n"),
    ("system", HEAD + "map.input.x = 'y'\n"),
    ("system", HEAD + "map.inputs.x = 3\n"),
    ("system", HEAD + "map.inputs.x.unit = 'm'\n"),
    ("system", HEAD + "parameters.mass = [1]\n"),
    ("system", HEAD + "[experiment]\nstep_size = 0.0\n"),
    ("system", HEAD + "[experiment]\nalgorithm = 'jacoby'\n"),
    ("system", HEAD + "[experiment]\nstep = 0.01\n"),
    ("system", HEAD + "[[connect]]\nto = ['a.b']\n"),
    ("system", HEAD + "[[connect]]\nfrom = 'a'\n"),
    ("system", HEAD + "[[connect]]\nfrom = 'a.b'\nto = 'a.c'\n"),
    ("system", HEAD + "[[connect]]\nsource = 'a.b'\nto = ['a.c']\n"),
    ("system", HEAD + "[[connect]]\nfrom = 'a.b'\nvia = 'can0.M'\n"),
    ("system", HEAD + "[[connect]]\nfrom = 'a.b'\ninitial = 1\n"),
    ("system", HEAD + "[buses.can0]\n"),
    ("system", HEAD + "[buses.can0]\ndbc = 'x'\ncycle = 0\n"),
    ("system", HEAD + "[buses.can0]\ndbc = 'x'\nresolution = 0.5\n"),
    ("system", HEAD + "[buses.can0]\ndbc = 'x'\nresolution = 'fine'\n"),
    ("system", HEAD + "[buses.can0]\ndbc = 'x'\nrounding = 'up'\n"),
    ("system", HEAD + "[figure]\npanels = []\n"),
    ("system", HEAD + "[[figure.panels]]\nsignals = ['a.b']\nlimits = [1]\n"),
    ("system", HEAD + "[[metrics]]\nname = 'm'\nsignal = 'a.b'\nreduce = 'maximum'\n"),
    ("system", HEAD + "[[metrics]]\nname = 'm'\nsignal = 'a.b'\nreduce = 'share_above'\n"),
    ("system", HEAD + "[[metrics]]\nname = 'm'\nsignal = 'a.b'\nthreshold = 1\n"),
    ("system", HEAD + "[[metrics]]\nname = 'm'\nsignal = 'a.b'\nthreshold_unit = 'm'\n"),
    ("system", HEAD + "[[metrics]]\nname = 'm'\nsignal = 'a.b'\nper = { signal = 'a.b', value = 1 }\n"),
    ("system", HEAD + "[budget]\nmetric = 'm'\n"),
    ("scenario", "stimuli = []\n"),
    ("scenario", "[experiment]\nstart_time = 1.0\n"),
    ("scenario", "[parameters]\nmass = 1\n"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\n"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\nconstant = 1\nsine = { amplitude = 1, period = 1 }\n"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\nconstant = 1\ncolumn = 'x'\n"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\ntable = [[0, 1], [1]]\n"),
    ("scenario", "[[stimulus]]\nto = 'a.b'\nsine = { amplitude = 1, period = 0 }\n"),
    ("scenario", "[[event]]\ntime = 1\naction = 'bias'\nvariable = 'a.b'\n"),
    ("scenario", "[[event]]\ntime = -2e12\naction = 'reset'\nvariable = 'a.b'\n"),
    ("scenario", "[[event]]\ntime = 1\naction = 'overide'\nvariable = 'a.b'\nvalue = 1\n"),
    ("scenario", "[identification]\ninput = 'a.b'\noutput = 'a.c'\n"),
    ("scenario", "[identification]\ninput = 'a.b'\noutput = 'a.c'\namplitude = 0\n"),
    ("scenario", "[identification]\ninput = 'a.b'\noutput = 'a.c'\namplitude = 1\nrepeats = 0\n"),
    ("scenario", "[identification]\ninput = 'a.b'\noutput = 'a.c'\namplitude = 1\nsweep = [0, 1]\n"),
    ("swap", "replaces = 'a.b'\n"),
    ("swap", "fmu = 'F'\n[units.vehicle]\nfmu = 'F'\n"),
]


@pytest.mark.parametrize(("kind", "text"), BROKEN)
def test_a_broken_file_is_refused_by_both(kind: str, text: str) -> None:
    data = tomllib.loads(text)
    assert not Draft202012Validator(SCHEMAS[kind]).is_valid(data)
    with pytest.raises(ValidationError):
        FILES[kind].model_validate(data)


EVENT = "[[event]]\ntime = 1\nvariable = 'a.b'\n"
METRIC = "[[metrics]]\nname = 'm'\nsignal = 'a.b'\n"

# a file with one mistake, the place of each error that an editor shows, a part of what it says
MARKED = [
    (EVENT + "action = 'overide'\nvalue = 1\n", ["event 1.action"], "'overide' is not one of"),
    (EVENT + "value = 1\n", ["event 1"], "'action' is a required property"),
    (EVENT + "action = 'override'\n", ["event 1"], "'value' is a required property"),
    (EVENT + "action = 'bias'\nvalue = 'x'\n", ["event 1.value"], "'x' is not of type 'number'"),
    (EVENT + "action = 'reset'\nvalue = 1\n", ["event 1"], "('value' was unexpected)"),
    (EVENT + "action = 'bias'\nvalue = 1\nvalu = 1\n", ["event 1"], "('valu' was unexpected)"),
    ("[[event]]\ntime = -2e12\nvariable = 'a.b'\naction = 'reset'\n", ["event 1.time"], "less than the minimum"),
    ("[[event]]\ntime = 1\nvariable = 'ab'\naction = 'reset'\n", ["event 1.variable"], "does not match"),
    ("[[stimulus]]\nto = 'a.b'\n", ["stimulus 1"], "'constant' is a required property"),
    ("[[stimulus]]\nto = 'a.b'\nconstant = 1\ncsv = 'x'\n", ["stimulus 1.constant", "stimulus 1.csv"], "should not be valid"),
    ("[[stimulus]]\nto = 'a.b'\nconstant = [1]\n", ["stimulus 1.constant"], "is not valid under any of the given schemas"),
    (METRIC + "reduce = 'maximum'\nthreshold = 1\n", ["metrics 1.reduce"], "'maximum' is not one of"),
    (METRIC + "reduce = 'settling'\n", ["metrics 1"], "'threshold' is a required property"),
    (METRIC + "reduce = 'max'\nthreshold = 1\n", ["metrics 1.threshold"], "should not be valid"),
    (METRIC + "value = 1\n", ["metrics 1.value"], "should not be valid"),
    (METRIC + "per = { signal = 'a.b', reduce = 'time_equal' }\n", ["metrics 1.per"], "'value' is a required"),
]  # fmt: skip # one file a line


@pytest.mark.parametrize(("text", "places", "said"), MARKED)
def test_an_editor_marks_the_key_that_is_wrong(text: str, places: list[str], said: str) -> None:
    """Not the whole table, as where one of several schemas is needed."""
    errors = list(Draft202012Validator(SCHEMAS["scenario"]).iter_errors(tomllib.loads(text)))
    assert sorted(spelled(list(error.absolute_path)) for error in errors) == places
    best = best_match(errors)
    assert best is not None
    assert said in best.message


def test_an_editor_completes_the_keys_of_an_event_before_its_action() -> None:
    event = SCHEMAS["scenario"]["properties"]["event"]["items"]
    assert set(event["properties"]) == {"time", "variable", "action", "value"}
    assert set(event["properties"]["action"]["enum"]) == {"override", "bias", "reset", "set"}
    assert all(about["description"] for about in event["properties"].values())


# ---- types in words


@pytest.mark.parametrize(
    ("table", "key", "text"),
    [
        ("Experiment", "step_size", "number >= 1e-12 and <= 1e+12"),
        ("Experiment", "algorithm", '"gauss_seidel" or "jacobi"'),
        ("UnitEntry", "substeps", "whole number >= 1 and <= 1e+06"),
        ("UnitEntry", "tolerance", "number > 0 and < 1"),
        ("UnitEntry", "strict", "true or false"),
        ("UnitEntry", "absent", "list of texts"),
        ("UnitEntry", "map", "table"),
        ("BusEntry", "resolution", 'number >= 1 and <= 1e+09 or "ideal"'),
        ("Connection", "to", "list of unit.variable"),
        ("PanelSpec", "limits", "[number, number]"),
        ("MetricSpec", "value", "number or text or true or false"),
    ],
)
def test_types_in_words(table: str, key: str, text: str) -> None:
    assert type_text(SCHEMAS["system"]["$defs"][table]["properties"][key]) == text


class Bare(BaseModel):
    """A table whose key has no text."""

    key: int = 3


def test_a_key_without_a_text_is_seen() -> None:
    assert key_texts(Bare) == {"key": ""}
    assert json_schema(Bare, "bare")["properties"]["key"]["description"] == " Default: 3."
