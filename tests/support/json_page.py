"""docs/json.md: the keys of what each verb prints with --json, made of the schemas.

python tests/support/json_page.py --write
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from evcosim.master.cli.json_schemas import SCHEMAS

PAGE = Path(__file__).parents[2] / "docs" / "json.md"
HEAD = f"""# What `--json` prints

With `--json` {len(SCHEMAS)} verbs print JSON for programs on stdout; warnings and errors stay on stderr, and
the exit code is the same. A number that is not finite is `null`. `evcosim schema --json-of run` prints the
JSON schema of one of them. A new version may add keys; the [changelog](../CHANGELOG.md) says of any other
change.

```sh
evcosim run scooter --stop-time 5 --json
evcosim schema --json-of run
evcosim schema --json-of compare
```

Without it too a pipe or a file gets what a terminal shows, with each message on one line, so that it can be
searched. In a terminal tables and messages are wrapped to its width; names of files, and commands in quotes
where they fit, stay whole. Headings are bold there: `NO_COLOR`, `TERM=dumb` and `CLICOLOR=0` leave that
out, `FORCE_COLOR` and `CLICOLOR_FORCE` put it into a pipe. `COLUMNS` is the width of tables there.

In the tables `rows[].name` is the key `name` of each entry of the list `rows`, and `metrics.*.value`
the key `value` of each entry of `metrics`, by name.
"""


def rows(schema: dict[str, Any], path: str = "") -> Iterator[tuple[str, str, str]]:
    """Yield path, type and meaning of each key of a schema."""
    kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    if path:
        yield path, " or ".join(kinds), schema.get("description", "")
    for key, inner in schema.get("properties", {}).items():
        yield from rows(inner, f"{path}.{key}" if path else key)
    if isinstance(schema.get("additionalProperties"), dict):
        inner = schema["additionalProperties"]
        if "properties" in inner or isinstance(inner.get("additionalProperties"), dict):
            yield from rows(inner, f"{path}.*" if path else "*")
    if "properties" in schema.get("items", {}):
        for key, inner in schema["items"]["properties"].items():
            yield from rows(inner, f"{path}[].{key}")


def page() -> str:
    """Return the text of the page."""
    parts = [HEAD]
    for verb, schema in SCHEMAS.items():
        for each in schema.get("oneOf", [schema]):
            about = f": {each['description']}" if "oneOf" in schema else ""
            parts.append(f"## `evcosim {verb} --json`{about}\n")
            parts.append("| key | type | meaning |\n|---|---|---|")
            parts[-1] += "".join(f"\n| `{key}` | {kind} | {text} |" for key, kind, text in rows(each)) + "\n"
    return "\n".join(parts)


if __name__ == "__main__":
    if "--write" in sys.argv:
        PAGE.write_text(page(), encoding="utf-8")
    else:
        print(page())
