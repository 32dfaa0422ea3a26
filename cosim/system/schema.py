"""JSON schemas of the files, by which editors complete, explain and check them while they are written.

The texts are the docstrings under the keys. pydantic could keep them (`use_attribute_docstrings`), but would
read the source of every model when it is imported, 30 ms of each command; here the one that needs them does.
"""

from __future__ import annotations

import ast
import inspect
import itertools
import json
import re
import sys
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue


def json_schema(model: type[BaseModel], title: str) -> JsonSchemaValue:
    """Return the schema (draft 2020-12) of a file of this model, with its keys as the file spells them."""
    schema = model.model_json_schema(by_alias=True, schema_generator=_FileSchema)
    schema = {key: _by_tag(part, schema.get("$defs", {})) for key, part in schema.items()}
    schema.pop("title", None)
    return {"$schema": _FileSchema.schema_dialect, "title": title} | schema


def key_texts(model: type[BaseModel]) -> dict[str, str]:
    """Return the docstring under each key, by the key as the file spells it; "" where there is none."""
    found: dict[str, str] = {}
    for base in reversed(model.__mro__):
        if issubclass(base, BaseModel) and base is not BaseModel:
            found |= _docstrings(base)
    return {field.alias or name: found.get(name, "") for name, field in model.model_fields.items()}


def type_text(schema: JsonSchemaValue) -> str:
    """Return the type and range that the schema of a key gives, in words: `number > 0`, `"max" or "min"`."""
    if members := schema.get("anyOf", schema.get("oneOf")):
        return " or ".join(dict.fromkeys(map(type_text, members)))
    if "enum" in schema or "const" in schema:
        return " or ".join(f'"{value}"' for value in schema.get("enum", [schema.get("const")]))
    if "prefixItems" in schema:
        return f"[{', '.join(map(type_text, schema['prefixItems']))}]"
    if "items" in schema:
        return f"list of {_PLURAL.sub('s', type_text(schema['items']))}"
    kind = schema.get("type")
    if kind in ("number", "integer"):
        limits = [f"{sign} {schema[key]:g}" for key, sign in _LIMITS.items() if key in schema]
        return f"{'whole number' if kind == 'integer' else 'number'} {' and '.join(limits)}".rstrip()
    return schema.get("title") or {"string": "text", "boolean": "true or false"}.get(str(kind), "table")


_PLURAL = re.compile(r"(?<=number)$|(?<=text)(?= or |$)|(?<=table)$")
_LIMITS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}


class _FileSchema(GenerateJsonSchema):
    """The schema of what a file may hold: TOML has no null, and a default that is a table says nothing."""

    def nullable_schema(self, schema: Any) -> JsonSchemaValue:
        """Return the schema without null."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: Any) -> JsonSchemaValue:
        """Return the schema with a default, if a file could write it."""
        found = super().default_schema(schema)
        if found.get("default") is None or isinstance(found["default"], dict):
            found.pop("default", None)
        return found

    def field_title_should_be_set(self, schema: Any) -> bool:
        """Return False: a title made of a key says no more than the key."""
        return False

    def model_schema(self, schema: Any) -> JsonSchemaValue:
        """Return the schema of a table, each key with its docstring and its default."""
        found = super().model_schema(schema)
        found.pop("title", None)
        for key, text in key_texts(schema["cls"]).items():
            about = found["properties"][key]
            about["description"] = text + _default_text(about.get("default"))
        return found

    def dict_schema(self, schema: Any) -> JsonSchemaValue:
        """Return the schema of a table whose keys are names: a wrong name is refused."""
        found = super().dict_schema(schema)
        if "patternProperties" in found:
            found["additionalProperties"] = False
        return found


def _by_tag(part: Any, tables: JsonSchemaValue) -> Any:
    """Return a part of a schema in which the key that says a table's kind, as `action`, chooses its schema.

    pydantic's `oneOf` refuses the whole table, whatever is wrong in it; here an error is at its key. All
    keys stand in `properties` too, by which editors complete them before the kind is known.
    """
    if isinstance(part, list):
        return [_by_tag(inner, tables) for inner in part]
    if not isinstance(part, dict):
        return part
    if "oneOf" in part and "discriminator" not in part:
        first, second = (str(member["$ref"]) for member in part["oneOf"])
        return _by_key(first, second, tables)
    if "discriminator" not in part:
        return {key: _by_tag(inner, tables) for key, inner in part.items()}
    tag, names = part["discriminator"]["propertyName"], part["discriminator"]["mapping"]
    declared = [member["$ref"] for member in part["oneOf"]]  # pydantic sorts the names
    kinds = dict(sorted(names.items(), key=lambda kind: declared.index(kind[1])))
    texts: dict[str, JsonSchemaValue] = {}
    for reference in kinds.values():
        for key, about in tables[reference.rpartition("/")[2]]["properties"].items():
            texts.setdefault(key, {"description": about["description"]})
    texts[tag]["enum"] = list(kinds)
    return {
        "type": "object",
        "properties": texts,
        "required": [tag],
        "allOf": [
            {"if": {"properties": {tag: {"const": kind}}, "required": [tag]}, "then": {"$ref": reference}}
            for kind, reference in kinds.items()
        ],
    }


def _by_key(first: str, second: str, tables: JsonSchemaValue) -> Any:
    """Return the schema of a table of two kinds: the second needs a key that the first has not."""
    ours, theirs = (tables[reference.rpartition("/")[2]] for reference in (first, second))
    key = next(key for key in theirs["required"] if key not in ours["properties"])
    texts = {
        name: {"description": about["description"]}
        for name, about in (theirs["properties"] | ours["properties"]).items()
    }
    return {
        "type": "object",
        "properties": texts,
        "allOf": [
            {"if": {"not": {"required": [key]}}, "then": {"$ref": first}},
            {"if": {"required": [key]}, "then": {"$ref": second}},
        ],
    }


def _default_text(default: Any) -> str:
    """Return the sentence about a default: editors show the description alone."""
    return "" if default in (None, "", []) else f" Default: {_written(default)}."


def _written(value: Any) -> str:
    """Return a default as a TOML file would have it."""
    if isinstance(value, list):
        return f"[{', '.join(map(_written, value))}]"
    if isinstance(value, float):
        text = f"{value:g}" if float(f"{value:g}") == value else repr(value)
        return re.sub(r"e\+?(-?)0*", r"e\1", text)
    return json.dumps(value)


def _docstrings(model: type[BaseModel]) -> dict[str, str]:
    """Return the texts under the fields that a class itself declares; {} where there is no source."""
    try:
        module = ast.parse(inspect.getsource(sys.modules[model.__module__]))
    except OSError:
        return {}
    body = next((n.body for n in module.body if isinstance(n, ast.ClassDef) and n.name == model.__name__), [])
    found = {}
    for field, text in itertools.pairwise(body):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
            match text:
                case ast.Expr(ast.Constant(str(value))):
                    found[field.target.id] = " ".join(inspect.cleandoc(value).split())
    return found
