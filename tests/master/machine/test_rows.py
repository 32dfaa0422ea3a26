"""Rows of tables: numbers by their type, and the units that machine code calls by itself."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest

from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.fmi.loading import load_unit
from evcosim.master.machine import tables as L
from evcosim.master.machine.rows import collect_warnings, direct, fill, table
from evcosim.master.machine.surroundings import address
from support.c_fmu import mixed_fmu
from support.mocks import clock


def test_floats_stand_as_float64_and_other_numbers_as_int64() -> None:
    made = table([{0: 1, 2: 1.0}, {1: -2.5}], 3)
    assert made[0].tolist() == [1, 0, np.array([1.0]).view(np.int64)[0]]
    assert made.view(np.float64)[1].tolist() == [0.0, -2.5, 0.0]
    fill(made, 1, {1: 7})
    assert made[1].tolist() == [0, 7, 0]


def test_a_table_without_rows_has_an_address() -> None:
    assert table([], 4).shape == (1, 4)


def test_the_address_of_a_function_is_the_one_that_is_called() -> None:
    function = ctypes.CFUNCTYPE(ctypes.c_int)(lambda: 42)
    assert ctypes.CFUNCTYPE(ctypes.c_int)(address(function))() == 42


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_units_of_co_simulation_are_called_directly_and_no_others(tmp_path: Path, fmi: int) -> None:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", fmi))
    unit = load_unit(fmu, "a", fmu.interface)
    try:
        assert direct(unit) is unit
    finally:
        unit.free()
    assert direct(clock()) is None


def test_warnings_are_added_to_the_units_of_their_rows(tmp_path: Path) -> None:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2))
    unit = load_unit(fmu, "a", fmu.interface)
    try:
        calls = table([{}, {}], L.CALL_WIDTH)
        calls[:, L.WARNINGS] = 2, 3
        collect_warnings(calls, [unit, unit])
        assert unit.log.warnings == 5
        assert not calls.any()
    finally:
        unit.free()
