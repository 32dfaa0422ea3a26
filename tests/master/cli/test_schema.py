"""`evcosim schema`: what it prints and writes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from evcosim.cosim.system.schema import json_schema
from evcosim.cosim.system.system import SystemFile
from evcosim.master.cli.schema import Kind


def test_the_system_is_the_default(evcosim) -> None:
    answer = evcosim("schema")
    assert (answer.code, answer.err) == (0, "")
    assert answer.json == json_schema(SystemFile, "evcosim system file")
    assert answer.out == evcosim("schema", "system").out


@pytest.mark.parametrize("kind", Kind)
def test_each_kind_is_printed_and_written_alike(evcosim, tmp_path: Path, kind: str) -> None:
    printed = evcosim("schema", kind)
    assert printed.json["title"] == f"evcosim {kind} file"
    into_folder = evcosim("schema", kind, "--output", tmp_path)
    path = tmp_path / f"{kind}.schema.json"
    assert (into_folder.code, into_folder.out) == (0, f"{path}\n")
    assert path.read_text(encoding="utf-8") == printed.out
    named = tmp_path / "new" / "mine.json"
    assert evcosim("schema", kind, "-o", named).out == f"{named}\n"
    assert named.read_bytes() == path.read_bytes()


def test_a_wrong_kind_says_what_there_is(evcosim) -> None:
    answer = evcosim("schema", "systems")
    assert answer.code == 2
    assert "'systems' is not one of 'system', 'scenario', 'swap'" in answer.err


def test_where_it_cannot_be_written(evcosim, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "file" / "x.json", tmp_path / "file" / "new" / "x.json"):
        answer = evcosim("schema", "-o", path)
        assert answer.code == 2
        assert f"{path}: cannot be written: {tmp_path / 'file'} is a file, not a folder" in answer.err


def test_it_is_read_by_whatever_reads_json(process) -> None:
    out, err = process("schema", "scenario").communicate()
    assert err == ""
    assert set(json.loads(out)["properties"]) >= {"stimulus", "event", "experiment"}
