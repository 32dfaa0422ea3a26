"""What a file reads from elsewhere is said; what stands beside it, and what evcosim brings, is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.system.outside import read_outside
from evcosim.cosim.system.scenario import Scenario, load_scenario
from evcosim.cosim.system.system import System, load_system
from evcosim.cosim.system.toml import DATA

SYSTEM = 'name = "x"\n[units.a]\nfmu = "a.fmu"\n[buses.can0]\ndbc = "{}"\n'
SCENARIO = '[[stimulus]]\nto = "a.u"\nconstant = 1\n[[stimulus]]\nto = "a.v"\ncsv = "{}"\n'


def files(folder: Path, dbc: str, csv: str) -> tuple[System, Scenario]:
    for name, text in (("s.toml", SYSTEM.format(dbc)), ("c.toml", SCENARIO.format(csv))):
        (folder / name).write_text(text)
    system = load_system(str(folder / "s.toml"))
    return system, load_scenario(system, str(folder / "c.toml"))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with data, beside another one."""
    for name in ("inner", "outer"):
        (tmp_path / name).mkdir()
        for data in ("a.fmu", "x.dbc", "x.csv"):
            (tmp_path / name / data).write_text("")
    return tmp_path / "inner"


def test_what_stands_beside_a_file_or_below_is_not_outside(folder: Path) -> None:
    (folder / "below").mkdir()
    (folder / "below" / "x.csv").write_text("")
    system, scenario = files(folder, "x.dbc", "below/x.csv")
    assert read_outside(system, scenario, {"a": folder / "a.fmu"}) == ()
    assert read_outside(*files(folder, "can/ev.dbc", "cycles/ece15.csv"), {}) == ()


def test_what_stands_elsewhere_is_said_with_its_key(folder: Path) -> None:
    outer = folder.parent / "outer"
    system, scenario = files(folder, "../outer/x.dbc", str(outer / "x.csv"))
    found = read_outside(system, scenario, {"a": outer / "a.fmu"})
    assert found == (
        f"{folder}/s.toml: units.a.fmu reads {outer}/a.fmu, which is not in the folder of {folder}/s.toml",
        f"{folder}/s.toml: buses.can0.dbc reads {folder}/../outer/x.dbc, which is not in the folder of "
        f"{folder}/s.toml",
        f"{folder}/c.toml: stimulus 2.csv reads {outer}/x.csv, which is not in the folder of {folder}/c.toml",
    )


def test_a_link_counts_as_what_it_leads_to(folder: Path) -> None:
    (folder / "x.csv").unlink()
    (folder / "x.csv").symlink_to(folder.parent / "outer" / "x.csv")
    (said,) = read_outside(*files(folder, "x.dbc", "x.csv"), {})
    assert said.startswith(f"{folder}/c.toml: stimulus 2.csv reads {folder}/x.csv")


def test_a_built_in_system_reads_nothing_from_elsewhere() -> None:
    system = load_system("scooter")
    assert system.path.is_relative_to(DATA)
    assert read_outside(system, load_scenario(system, "udds"), {}) == ()


def test_a_default_scenario_may_stand_elsewhere(folder: Path) -> None:
    other = folder.parent / "outer" / "c.toml"
    other.write_text("")
    (folder / "s.toml").write_text(f"scenario = '{other}'\n" + SYSTEM.format("x.dbc"))
    system = load_system(str(folder / "s.toml"))
    (said,) = read_outside(system, load_scenario(system), {})
    assert said == f"{folder}/s.toml: scenario reads {other}, which is not in the folder of {folder}/s.toml"
