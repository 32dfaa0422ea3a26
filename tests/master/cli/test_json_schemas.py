"""What verbs print with --json is what their schemas say, and the page says the same."""

from __future__ import annotations

import json

import jsonschema
import pytest

from evcosim.cosim.system.toml import DATA
from evcosim.master.cli import app
from evcosim.master.cli.json_schemas import SCHEMAS, schema_of
from support import json_page

pytestmark = pytest.mark.usefixtures("warm_units", "warm_workers")

COMMANDS = [
    ("run", "scooter", "--stop-time", "2", "--profile", "--no-plot", "--no-report"),
    ("run", "Battery", "--input", "power=100", "--stop-time", "1", "--no-plot", "--no-report"),
    ("list",),
    ("info", "scooter"),
    ("info", "Scooter"),
    ("bus", "scooter", "--stop-time", "0.5", "-o", "bus"),
    ("info", str(DATA / "can" / "ev.dbc"), "--bitrate", "500000"),
    ("check", "Scooter", "--as", "scooter.vehicle", "--try", "500ms"),
    ("check", "Battery", "--as", "scooter.vehicle"),
    ("compare", "a", "b"),
    ("identify", "Scooter", "--input", "throttle", "--output", "speed", "--amplitude", "2",
     "--at-input", "28.2", "--sweep", "0.05,1", "--duration", "150", "--no-plot"),
    ("budget", "lane_keeping", "--stop-time", "0.5"),
]  # fmt: skip # a command a line


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: " ".join(command[:2]))
def test_the_output_is_what_the_schema_says(evcosim, request, command):
    if command[0] == "compare":
        request.getfixturevalue("two_runs")
    answer = evcosim(*command, "--json")
    assert answer.code in (0, 1), answer
    jsonschema.Draft202012Validator(schema_of(command[0])).validate(answer.json)


@pytest.mark.parametrize("verb", SCHEMAS)
def test_a_schema_is_one_and_is_printed(evcosim, verb):
    schema = schema_of(verb)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert json.loads(evcosim("schema", "--json-of", verb).out) == schema


def test_a_key_that_is_missing_or_too_much_is_found(evcosim):
    found = evcosim("list", "--json").json
    for wrong in (found | {"more": 1}, {"fmus": found["fmus"]}):
        assert not jsonschema.Draft202012Validator(schema_of("list")).is_valid(wrong)


def test_every_verb_with_json_has_a_schema():
    verbs = app.command().commands
    assert {name for name, verb in verbs.items() if any("--json" in p.opts for p in verb.params)} == set(
        SCHEMAS
    )


def test_the_page_says_what_the_schemas_say():
    assert json_page.PAGE.read_text(encoding="utf-8") == json_page.page(), (
        "tests/support/json_page.py --write"
    )
