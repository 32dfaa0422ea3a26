"""An FMU in this process: its life from loading to freeing, its single values, its log."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.fmi.instance import Instance
from evcosim.master.fmi.loading import load_unit
from evcosim.master.unit import UnitError
from support.c_fmu import mixed_fmu

VERSIONS = (1, 2, 3)


def unit_of(folder: Path, fmi: int, behavior: int = 0) -> Instance:
    fmu = read_fmu(mixed_fmu(folder / "mixed.fmu", fmi, behavior))
    unit = load_unit(fmu, "a", fmu.interface)
    assert isinstance(unit, Instance)
    return unit


def test_functions_that_nobody_calls_may_be_missing(tmp_path: Path) -> None:
    """sources/mixed.c has neither fmi2Reset nor fmi2GetFMUstate nor fmi3Reset: see every other test."""
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2))
    unit = load_unit(fmu, "a", fmu.interface)
    try:
        with pytest.raises(
            FmuError, match=r"mixed.fmu: binaries/linux64/mixed.so lacks the function fmi2Reset"
        ):
            unit.function("fmi2Reset")  # type: ignore[attr-defined] # of the class that FMUs have
    finally:
        unit.free()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_it_may_be_freed_at_any_time_and_twice(tmp_path: Path, fmi: int) -> None:
    for stage in range(4):
        unit = unit_of(tmp_path, fmi)
        folder = unit._folder
        if stage > 0:
            unit.enter_initialization(0.0, None)
        if stage > 1:
            unit.exit_initialization()
        if stage > 2:
            unit.terminate()
        unit.free()
        unit.free()
        assert folder is not None and not folder.exists()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_number_beyond_an_integer_is_refused_before_c_sees_it(tmp_path: Path, fmi: int) -> None:
    unit = unit_of(tmp_path, fmi)
    try:
        unit.enter_initialization(0.0, None)
        unit.exit_initialization()
        for number in (-(2**31), 2**31 - 1):
            unit.set("count_in", number)
            assert unit.get("count_in") == number
        for number in (-(2**31) - 1, 2**31):
            with pytest.raises(
                UnitError, match=rf"count_in cannot be set to {number}: .* from -2147483648 to 2147483647"
            ):
                unit.set("count_in", number)
            assert unit.get("count_in") == 2**31 - 1
    finally:
        unit.free()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_warning_is_counted_and_an_error_raised_with_the_variable(tmp_path: Path, fmi: int) -> None:
    warning = unit_of(tmp_path, fmi, 21)
    warning.set("u", 1.0)
    assert warning.warnings == 2  # the status, and the message of that status
    warning.free()
    failing = unit_of(tmp_path, fmi, 23)
    with pytest.raises(
        UnitError, match=r"unit 'a': fmi\d?Set\w+ of u returned Error \(3\)\n.*as it was told"
    ):
        failing.set("u", 1.0)
    failing.free()


def test_a_library_that_cannot_be_loaded_is_named_with_the_reason(tmp_path: Path) -> None:
    path, wrong = mixed_fmu(tmp_path / "mixed.fmu", 2), tmp_path / "wrong.fmu"
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(wrong, "w") as new:
        new.writestr("modelDescription.xml", old.read("modelDescription.xml"))
        new.writestr("binaries/linux64/mixed.so", b"MZ" + bytes(100))
    fmu = read_fmu(wrong)
    reason = "its library cannot be loaded: binaries/linux64/mixed.so: it is a library for Windows"
    with pytest.raises(FmuError, match=rf"wrong.fmu: {reason}"):
        load_unit(fmu, "a", fmu.interface)
