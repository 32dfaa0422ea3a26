"""Messages of all verbs: in the user's words, without files of the cache, drafts and internal names."""

from __future__ import annotations

import re

import pytest

from evcosim.master import new_system
from evcosim.master.builtin import by_names, cache_folder

_INTERNAL = re.compile(r"\bcosim\.[a-z_]+\.|\bmaster\.[a-z_]+\.|\.evcosim-\w+\.part|/\.\w+-\w{8}/")

WRONG = [
    ("run", "Scooter", "--set", "mas=3"),
    ("run", "Scooter", "--start", "x=1"),
    ("run", "Scooter", "--input", "trottle=3"),
    ("run", "Scooter", "--input", "speed=3"),
    ("run", "Scooter", "--step-size", "1e-9"),
    ("run", "Scooter", "--step-size", "0.07"),
    ("run", "scooter", "--fmu", "vehicle=Battery"),
    ("run", "scooter", "--fmu", "vehicle=Scoter"),
    ("run", "scooter", "--step-size", "1e-9"),
    ("run", "Scoter"),
    ("info", "Scoter"),
    ("info", "Scooter", "--diagram", "x.png"),
    ("check", "Scoter", "--as", "scooter.vehicle"),
    ("check", "Scooter", "--as", "scooter.vehicl"),
    ("identify", "scooter", "--step-size", "1e-9"),
    ("budget", "scooter", "--step-size", "1e-9"),
    ("bus", "scooter", "--step-size", "1e-9"),
    ("plot", "Scooter"),
    ("compare", "Scooter", "Scooter"),
    ("results", "recover", "Scooter"),
    ("build", "Scoter"),
    ("compile", "Scooter"),
    ("reproduce", "scoter"),
    ("new", "scooter"),
    ("new", "mine", "--from", "scoter"),
]


@pytest.mark.parametrize("arguments", WRONG, ids=" ".join)
def test_no_message_names_a_file_of_the_cache_or_a_module(arguments, evcosim, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answer = evcosim(*arguments)
    said = answer.out + answer.err
    assert answer.code in (1, 2) and said.strip()
    assert str(cache_folder()) not in said and not _INTERNAL.search(said)
    if any(part.lower() == "scoter" or part.endswith("=Scoter") for part in arguments):
        assert "did you mean 'Scooter'" in said or "did you mean 'scooter'" in said


@pytest.mark.parametrize("target", ["scooter", "Scooter"])
def test_a_step_that_is_too_short_is_the_option_s(target, evcosim):
    answer = evcosim("run", target, "--step-size", "1e-9")
    assert answer.code == 2 and answer.err.startswith("evcosim: --step-size = 1e-09 s")
    assert "values that a run keeps" in answer.err


@pytest.mark.parametrize("kind", ["", "_native"])
def test_the_file_of_a_built_in_fmu_is_its_name_in_messages(kind):
    path = cache_folder() / f"Scooter{kind}_7e5cb0285b2a.fmu"
    assert by_names(f"{path}: no; {path} and /own/Scooter_7e5cb0285b2a.fmu") == (
        "Scooter: no; Scooter and /own/Scooter_7e5cb0285b2a.fmu"
    )


def test_a_full_disk_under_a_new_system_names_its_folder(evcosim, tmp_path, monkeypatch):
    def full(path, text):
        raise new_system.ConfigError(f"{path}: cannot be written: the disk is full")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(new_system, "write_text", full)
    answer = evcosim("new", "mine")
    assert answer.code == 2 and "mine/" in answer.err and "the disk is full" in answer.err
    assert not _INTERNAL.search(answer.err) and not any(tmp_path.iterdir())


def test_the_page_of_no_paper_shows_a_module(evcosim):
    from evcosim.master.reproduce import printed

    assert not [str(row) for row in printed.rows() if _INTERNAL.search(f"{row.where} {row.reason}")]
