"""The files of FMUs by name: built-in, beside the system file, from the working folder."""

from __future__ import annotations

import shutil

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master import builtin
from evcosim.master.builtin import build_fmu, builtin_names, builtin_text, cache_folder, fmu_file, is_builtin


def test_every_built_in_fmu_has_a_line():
    assert "Scooter" in builtin_names()
    assert all(builtin_text(name).strip() and "\n" not in builtin_text(name) for name in builtin_names())


def test_a_built_in_name_is_a_file_of_the_cache():
    path = fmu_file("Battery")
    assert path.is_file()
    assert path.parent == cache_folder()


def test_a_path_is_looked_up_beside_the_system_first(tmp_path, monkeypatch):
    (tmp_path / "beside").mkdir()
    monkeypatch.chdir(tmp_path)
    system = tmp_path / "beside" / "system.toml"
    (tmp_path / "own.fmu").write_text("")
    assert fmu_file("own.fmu", system).resolve() == tmp_path / "own.fmu"
    (tmp_path / "beside" / "own.fmu").write_text("")
    assert fmu_file("own.fmu", system).resolve() == tmp_path / "beside" / "own.fmu"
    assert fmu_file("own.fmu").resolve() == tmp_path / "own.fmu"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "Batery",
            r"^mine\.toml: units\.b\.fmu: there is no built-in FMU 'Batery' \(did you mean 'Battery'\?\)",
        ),
        ("none.fmu", r"^mine\.toml: units\.b\.fmu: none\.fmu: there is no such FMU file"),
        ("folder/Battery", r"^mine\.toml: units\.b\.fmu: folder/Battery: there is no such FMU file"),
    ],
)
def test_a_name_of_nothing(tmp_path, name, text):
    with pytest.raises(ConfigError, match=text):
        fmu_file(name, tmp_path / "mine.toml", "mine.toml: units.b.fmu")


def test_a_copy_passes_for_the_built_in_one_and_no_other_file_does(tmp_path):
    copy = shutil.copy(fmu_file("Battery"), tmp_path / "copy.fmu")
    assert is_builtin("Battery", copy)
    assert not is_builtin("Scooter", copy)
    assert not is_builtin("Mine", copy)
    copy.write_bytes(copy.read_bytes() + b"\0")
    assert not is_builtin("Battery", copy)


def test_building_into_a_folder_that_cannot_be_written(tmp_path):
    assert build_fmu("Battery", tmp_path / "made").path == tmp_path / "made" / "Battery.fmu"
    (tmp_path / "file").write_text("")
    with pytest.raises(
        ConfigError, match=r"file.below: Battery\.fmu cannot be written: .*file is a file, not"
    ):
        build_fmu("Battery", tmp_path / "file" / "below")


def test_a_cache_that_does_not_last(tmp_path, monkeypatch):
    monkeypatch.setattr(builtin, "cache_folder", lambda: tmp_path)
    with pytest.raises(
        ConfigError, match=r"Battery\.fmu cannot be kept there; --output DIR builds elsewhere"
    ):
        build_fmu("Battery")


def test_a_swap_file_is_no_fmu(tmp_path):
    (tmp_path / "swap.toml").write_text('fmu = "V.fmu"\n')
    with pytest.raises(ConfigError, match=r"^fmus\.vehicle: .*swap\.toml: is a swap file: .*--swap"):
        fmu_file(str(tmp_path / "swap.toml"), place="fmus.vehicle")
