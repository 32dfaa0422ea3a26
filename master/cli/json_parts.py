"""The parts of which the JSON schemas of `json_schemas` are made."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Schema = dict[str, Any]


def of(kind: str | list[str], about: str, **more: Any) -> Schema:
    """Return the schema of a JSON type, or of several."""
    return {"type": kind, "description": about, **more}


def text(about: str) -> Schema:
    """Return the schema of a text."""
    return of("string", about)


def number(about: str) -> Schema:
    """Return the schema of a number."""
    return of("number", about)


def whole(about: str) -> Schema:
    """Return the schema of a whole number."""
    return of("integer", about)


def flag(about: str) -> Schema:
    """Return the schema of true or false."""
    return of("boolean", about)


def or_null(schema: Schema) -> Schema:
    """Return a schema that takes null too."""
    return schema | {"type": [schema["type"], "null"]}


def listed(about: str, items: Schema | None = None) -> Schema:
    """Return the schema of a list, of texts where `items` does not say otherwise."""
    return of("array", about, items=items or {"type": "string"})


def by_name(about: str, values: Schema) -> Schema:
    """Return the schema of an object with any keys."""
    return of("object", about, additionalProperties=values)


def record(about: str, keys: Mapping[str, Schema], optional: tuple[str, ...] = ()) -> Schema:
    """Return the schema of an object with these keys and no others, all but the `optional` ones needed."""
    needed = [key for key in keys if key not in optional]
    return of("object", about, properties=dict(keys), required=needed, additionalProperties=False)


VALUE = of(["number", "string", "boolean", "null"], "A value of any type.")
FILES = {"folder": text("The folder of the files."), "files": listed("The names of the files in it.")}
