"""Sentences about what is wrong in a file: the key as the file spells it, the rule and the value."""

from __future__ import annotations

import datetime
import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from ..errors import nearest
from ..visible import visible_json

_LONGEST = 80
"""Characters of a value that a sentence shows at most."""

_NEEDED = {
    "model_type": "a table is needed",
    "model_attributes_type": "a table is needed",
    "dict_type": "a table is needed",
    "list_type": "a list is needed",
    "tuple_type": "a list is needed",
}

_LONGEST_INTEGER = 2000  # bits

Place = Sequence[str | int]
"""Keys and indexes of entries, counted from 0, from the file's top to one value."""


def sentences(error: ValidationError, data: Any, model: type[BaseModel]) -> list[str]:
    """Return one sentence for each problem that was found in `data`, read as a `model`."""
    return [_sentence(problem, data, model) for problem in error.errors(include_url=False)]


def _sentence(problem: Any, data: Any, model: type[BaseModel]) -> str:
    place, chosen = _spelled(problem, data, set(_discriminators(model)))
    path, kind, value = spelled(place) or "the file", problem["type"], problem["input"]
    if kind.startswith("union_tag"):
        return _about_a_tag(problem, place)
    if kind == "extra_forbidden":
        return f"{path}: unknown key{chosen}{_nearest_key(place, data, model)}"
    if kind == "missing":
        return f"{path}: this {'value' if isinstance(place[-1], int) else 'key'} is needed{chosen}"
    if kind == "float_type" and isinstance(value, int) and not isinstance(value, bool):
        return f"{path}: a number may be {sys.float_info.max:.3g} at most, not {brief(value)}"
    rule = _NEEDED.get(kind) or problem["msg"].removeprefix("Value error, ")
    if kind in ("too_short", "too_long"):
        return f"{path}: {rule.replace('Dictionary', 'Table')}"  # which says how many there are
    if kind == "value_error" and isinstance(value, Mapping):
        return f"{path}: {rule}"  # a rule between keys, which names them itself
    if kind in ("list_type", "tuple_type") and isinstance(value, str):
        rule += f", as in {place[-1]} = [{brief(value)}]"
    near = _nearest(value, problem["ctx"]["expected"]) if kind == "literal_error" else ""
    return f"{path}: {rule}, not {brief(value)}{near}"


def _about_a_tag(problem: Any, place: Place) -> str:
    """Return what is wrong with the key that says which table stands at `place`, as `action` of an event."""
    key, table = problem["ctx"]["discriminator"].strip("'"), problem["input"]
    path = spelled([*place, key])
    if problem["type"] == "union_tag_invalid":
        tags = problem["ctx"]["expected_tags"]
        known = " or ".join(tags.rsplit(", ", 1))
        near = _nearest(table[key], tags)
        return f"{path}: Input should be {known}, not {brief(table[key])}{near}"
    typo = next((name for name in table if nearest(name, [key])), None)
    if typo is not None:
        return f"{spelled([*place, typo])}: unknown key{nearest(typo, [key])}"
    return f"{path}: this key is needed"


def _spelled(problem: Any, data: Any, tagged_by: set[str]) -> tuple[list[str | int], str]:
    """Return the place of a problem in the file, and " with KEY = VALUE" where that chose the table's kind.

    pydantic puts names of its own between the keys: the kind that the key of a table chose (one of
    `tagged_by`), the member of a union, "[key]". Whatever is no key or index there is such a name, but for
    the key that is missing, which comes last.
    """
    place: list[str | int] = []
    chosen, is_tag = "", False
    for number, part in enumerate(problem["loc"], 1):
        tags = [key for key in tagged_by if isinstance(data, Mapping) and data.get(key) == part]
        missing = problem["type"] == "missing" and number == len(problem["loc"])
        if tags and not is_tag:
            chosen, is_tag = f' with {tags[0]} = "{part}"', True
        elif missing or _is_in(data, part):
            place.append(part)
            data, is_tag = None if missing else data[part], False
    return place, chosen


def _is_in(data: Any, part: str | int) -> bool:
    if isinstance(data, Mapping):
        return part in data
    return isinstance(data, list | tuple) and isinstance(part, int) and part < len(data)


