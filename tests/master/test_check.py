"""`evcosim check` and `--swap`: from a stranger's FMU to a run in the place of our vehicle."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from evcosim.cosim.fit import Row, fit, fits
from evcosim.cosim.requirements import requirements
from evcosim.cosim.scenario import load_scenario, scenario_names
from evcosim.cosim.system import load_system, system_names
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import read_fmu
from support.c_fmu import mixed_fmu, vehicle_fmu

PLACES = [(s, unit) for s in system_names() for unit in load_system(s).file.units]


def rows_of(system: str, unit: str, scenario: str | None = None) -> list[Row]:
    """The rows for a unit's own FMU in its own place."""
    described = load_system(system)
    interface = read_fmu(fmu_file(described.file.units[unit].fmu)).interface
    return fit(requirements(described, load_scenario(described, scenario), unit, interface), interface)


@pytest.mark.parametrize(("system", "unit"), PLACES)
def test_every_unit_fits_in_its_own_place(system: str, unit: str) -> None:
    for scenario in scenario_names(load_system(system)):
        rows = rows_of(system, unit, scenario)
        assert fits(rows), rows
        assert all(row.variable == row.need and row.verdict == "fits" for row in rows if row.need)


def test_what_a_system_needs_is_named_with_its_other_end() -> None:
    system = load_system("scooter")
    interface = read_fmu(fmu_file("Scooter")).interface
    needs = {n.name: n for n in requirements(system, load_scenario(system, "udds"), "vehicle", interface)}
    assert needs["throttle"].role == "input"
    assert needs["throttle"].why == ("from ecu.throttle over can0.VCU_Request.VCU_ThrottleRequest",)
    assert needs["power"].why == ("to battery.power", "figure or metrics")
    assert "figure or metrics" in needs["speed"].why


def check(evcosim, *arguments: object):
    return evcosim("check", *arguments)


def test_from_a_stranger_to_a_run(evcosim, tmp_path: Path) -> None:
    fmu, swap = vehicle_fmu(tmp_path / "Vehicle.fmu", 2), tmp_path / "swap.toml"
    found = check(evcosim, fmu, "--as", "scooter.vehicle", "--write", swap)
    assert found.code == 1
    assert "declares no unit of measure" in " ".join(found.out.split())
    assert f"evcosim run scooter --swap vehicle={swap}" in found.out
    again = check(evcosim, swap, "--as", "scooter.vehicle")
    assert (again.code, "it fits: evcosim run scooter" in again.out) == (0, True), again
    options = ("--stop-time", "3", "-o", tmp_path / "out", "--no-plot")
    ran = evcosim("run", "scooter", "--swap", f"vehicle={swap}", *options)
    assert ran.code == 0, ran
    manifest = json.loads((tmp_path / "out" / "run.json").read_text())
    assert manifest["units"]["vehicle"]["map"]["outputs"]["speed"] == {"variable": "v", "unit": "m/s"}


def test_the_report_as_data(evcosim, tmp_path: Path) -> None:
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 3)
    found = json.loads(check(evcosim, fmu, "--as", "scooter.vehicle", "--json").out)
    assert found["fits"] is False
    rows = {row["need"]: row for row in found["rows"]}
    assert rows["throttle"]["variable"] == "pedal"
    assert rows["throttle"]["reason"] == "1 [1] is 100 [%]"
    assert rows["distance"]["reason"].endswith("a local variable, read as an output")
    assert rows[""]["variable"] == "slope"


def test_an_fmu_that_has_nothing_of_it(evcosim, tmp_path: Path) -> None:
    found = check(evcosim, mixed_fmu(tmp_path / "mixed.fmu", 2), "--as", "scooter.vehicle")
    assert found.code == 1
    assert "missing" in found.out or "your choice" in found.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("Scooter", "--as", "vehicle"), "--as vehicle: it is written SYSTEM.UNIT, as in scooter.vehicle"),
        (("Scooter", "--as", "scooter.vehicel"), "there is no unit 'vehicel' (did you mean 'vehicle'?)"),
        (("Scooter", "--as", "scoter.vehicle"), "did you mean 'scooter'"),
        (("none.fmu", "--as", "scooter.vehicle"), "none.fmu: there is no such FMU file"),
    ],
)
def test_wrong_use(evcosim, arguments: tuple[str, ...], message: str) -> None:
    found = check(evcosim, *arguments)
    assert found.code == 2
    assert message in found.err


def test_a_swap_of_no_unit(evcosim, tmp_path: Path) -> None:
    found = evcosim("run", "scooter", "--swap", f"vehicel={tmp_path}/swap.toml")
    assert found.code == 2
    assert "there is no unit 'vehicel' in system 'scooter' (did you mean 'vehicle'?)" in found.err
