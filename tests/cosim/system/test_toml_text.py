"""TOML texts of strangers: read, or refused at once."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from evcosim.cosim.system.kinds import is_system, other_file
from evcosim.cosim.system.toml_text import parsed

HOSTILE = {
    "a key of many parts": "a" + ".a" * 100_000 + " = 1",
    "deep lists": "a = " + "[" * 100_000,
    "many digits": "a = " + "9" * 5000,
}


def test_a_text_is_its_tables() -> None:
    assert parsed("a = 1\n[b.c]\nd = [2]\n") == {"a": 1, "b": {"c": {"d": [2]}}}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_text_is_no_toml(name: str, tmp_path: Path) -> None:
    with pytest.raises(tomllib.TOMLDecodeError):
        parsed(HOSTILE[name])
    path = tmp_path / "a.toml"
    path.write_text(HOSTILE[name], encoding="utf-8")
    assert (is_system(path), other_file(path)) == (False, "")  # so for who looks what kind of file it is


def test_a_file_without_an_end_is_not_read_to_tell_its_kind(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    with path.open("wb") as file:
        file.truncate(70 << 30)
    assert (is_system(path), other_file(path)) == (False, "")
