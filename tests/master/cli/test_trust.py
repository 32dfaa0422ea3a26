"""`--trust`: every verb that runs a stranger's file asks for it alike, and those that show say so."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.c_fmu import vehicle_fmu
from support.pairs import pair

REFUSED = 'isolation = "none": '


@pytest.fixture
def stranger(tmp_path: Path) -> Path:
    """A system file that puts a foreign FMU into the process of evcosim."""
    path = pair(tmp_path, 0)
    path.write_text(path.read_text().replace("[units.a]", '[units.a]\nisolation = "none"'))
    return path


@pytest.fixture
def swap(tmp_path: Path) -> Path:
    """A swap file that does so in the place of the scooter."""
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    (tmp_path / "swap.toml").write_text(
        'fmu = "Vehicle.fmu"\nisolation = "none"\n[map.inputs]\nthrottle = "pedal"\nbrake_force = "F_brake"\n'
        '[map.outputs]\nspeed = "v"\n'
    )
    return tmp_path / "swap.toml"


def test_run(evcosim, stranger: Path) -> None:
    command = ["run", stranger, "--no-plot", "-o", "out"]
    refused = evcosim(*command)
    assert refused.code == 2
    assert f"{stranger}: units.a.{REFUSED}" in refused.err
    assert "--trust" in refused.err
    for word in (["--trust"], ["--isolation", "none"], ["--isolation", "process"]):
        assert evcosim(*command, *word, "--replace").code == 0


IDENTIFY = "identify --input a.u --output a.y --at-input 1 --amplitude 0.1 --sweep 1,10 --duration 3"


@pytest.mark.parametrize("verb", ["budget", IDENTIFY])
def test_studies(evcosim, stranger: Path, verb: str) -> None:
    name, *options = verb.split()
    command = [name, stranger, *options]
    refused = evcosim(*command)
    assert refused.code == 2
    assert f"units.a.{REFUSED}" in refused.err
    # it goes on to what else such a system lacks
    assert REFUSED not in evcosim(*command, "--trust").err


def test_info_shows_what_would_be_asked_for(evcosim, stranger: Path, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")  # so that no cell is wrapped
    assert "evcosim's (with --trust)" in evcosim("info", stranger).out
    units = {unit["name"]: unit for unit in evcosim("info", stranger, "--json").json["units"]}
    assert {name: unit["needs_trust"] for name, unit in units.items()} == {"rider": False, "a": True}


def test_check_tries_it_apart_and_says_what_the_run_needs(evcosim, swap: Path, tmp_path: Path) -> None:
    command = ["check", swap, "--as", "scooter.vehicle", "--write", tmp_path / "again.toml"]
    said = evcosim(*command, "--try", "0.1s").out
    assert "evcosim run scooter --swap vehicle=" in said
    assert " --trust" in said
    swap.write_text(swap.read_text().replace('isolation = "none"\n', ""))
    assert " --trust" not in evcosim(*command).out


def test_check_in_a_strangers_system_runs_nothing_of_it_here(evcosim, stranger: Path) -> None:
    found = evcosim("check", stranger.parent / "mixed.fmu", "--as", f"{stranger}.a", "--try", "0.1s")
    assert REFUSED not in found.err + found.out
    assert found.code in (0, 1)
