"""Names that no file can have, and those that just fit, judged as the system judges them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.file_names import check_name, flaw_of_name, near_file, short_path

LONG = "a" * 256
DEEP = "/".join(["b" * 100] * 41)


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("", "it is empty, where a file or a folder is named"),
        ("a\0b", "it has a NUL, which the name of no file has"),
        (LONG, "the name 'aaaaaaaaaaaaaaaa...' in it has 256 bytes; 255 are possible"),
        (f"x/{LONG}/y", "the name 'aaaaaaaaaaaaaaaa...' in it has 256 bytes; 255 are possible"),
        ("\N{EURO SIGN}" * 86, "has 258 bytes; 255 are possible"),
        (DEEP, "it has 4140 bytes; a path of 4095 is possible"),
    ],
)
def test_a_name_that_no_file_has_is_told_with_rule_and_value(path, said):
    assert said in flaw_of_name(path)
    with pytest.raises(ConfigError) as refusal:
        check_name(path, "--output: ")
    assert str(refusal.value).endswith(said)
    assert len(str(refusal.value)) < 400


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the limits are those of Linux")
def test_the_system_agrees(tmp_path):
    for name in ("a" * 255, "\N{EURO SIGN}" * 85, ".", "a b", "\udcff"):
        assert flaw_of_name(tmp_path / name) == ""
        (tmp_path / name).exists()
    with pytest.raises(OSError, match="too long"):
        (tmp_path / LONG).exists()
    with pytest.raises(OSError, match="too long"):
        (tmp_path / DEEP).exists()


def test_a_long_path_is_cut_in_a_message():
    assert short_path(Path("a/b")) == "a/b"
    assert len(short_path(DEEP)) <= 80


def test_the_nearest_file_of_the_folder_is_named(tmp_path, monkeypatch):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "pack.fmu").touch()
    (tmp_path / "ideal").mkdir()
    monkeypatch.chdir(tmp_path)
    assert near_file("idael") == " (did you mean 'ideal'?)"
    assert near_file(Path("parts/pak.fmu")) == " (did you mean 'parts/pack.fmu'?)"
    assert near_file(tmp_path / "idael") == f" (did you mean '{tmp_path / 'ideal'}'?)"
    assert near_file("something else") == near_file("nowhere/pack.fmu") == ""
