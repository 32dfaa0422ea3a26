"""The parts of the JSON schemas."""

from __future__ import annotations

import jsonschema
import pytest

from evcosim.master.cli.json_parts import by_name, flag, listed, number, or_null, record, text, whole

RECORD = record(
    "r", {"a": text("t"), "b": or_null(number("n")), "c": listed("l", whole("w"))}, optional=("c",)
)


@pytest.mark.parametrize(
    ("value", "fits"),
    [
        ({"a": "x", "b": 1.5}, True),
        ({"a": "x", "b": None, "c": [1, 2]}, True),
        ({"a": "x"}, False),
        ({"a": None, "b": 1}, False),
        ({"a": "x", "b": 1, "c": [1.5]}, False),
        ({"a": "x", "b": 1, "d": 1}, False),
        ([], False),
    ],
)
def test_a_record(value: object, fits: bool) -> None:
    assert jsonschema.Draft202012Validator(RECORD).is_valid(value) is fits


def test_names_and_lists() -> None:
    assert jsonschema.Draft202012Validator(by_name("n", flag("f"))).is_valid({"any": True})
    assert not jsonschema.Draft202012Validator(by_name("n", flag("f"))).is_valid({"any": 1})
    assert jsonschema.Draft202012Validator(listed("l")).is_valid(["text"])
    assert not jsonschema.Draft202012Validator(listed("l")).is_valid([1])
