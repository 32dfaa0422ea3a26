"""A hostile value at any place of the files of results is read, or refused with the file's name."""

from __future__ import annotations

import copy
import json
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.results import Results
from evcosim.cosim.results.rows_file import head
from evcosim.cosim.results.run_folder import recover
from evcosim.cosim.results.variable import ResultVariable

VALUES = [None, True, 0, -1, 1e308, 2**63, 10**400, "x", "", "a\0b", [], {}, [[1]], {"a": None}]
TEXTS = [
    '{"a": 1e999}',
    "[" * 200_000,
    '{"a":' * 200_000,
    "9" * 5000,
    '{"a": NaN}',
    "nul",
    "\x00",
    "\ufeff{}",
]
VARIABLES = [
    ResultVariable("a.x", "m/s"),
    ResultVariable("b.n", type="Enumeration", variability="discrete", items=((0, "off"), (1, "on"))),
]
HEAD = json.loads(head(Clock.counted(0.0, 0.1, 4), VARIABLES, {"evcosim": "0.2.0", "system": "toy"}))
ROWS = np.arange(8.0).reshape(4, 2).tobytes()
ABOUT = HEAD["manifest"] | {
    "status": "running",
    "variables": HEAD["variables"],
    "process": {"id": 1, "host": "h", "since": "now"},
    "files": {"system": "toy.toml", "scenario": None},
}


def places(data: Any, before: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    keys = data if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else ()
    for key in keys:
        yield (*before, key)
        yield from places(data[key], (*before, key))


def changed(data: Any, place: tuple[Any, ...], value: Any) -> Any:
    data = copy.deepcopy(data)
    at = data
    for key in place[:-1]:
        at = at[key]
    at[place[-1]] = value
    return data


def use(folder: Path) -> str:
    """Read a folder of results, and all that a reader does with it, then recover it."""
    try:
        results = Results.read(folder)
        results.final()
        assert results.data.shape == (len(results.time), len(results.names))
        json.dumps(results.manifest)
        results.to_csv(folder / "copy.csv")
        (folder / "copy.csv").unlink()
        recover(folder)
    except ConfigError as error:
        return f"refused: {error}"
    except Exception:  # to name the value beside it
        return traceback.format_exc()
    return "done"


def written(folder: Path, rows: str, about: str) -> Path:
    for path in folder.iterdir():
        path.unlink()
    line = rows.encode(errors="surrogatepass")
    (folder / "results.rows").write_bytes(line + b" " * (-(len(line) + 1) % 8) + b"\n" + ROWS)
    (folder / "run.json").write_text(about, encoding="utf-8")
    return folder


def check(folder: Path, rows: str, about: str, shown: str) -> str:
    said = use(written(folder, rows, about))
    assert said == "done" or said.startswith(("refused: ", "done")), f"{shown}: {said}"
    assert said == "done" or str(folder) in said, f"{shown}: {said}"
    assert len(said) < 2000, f"{shown}: {said}"
    return said


def test_the_files_are_read_as_they_are(tmp_path):
    assert use(written(tmp_path, json.dumps(HEAD), json.dumps(ABOUT))) == "done"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["results.csv", "run.json"]


@pytest.mark.parametrize("which", ["rows", "about"])
def test_a_hostile_value_is_read_or_refused(which, tmp_path):
    good = HEAD if which == "rows" else ABOUT
    found = set()
    for place in places(good):
        for value in VALUES:
            text = json.dumps(changed(good, place, value))
            files = (text, json.dumps(ABOUT)) if which == "rows" else (json.dumps(HEAD), text)
            shown = f"{place} = {value!r}"
            found.add(check(tmp_path, *files, shown).partition(":")[0])
    assert found == {"done", "refused"}


@pytest.mark.parametrize("text", TEXTS, ids=lambda text: text[:8])
def test_a_hostile_text_is_read_or_refused(text, tmp_path):
    assert check(tmp_path, text, json.dumps(ABOUT), text[:40]) != "done"
    check(tmp_path, json.dumps(HEAD), text, text[:40])
