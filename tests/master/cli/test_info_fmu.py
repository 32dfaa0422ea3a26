"""`evcosim info FMU`: variables, other FMI versions, defects, sources."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from support.c_fmu import vehicle_fmu


def test_info_of_an_fmu(evcosim):
    answer = evcosim("info", "BoundController")
    assert answer.code == 0
    for text in ("FMI 2.0 Co-Simulation", "saves and restores its state", "speed_measured", "km/h"):
        assert text in answer.out
    data = evcosim("info", "BoundController", "--json").json
    by_name = {v["name"]: v for v in data["variables"]}
    assert by_name["throttle"]["max"] == "100.0"
    assert by_name["speed_measured"]["causality"] == "input"
    assert "2 velocity" in by_name["state"]["description"]


def test_info_selects_variables(evcosim):
    inputs = evcosim("info", "BoundController", "--causality", "input", "--json").json["variables"]
    assert {v["causality"] for v in inputs} == {"input"}
    found = evcosim("info", "BoundController", "--causality", "input", "--search", "SPEED", "--json").json
    speeds = ["speed_measured", "speed_bound", "front_wheel_speed", "rear_wheel_speed"]
    assert [v["name"] for v in found["variables"]] == speeds
    assert "1 of 29 variables" in evcosim("info", "BoundController", "--search", "speed_m").out
    assert "0 of 29 variables" in evcosim("info", "BoundController", "--search", "nothing like it").out


DESCRIPTIONS = {
    "1.0": """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="1.0" modelName="Old" modelIdentifier="old" guid="{1}"
 numberOfContinuousStates="0" numberOfEventIndicators="0">
<ModelVariables><ScalarVariable name="level" valueReference="1" causality="output">
<Real unit="m" start="1.5"/></ScalarVariable></ModelVariables>
<Implementation><CoSimulation_StandAlone><Capabilities/></CoSimulation_StandAlone></Implementation>
</fmiModelDescription>""",
    "3.0": """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="3.0" modelName="New" instantiationToken="{1}">
<CoSimulation modelIdentifier="new" canGetAndSetFMUState="true" hasEventMode="true"/>
<ModelVariables><Float64 name="level" valueReference="1" causality="output" unit="m" start="1.5 2.5">
<Dimension start="2"/></Float64><Clock name="beat" valueReference="2" causality="input"
 intervalVariability="triggered"/></ModelVariables>
<ModelStructure><Output valueReference="1"/></ModelStructure>
</fmiModelDescription>""",
}


@pytest.mark.parametrize("version", DESCRIPTIONS)
def test_info_of_other_fmi_versions(evcosim, tmp_path, version):
    path = tmp_path / "other.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTIONS[version])
    answer = evcosim("info", path)
    assert answer.code == 0, answer
    for text in (f"FMI {version} Co-Simulation", "level", "output"):
        assert text in answer.out
    refused = evcosim("run", "scooter", "--fmu", f"battery={path}")
    assert refused.code == 2
    assert f"{path}: has no binary for this machine: binaries/" in refused.err


def test_info_tells_what_was_mended_and_what_the_validator_says(evcosim, tmp_path: Path) -> None:
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2, **{'unit="kg" start="200"': 'unit="kg" start="heavy"'})
    shown = " ".join(evcosim("info", "Vehicle.fmu").out.split())
    assert "mended m_total: start = 'heavy' is no Real; it is ignored" in shown
    assert "validator line " in shown
    about = evcosim("info", "Vehicle.fmu", "--json").json
    assert about["defects"] == ["m_total: start = 'heavy' is no Real; it is ignored"]
    assert any("heavy" in message for message in about["validator"])
    assert about["unpacked_size"] > 1000
    assert (about["sources"], about["binary_for_this_machine"]) == ([], True)


def test_info_bounds_what_it_prints_of_many_defects(evcosim, tmp_path: Path) -> None:
    start = "no number" + 99 * " of them"
    declared = "".join(
        f'<ScalarVariable name="x{i}" valueReference="{40 + i}"><Real start="{start}"/></ScalarVariable>'
        for i in range(30)
    )
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2, **{"</ModelVariables>": f"{declared}</ModelVariables>"})
    shown = evcosim("info", "Vehicle.fmu", "--search", "pedal").out
    assert "and 25 more (--json shows all)" in shown
    assert len(shown.splitlines()) < 60
    assert len(evcosim("info", "Vehicle.fmu", "--json").json["defects"]) == 30


def test_info_of_sources_without_a_binary(evcosim, tmp_path: Path) -> None:
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    with zipfile.ZipFile(fmu) as full, zipfile.ZipFile(tmp_path / "Sources.fmu", "w") as bare:
        bare.writestr("modelDescription.xml", full.read("modelDescription.xml"))
        bare.writestr("sources/vehicle.c", "int x;")
    shown = " ".join(evcosim("info", "Sources.fmu").out.split())
    assert "sources vehicle.c; there is no binary for this machine" in shown
    assert "'evcosim compile Sources.fmu' makes one" in shown
