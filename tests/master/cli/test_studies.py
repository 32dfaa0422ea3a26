"""The folder of a study: named as that of a run is, and never one with results of other settings."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from evcosim import ConfigError
from evcosim.cosim.results.folder_lock import FolderLock
from evcosim.master.cli import outputs
from evcosim.master.cli.studies import ended, study_folder, with_settings, written


def chosen(settings: dict[str, Any], wanted: Path | None = None) -> tuple[str, list[str]]:
    """Choose a folder as a study does, and leave its data there."""
    folder, remarks = study_folder(wanted, ("car", "hill", "budget"), "budget.json", settings)
    outputs.release()
    (folder / "budget.json").write_text(json.dumps([with_settings({"found": 1}, settings)]), encoding="utf-8")
    return str(folder), remarks


def test_only_a_study_of_the_same_settings_is_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    plain, ideal = {"options": {}}, {"options": {"ideal": True}}
    assert chosen(plain) == ("results/car-hill-budget", [])
    assert chosen(ideal)[0] == "results/car-hill-budget-ideal"
    assert chosen(plain) == ("results/car-hill-budget", [])
    assert chosen(ideal)[0] == "results/car-hill-budget-ideal"
    other = {"options": {}, "spec": {"sweep": (0.1, 1.0)}}
    assert chosen(other)[0] == "results/car-hill-budget-2"
    folder, remarks = chosen(other)
    assert folder == "results/car-hill-budget-2"
    assert remarks == [f"results/car-hill-budget has results of other settings; these are in {folder}"]
    assert chosen(ideal, Path("mine"))[0] == "mine"


@pytest.mark.parametrize("text", ["", "nothing", "[]", "3"])
def test_a_file_that_is_not_of_a_study_is_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("results/car-hill-budget").mkdir(parents=True)
    Path("results/car-hill-budget/budget.json").write_text(text, encoding="utf-8")
    assert chosen({"options": {}})[0] == "results/car-hill-budget"


def test_a_folder_that_another_command_has_is_refused_with_the_option_that_names_one(
    evcosim: Any, tmp_path: Path
) -> None:
    sweep = ("--sweep", "0.05,1", "--duration", "150", "--no-plot")
    with FolderLock(tmp_path / "mine"):
        answer = evcosim("identify", "scooter", *sweep, "--output-folder", str(tmp_path / "mine"))
        assert answer.code == 2
        assert answer.err.endswith(
            "is writing into it; wait for its end; --output-folder names another one\n"
        )
        with pytest.raises(ConfigError, match="; --output names another one"):
            chosen({"options": {}}, tmp_path / "mine")


def test_what_identify_switches_off_is_said(evcosim: Any) -> None:
    assert evcosim("new", "car").code == 0
    options = ("--input", "controller.speed_wanted", "--output", "vehicle.speed", "--at-input", "30")
    more = ("--amplitude", "3", "--sweep", "0.05,1", "--duration", "150", "--no-plot")
    answer = evcosim("identify", "car/car.toml", *options, *more)
    assert answer.code == 0, answer
    lines = answer.out.splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("switched off"))
    assert [line[15:] for line in lines[first : first + 3]] == [
        "held at 0 rad: the stimulus of vehicle.slope",
        "left out: the event 'bias' of controller.speed_measured at 45 s",
        "left out: the event 'reset' of controller.speed_measured at 50 s",
    ]
    assert "in results/car-hill-identify: identification.json" in answer.out
    (found,) = json.loads(Path("results/car-hill-identify/identification.json").read_text(encoding="utf-8"))
    assert len(found["switched_off"]) == 3


@pytest.mark.parametrize("count", [0, 2, 3])
def test_the_files_up_to_the_one_that_is_refused_are_named(
    count: int, capsys: pytest.CaptureFixture[str]
) -> None:
    def names() -> Iterator[str]:
        yield from ["a.md", "b.json", "c.png"][:count]
        if count < 3:
            raise ConfigError("c.png: cannot be written: full")

    files, unwritten = written(names())
    assert files == ["a.md", "b.json", "c.png"][:count]
    assert ended(Path("out"), files, unwritten, ["remark"]) == (1 if count < 3 else 0)
    said = ["evcosim: warning: remark"]
    if count < 3:
        said += ["evcosim: c.png: cannot be written: full", f"in out: {', '.join(files) or 'nothing'}"]
    assert capsys.readouterr().err.splitlines() == said
