"""Paths that no file can have, and empty texts, are refused with option, path, rule and value."""

from __future__ import annotations

import shutil

import pytest

from evcosim.cosim.results.results import Results
from evcosim.cosim.results.variable import ResultVariable
from evcosim.master.builtin import fmu_file
from evcosim.master.cli.typed_paths import check_given
from evcosim.master.simulation import Simulation

LONG, DEEP = "a" * 300, "/".join(["b" * 100] * 50)
VERBS = {
    "--output": ["run scooter --no-plot -o", "build Battery -o", "plot r -o", "schema -o", "reproduce -o",
                 "budget scooter -o", "compile v.fmu -o"],
    "--output-folder": ["identify scooter -o"],
    "--write": ["check v.fmu --as scooter.battery --write"],
    "--plot": ["compare r r --plot"],
    "--diagram": ["info scooter --diagram"],
}  # fmt: skip # the verbs of an option
WRITING = [(option, verb) for option, verbs in VERBS.items() for verb in verbs]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The working folder, with an FMU and results."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(fmu_file("Battery"), "v.fmu")
    Results([0.0, 1.0], [[1.0], [2.0]], [ResultVariable("a.x")]).write("r")
    (tmp_path / "file").write_text("")
    return tmp_path


@pytest.mark.parametrize(("option", "verb"), WRITING)
def test_a_name_that_is_too_long_is_refused_before_anything(evcosim, folder, option, verb):
    before = sorted(folder.iterdir())
    for path, said in (
        (LONG, "the name 'aaaaaaaaaaaaaaaa...' in it has 300 bytes; 255 are possible"),
        (f"x/{LONG}/y.png", "has 300 bytes; 255 are possible"),
        (DEEP, "it has 5049 bytes; a path of 4095 is possible"),
    ):
        answer = evcosim(*verb.split(), path)
        assert (answer.code, answer.out) == (2, "")
        assert answer.err.startswith(f"evcosim: {option} ")
        assert said in answer.err and len(answer.err) < 400
    answer = evcosim(*verb.split(), "")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == f"evcosim: {verb.split()[-1]} '': the text is empty, where a value is needed\n"
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize(
    "typed",
    [
        ["run", "scooter", "--stop-time", "1.1", "--no-plot", "-o", "file/x"],
        ["build", "Battery", "-o", "file/x"],
        ["plot", "r", "-o", "file/x.png"],
        ["schema", "-o", "file/x"],
        ["check", "v.fmu", "--as", "scooter.battery", "--write", "file/x"],
        ["compare", "r", "r", "--plot", "file/x.png"],
    ],
)
def test_a_file_among_the_folders_is_named(evcosim, folder, typed):
    answer = evcosim(*typed)
    assert answer.code == 2
    assert "file is a file, not a folder" in answer.err


def test_check_tries_its_file_before_the_report(evcosim, folder):
    for path in ("file/x", ".", "r"):
        answer = evcosim("check", "v.fmu", "--as", "scooter.battery", "--write", path)
        assert (answer.code, answer.out) == (2, "")
        assert "cannot be written" in answer.err


@pytest.mark.parametrize(
    ("typed", "place"),
    [
        (["compare", LONG, "r"], "A 'aaa"),
        (["plot", DEEP], "RESULT 'bbb"),
        (["compile", LONG], "FILE 'aaa"),
        (["results", "recover", LONG], "DIR 'aaa"),
        (["info", LONG], "'aaa"),
        (["info", f"{LONG}.fmu"], "'aaa"),
    ],
)
def test_so_is_one_that_would_be_read(evcosim, folder, typed, place):
    answer = evcosim(*typed)
    assert answer.code == 2
    assert answer.err.startswith(f"evcosim: {place}")
    assert "are possible" in answer.err or "is possible" in answer.err


def test_nothing_is_taken_for_something(evcosim, folder):
    for typed, place in (
        (["compare", "", "r"], "''"),
        (["run", "scooter", "-s", ""], "-s ''"),
        (["run", "scooter", "--output="], "--output ''"),
        (["results", "recover", ""], "''"),
    ):
        answer = evcosim(*typed)
        assert (answer.code, answer.out) == (2, "")
        assert answer.err.startswith(f"evcosim: {place}: the text is empty")
    check_given(["run", "a", "--set", "b.c=", "--set=b.c=1"])  # what is empty in it, others say


@pytest.mark.parametrize("name", ["a\0b", LONG, DEEP])
def test_in_python_too(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    results = Results([0.0, 1.0], [[1.0], [2.0]], [ResultVariable("a.x")])
    refusals = [
        lambda: results.write(name),
        lambda: results.save(f"{name}.csv"),
        lambda: results.plot(f"{name}.png"),
        lambda: Results.read(name),
        lambda: Results.read(f"{name}.csv"),
    ]
    with Simulation("scooter") as simulation:
        refusals.append(lambda: simulation.keep_in(name))
        for refusal in refusals:
            with pytest.raises(ValueError, match=r"possible|NUL") as error:
                refusal()
            assert type(error.value).__name__ == "ConfigError"
    assert list(tmp_path.iterdir()) == []
