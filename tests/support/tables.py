"""The tables of docs/system-file.md, made of the docstrings under the keys.

    .venv/bin/python tests/support/tables.py   # writes the page anew, after a change of a key or its text

A table stands between `<!-- table: KIND PATH -->` and `<!-- end -->`: KIND is system, scenario or swap, PATH
the keys to the table as in the file, with a name in capitals for any name: `units.NAME.map`. Of tables that
a key tells apart, `stimulus:can_log` is the one that needs that key, and `stimulus` the other.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from evcosim.cosim.swap.swap_file import SwapFile
from evcosim.cosim.system.scenario import ScenarioFile
from evcosim.cosim.system.schema import json_schema, type_text
from evcosim.cosim.system.system import SystemFile
from evcosim.cosim.writing import markdown_table

PAGE = Path(__file__).parents[2] / "docs" / "system-file.md"
MODELS = {"system": SystemFile, "scenario": ScenarioFile, "swap": SwapFile}

_PART = re.compile(r"(<!-- table: (\w+) ?(\S*) -->\n).*?(<!-- end -->)", re.DOTALL)


def written(page: str) -> str:
    """Return a page with its tables made anew; all else stays."""
    return _PART.sub(lambda part: part[1] + table(part[2], part[3]) + part[4], page)


def table(kind: str, path: str) -> str:
    """Return the keys at a path in a kind of file as a Markdown table, below the text of their record."""
    schema = _schema(kind)
    path, _, key = path.partition(":")
    members = _tables(schema, schema, path.split(".") if path else [])
    if len(members) > 1 and not any("action" in member["properties"] for member in members):
        members = [m for m in members if key in m["required"]] if key else members[:1]
    rows = [_row(key, [m for m in members if key in m["properties"]], members) for key in _keys(members)]
    about = [_escaped(members[0]["description"]), ""] if len(members) == 1 else []
    return "\n".join(["", *about, *markdown_table(("key", "meaning"), rows), "", ""])


@functools.cache
def _schema(kind: str) -> dict[str, Any]:
    """Return the schema of a kind of file, which all tables of it are made of."""
    return json_schema(MODELS[kind], kind)


def paths(page: str) -> list[tuple[str, str]]:
    """Return kind and path of each table of a page."""
    return [(kind, path) for _, kind, path, _ in _PART.findall(page)]


def _tables(schema: dict[str, Any], part: dict[str, Any], path: Sequence[str]) -> list[dict[str, Any]]:
    """Return the tables that may stand at a path from `part` on: one, or those of a union."""
    if "$ref" in part:
        return _tables(schema, schema["$defs"][part["$ref"].rpartition("/")[2]], path)
    for union in ("anyOf", "oneOf"):
        if union in part and "properties" not in part:
            return [table for member in part[union] for table in _tables(schema, member, path)]
    if kinds := [rule["then"] for rule in part.get("allOf", ()) if "$ref" in rule["then"]]:
        return [table for kind in kinds for table in _tables(schema, kind, path)]
    if "items" in part:
        return _tables(schema, part["items"], path)
    if not path:
        return [part] if "properties" in part else []
    key, *rest = path
    if not key.isupper():
        return _tables(schema, part["properties"][key], rest) if key in part["properties"] else []
    named = part.get("patternProperties", {"": part.get("additionalProperties")})
    return _tables(schema, next(iter(named.values())), rest)


def _keys(members: Sequence[dict[str, Any]]) -> list[str]:
    """Return the keys, those first without which the table is wrong."""
    keys = dict.fromkeys(key for member in members for key in member["properties"])
    return sorted(keys, key=lambda key: not _is_needed(key, members))


def _is_needed(key: str, members: Sequence[dict[str, Any]]) -> bool:
    return all(key in member.get("required", ()) for member in members)


def _row(key: str, having: Sequence[dict[str, Any]], members: Sequence[dict[str, Any]]) -> list[str]:
    """Return the row of a key; where tables of several kinds stand there, what it means in each."""
    abouts = [member["properties"][key] for member in having]
    types = " or ".join(dict.fromkeys(map(type_text, abouts)))
    needed = ", needed" if _is_needed(key, members) else ""
    texts = list(dict.fromkeys(about["description"] for about in abouts))
    if len(members) > 1 and "const" in abouts[0]:
        each = (f"`{about['const']}`: {m['description']}" for about, m in zip(abouts, having, strict=True))
        texts = [texts[0], *each]
    elif len(having) < len(members) or len(texts) > 1:
        texts = [f"{_for(text, having, key)} {text}" for text in texts]
    text = " ".join(" ".join(texts).split())
    text = re.sub(r"Default: (.*)\.$", r"Default: `\1`.", text)
    types = re.sub(r'"[^"]*"', r"`\g<0>`", _escaped(types))
    return [f"`{key}`<br>{types}{needed}", _escaped(text)]


def _for(text: str, having: Sequence[dict[str, Any]], key: str) -> str:
    """Return the actions for which a key has this meaning."""
    those = [m for m in having if m["properties"][key]["description"] == text]
    names = [f"`{m['properties']['action']['const']}`" for m in those]
    return f"For {', '.join(names[:-1])} and {names[-1]}." if len(names) > 1 else f"For {names[0]}."


def _escaped(text: str) -> str:
    return text.replace("<", "&lt;")


def main() -> None:
    """Write the page."""
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main()
