"""The tables of docs/fmus-elsewhere.md, made of what was recorded and of the systems."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from benchmarks import page
from support.importers.conversions import converted
from support.importers.trials import KINDS, SAID, TRIALS

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "fmus-elsewhere.md"
RECORD = Path(__file__).with_name("record.json")
NAMES = {"python": "Python", "native 2": "native, FMI 2.0", "native 3": "native, FMI 3.0"}


def recorded() -> dict[str, Any]:
    """Return what the last `--write` recorded."""
    found: dict[str, Any] = json.loads(RECORD.read_text(encoding="utf-8"))
    return found


def write(record: dict[str, Any]) -> None:
    """Keep a record, and make the tables of the page anew."""
    RECORD.write_text(_lines(record) + "\n", encoding="utf-8")
    for name, text in tables(record).items():
        page.put(PAGE, name, text)


def _lines(value: Any, depth: int = 0) -> str:
    """Return JSON with a line for each trial."""
    if depth == 4 or not isinstance(value, dict):
        return json.dumps(value)
    inside = ",\n".join(f"{' ' * depth} {json.dumps(k)}: {_lines(v, depth + 1)}" for k, v in value.items())
    return f"{{\n{inside}\n{' ' * depth}}}"


def tables(record: dict[str, Any]) -> dict[str, str]:
    """Return the text of each place of the page."""
    notes: list[str] = []
    parts = [_of_kind(kind, record["importers"], notes) for kind in KINDS]
    listed = "\n".join(f"{number}. {text}" for number, text in enumerate(notes, 1))
    return {
        "importers": f"Measured on: {record['machine']}.\n\n" + "\n\n".join(parts) + f"\n\n{listed}",
        "libraries": _libraries(record["libraries"]),
        "connections": _connections(),
        "speeds": _speeds(record["speeds"]),
    }


def _of_kind(kind: str, importers: dict[str, Any], notes: list[str]) -> str:
    """Return the table of a kind of FMU; reasons are collected as notes."""
    header = ["importer", "models", "difference", "in exact steps", "parameters", "two", "state", "refusal"]
    rows = []
    for name, importer in importers.items():
        found = importer[kind]
        rows.append(
            [
                f"{name} {importer['version']}".strip(),
                " ".join([str(found["loaded"]["models"]), *_notes(found["loaded"]["others"], notes)]),
                _size([found.get(what) for what in TRIALS if what != "exact"]),
                _size([found.get("exact")]),
                *(_does(found.get(what), notes) for what in ("parameters", "two", "state")),
                _refusals(found.get("refusal")),
            ]
        )
    return f"### {NAMES[kind]}\n\n{page.table(header, rows)}"


def _size(trials: list[dict[str, Any] | None]) -> str:
    """Return the largest difference of some trials in two digits, "none" for the same bits."""
    sizes = [trial["largest"] for trial in trials if trial and trial["models"]]
    if not sizes:
        return "-"
    return f"{max(sizes):.1e}" if max(sizes) else "none"


def _does(trial: dict[str, Any] | None, notes: list[str]) -> str:
    """Return whether a trial came out right with all of its models."""
    if trial is None:
        return "-"
    return " ".join(["no" if trial["others"] else "yes", *_notes(trial["others"], notes)])


def _refusals(said: dict[str, list[str]] | None) -> str:
    """Return what an importer shows of a refused parameter."""
    if said is None:
        return "-"
    return ", ".join(dict.fromkeys(text if text in SAID else "status" for text in said))


def _notes(reasons: dict[str, list[str]], notes: list[str]) -> list[str]:
    """Return the marks of reasons, each of which is noted once."""
    marks = []
    for reason, models in reasons.items():
        text = f"`{reason}`" if len(models) > 3 else f"{', '.join(models)}: `{reason}`"
        if text not in notes:
            notes.append(text)
        marks.append(f"[{notes.index(text) + 1}]")
    return marks


def _libraries(found: dict[str, Any]) -> str:
    """Return what the native libraries need."""
    rows = [[name, ", ".join(f"`{one}`" for one in values)] for name, values in found.items()]
    return page.table(["all native FMUs together", "linux64"], rows).replace("--:", "---")


def _connections() -> str:
    """Return the connections whose ends differ in the unit."""
    rows = [
        [c.system, f"`{c.source}` [{c.source_unit}]", f"`{c.target}` [{c.target_unit}]", f"{c.factor:g}"]
        for c in converted()
    ]
    return page.table(["system", "from", "to", "factor"], rows)


def _speeds(found: dict[str, Any]) -> str:
    """Return the speeds of the scooter in km/h."""

    def shown(value: float | str) -> str:
        return f"`{value}`" if isinstance(value, str) else f"{value:.2f}"

    rows = [
        [tool, *(shown(of_tool[name]) for name in ("plain", "factor", "gain"))]
        for tool, of_tool in found.items()
    ]
    return page.table(["tool", "as it is", "`LinearTransformation`", "gain between"], rows)