def spelled(place: Place) -> str:
    """Return keys with dots and the number of an entry, counted from 1: `connect 2.via`."""
    return "".join(f" {part + 1}" if isinstance(part, int) else f".{_key(part)}" for part in place)[1:]


def _nearest(value: Any, words: str) -> str:
    """Return the hint at the nearest of some quoted words; nothing for what is no text."""
    return nearest(value, re.findall("'([^']*)'", words)) if isinstance(value, str) else ""


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else shown(name)


def shown(value: Any) -> str:
    """Return a value as a TOML file writes it; what TOML cannot write, as Python does."""
    match value:
        case bool():
            return str(value).lower()
        case str():
            literal = value.isprintable() and "'" not in value
            return f"'{value}'" if literal else visible_json(json.dumps(value, ensure_ascii=False))
        case list() | tuple():
            return f"[{', '.join(map(shown, value))}]"
        case Mapping():
            inner = ", ".join(f"{_key(str(key))} = {shown(each)}" for key, each in value.items())
            return f"{{ {inner} }}" if inner else "{}"
        case datetime.date() | datetime.time():
            return value.isoformat()
        case int() if value.bit_length() > _LONGEST_INTEGER:
            return f"{value:#x}"  # Python writes no decimal number of more than some thousand digits
        case _:
            return repr(value)


def brief(value: Any) -> str:
    """Return a value as a file writes it, cut where it is long."""
    text = shown(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def _nearest_key(place: Place, data: Any, model: type[BaseModel]) -> str:
    """Return the hint at the key that was meant by an unknown one: a key of the table in which it stands.

    There is none for a key of another kind of the table, as `value` where an event's action takes none.
    """
    kinds: list[Any] = [model]
    for part in place[:-1]:
        kinds = [inner for kind in kinds for inner in _inside(kind, part)]
        data = data[part]
    models = [m for kind in kinds for m in _members(kind) if isinstance(m, type) and issubclass(m, BaseModel)]
    if any(place[-1] in _fields(m) for m in models):
        return ""
    return nearest(str(place[-1]), sorted({key for m in models if _may_be(m, data) for key in _fields(m)}))


def _inside(kind: Any, part: str | int) -> Iterator[Any]:
    """Yield the types of what stands under a key or index in a value of this type."""
    for member in _members(kind):
        origin, arguments = get_origin(member), get_args(member)
        if isinstance(member, type) and issubclass(member, BaseModel):
            if part in (fields := _fields(member)):
                yield fields[str(part)].annotation
        elif origin in (dict, list):
            yield arguments[-1]
        elif origin is tuple and isinstance(part, int):
            yield arguments[part]


def _members(kind: Any) -> Iterator[Any]:
    """Yield the members of a union, as deep as there are unions in it; another type is its own member."""
    if get_origin(kind) is Annotated:
        yield from _members(get_args(kind)[0])
    elif get_origin(kind) in (Union, UnionType):
        for member in get_args(kind):
            yield from _members(member)
    else:
        yield kind


def _may_be(model: type[BaseModel], table: Mapping[str, Any]) -> bool:
    """Return False where a key, as `action` of an event, has a value that makes the table another model's."""
    return all(
        table.get(key) in get_args(field.annotation)
        for key, field in _fields(model).items()
        if field.is_required() and get_origin(field.annotation) is Literal
    )


def _fields(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """Return the fields of a model by their keys in the file."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _models_in(argument)


def _discriminators(model: type[BaseModel]) -> Iterator[str]:
    """Yield the keys, as `action`, by which tables of a file of this model say of which kind they are."""
    for field in model.model_fields.values():
        for info in (field, *_infos_in(field.annotation)):
            if isinstance(info.discriminator, str):
                yield info.discriminator
        for inner in _models_in(field.annotation):
            if inner is not model:
                yield from _discriminators(inner)


def _infos_in(annotation: Any) -> Iterator[FieldInfo]:
    if isinstance(annotation, FieldInfo):
        yield annotation
    for argument in get_args(annotation):
        yield from _infos_in(argument)
