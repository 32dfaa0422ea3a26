"""All units of an FMU in this process have one folder, which goes with the last of them."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import pytest

from evcosim.master.builtin import cache_folder, fmu_file
from evcosim.master.fmi import folders
from evcosim.master.fmi.fmu import Fmu, FmuError, read_fmu
from support.c_fmu import mixed_fmu
from support.needs import need_c_compiler


@pytest.fixture
def fmu(tmp_path: Path) -> Fmu:
    return read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2))


def test_units_of_an_fmu_share_its_folder_to_the_last(fmu: Fmu, tmp_path: Path) -> None:
    copy = tmp_path / "copy.fmu"
    copy.write_bytes(fmu.path.read_bytes())
    first = folders.take(fmu, "a")
    assert (first / fmu.binary).is_file()
    assert folders.take(fmu, "b") == folders.take(read_fmu(copy), "c") == first
    for unit in ("a", "c"):
        folders.give_back(fmu, unit)
        assert first.is_dir()
    folders.give_back(fmu, "b")
    assert not first.exists()
    again = folders.take(fmu, "a")
    assert again != first
    folders.give_back(fmu, "a")


def test_fmus_of_other_content_have_other_folders(fmu: Fmu, tmp_path: Path) -> None:
    other = read_fmu(mixed_fmu(tmp_path / "other.fmu", 2, 1))
    assert folders.take(fmu, "a") != folders.take(other, "a")
    for each in (fmu, other):
        folders.give_back(each, "a")


def test_an_fmu_that_is_there_once_in_a_process_has_one_unit(fmu: Fmu) -> None:
    kind = SimpleNamespace(canBeInstantiatedOnlyOncePerProcess="true")
    once = dataclasses.replace(fmu, description=SimpleNamespace(coSimulation=kind, modelExchange=None))
    folders.take(once, "a")
    with pytest.raises(FmuError, match=r"and unit 'a' is it already: unit 'b' needs isolation = \"process\""):
        folders.take(once, "b")
    folders.give_back(once, "a")
    folders.take(once, "b")
    folders.give_back(once, "b")


@pytest.mark.parametrize("units", ["python", "native"])
def test_a_built_in_fmu_has_a_folder_that_stays(tmp_path: Path, units: str) -> None:
    if units == "native":
        need_c_compiler()
    fmu = read_fmu(fmu_file("Battery", units=units))
    first = folders.take(fmu, "a")
    folders.give_back(fmu, "a")
    assert first.is_dir() and first.is_relative_to(cache_folder())
    assert folders.take(fmu, "b") == first
    folders.give_back(fmu, "b")
    copy = tmp_path / "copy.fmu"
    copy.write_bytes(fmu.path.read_bytes())
    own = folders.take(read_fmu(copy), "a")
    folders.give_back(fmu, "a")
    assert own != first and not own.exists()
