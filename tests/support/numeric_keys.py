"""The numeric keys of a file's model, found in its JSON schema, and documents with a value at one of them."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

Place = tuple[str | int, ...]
_ANY = "*"


def numeric_places(model: type[BaseModel]) -> list[Place]:
    """Return the places of all numbers in a file: keys, 0 for an entry of a list, `*` for a name."""
    schema = model.model_json_schema(by_alias=True)
    return list(dict.fromkeys(_numbers(schema, schema.get("$defs", {}), ())))


def _numbers(schema: Any, tables: Any, place: Place) -> Iterator[Place]:
    if "$ref" in schema:
        schema = tables[schema["$ref"].rpartition("/")[2]]
    for member in schema.get("anyOf", schema.get("oneOf", ())):
        yield from _numbers(member, tables, place)
    if schema.get("type") in ("number", "integer"):
        yield place
    for key, inner in schema.get("properties", {}).items():
        yield from _numbers(inner, tables, (*place, key))
    for i, inner in enumerate(schema.get("prefixItems", ())):
        yield from _numbers(inner, tables, (*place, i))
    if isinstance(schema.get("items"), dict):
        yield from _numbers(schema["items"], tables, (*place, 0))
    named = [schema.get("additionalProperties"), *schema.get("patternProperties", {}).values()]
    for inner in named:
        if isinstance(inner, dict):
            yield from _numbers(inner, tables, (*place, _ANY))


def with_value(document: Any, place: Place, value: Any) -> Any:
    """Return the document with a value at a place.

    `*` is each name that the document has there; an entry of a list is the first that has the next key, or
    the first. Raises LookupError where the document has no such table.
    """
    changed = copy.deepcopy(document)
    at = changed
    for i, part in enumerate(place[:-1]):
        at = at[_chosen(at, part, place[i + 1])]
    at[_chosen(at, place[-1], None)] = value
    return changed


def _chosen(at: Any, part: str | int, following: Any) -> Any:
    if part == _ANY:
        return next(iter(at))
    if isinstance(part, int) and isinstance(following, str) and following != _ANY:
        return next((i for i, entry in enumerate(at) if following in entry), part)
    return part
