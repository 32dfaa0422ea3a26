"""`evcosim check` and `--swap`: from a stranger's FMU to a run in the place of our vehicle."""

from __future__ import annotations

import json
import re
import shlex
import zipfile
from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.swap.matching import LIKENESS
from evcosim.cosim.swap.swap_file import SwapFile
from evcosim.cosim.system.system import load_system
from evcosim.cosim.system.toml import read_toml
from evcosim.master.simulation import simulate
from support.c_fmu import mixed_fmu, vehicle_fmu

pytestmark = pytest.mark.usefixtures("warm_units")


def check(evcosim, *arguments: object):
    return evcosim("check", *arguments)


def test_from_a_stranger_to_a_run(evcosim, tmp_path: Path) -> None:
    fmu, swap = vehicle_fmu(tmp_path / "Vehicle.fmu", 2), tmp_path / "swap.toml"
    found = check(evcosim, fmu, "--as", "scooter.vehicle", "--write", swap)
    assert found.code == 1
    assert "declares no unit of measure" in " ".join(found.out.split())
    *_, written, first, then, run = found.out.splitlines()
    assert written == f"1 row to decide; written: {swap}"
    assert first == f"first  look in {swap} whether the choice is right: speed"
    assert then == f"then   evcosim check {swap} --as scooter.vehicle"
    assert run.strip() == f"evcosim run scooter --swap vehicle={swap}"
    again = check(evcosim, swap, "--as", "scooter.vehicle")
    assert (again.code, "it fits: evcosim run scooter" in again.out) == (0, True), again
    options = ("--stop-time", "3", "-o", tmp_path / "out", "--no-plot")
    ran = evcosim("run", "scooter", "--swap", f"vehicle={swap}", *options)
    assert ran.code == 0, ran
    manifest = json.loads((tmp_path / "out" / "run.json").read_text())
    assert manifest["units"]["vehicle"]["map"]["outputs"]["speed"] == {"variable": "v", "unit": "m/s"}


def test_a_trial_proposes_what_makes_the_next_one_pass(evcosim, tmp_path: Path) -> None:
    """The brake of this vehicle is a negative force: the trial sees it and proposes the sign."""
    fmu, swap = vehicle_fmu(tmp_path / "Vehicle.fmu", 2), tmp_path / "swap.toml"
    first = check(evcosim, fmu, "--as", "scooter.vehicle", "--try", "1s", "--write", swap)
    assert first.code == 1
    assert "reacts to the other sign only" in " ".join(first.out.split())
    assert "1 row to decide and 4 problems" in first.out
    *_, solve, then, _ = first.out.splitlines()
    assert "solve what the trial found" in solve and "brake_force -> speed" in solve
    assert then == f"then   evcosim check {swap} --as scooter.vehicle --try 1s"
    written = swap.read_text()
    assert 'brake_force = { variable = "F_brake", invert = true }  # [N]; proposed:' in written
    assert "# problem: brake_force -> speed: reacts to the other sign only" in written
    written = swap.read_text().replace(", invert = true", "")
    swap.write_text(written)
    wrong = check(evcosim, swap, "--as", "scooter.vehicle", "--try", "1s")
    said = wrong.out.splitlines()[-1]
    assert said.startswith("4 problems: evcosim check ") and said.endswith("writes what the trial proposes")
    words = shlex.split(
        said.removeprefix("4 problems: evcosim ").removesuffix(" writes what the trial proposes")
    )
    assert evcosim(*words).code == 1  # of what was wrong; now it is written
    again = check(evcosim, swap, "--as", "scooter.vehicle", "--try", "1s", "--json")
    assert again.code == 0, again
    assert again.json["trial"]["passed"] is True
    assert again.json["trial"]["proposed"] == {"substeps": 1, "invert": []}
    assert {f["verdict"] for f in again.json["trial"]["findings"]} == {"good", "note"}


def test_what_stands_in_a_swap_file_stays_when_it_is_written_again(evcosim, tmp_path: Path) -> None:
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    swap = tmp_path / "swap.toml"
    swap.write_text(
        """
fmu = "Vehicle.fmu"
substeps = 4
isolation = "process"
absent = ["available_power", "front_wheel_speed", "rear_wheel_speed", "power", "acceleration"]
[map.inputs]
throttle = "pedal"
brake_force = { variable = "F_brake", invert = true }
road_grade = "slope"
[map.outputs]
speed = { variable = "v", unit = "m/s" }
distance = "s"
[map.parameters]
mass = "m_total"
[parameters]
mass = 150.0
[start]
road_grade = 0.01
"""
    )
    again = tmp_path / "again.toml"
    assert check(evcosim, swap, "--as", "scooter.vehicle", "--write", again).code == 0
    old, new = (read_toml(path, SwapFile) for path in (swap, again))
    assert new.model_copy(update={"replaces": None}) == old


def test_a_file_that_was_edited_is_not_written_anew(evcosim, tmp_path: Path) -> None:
    fmu, swap = vehicle_fmu(tmp_path / "Vehicle.fmu", 2), tmp_path / "swap.toml"
    check(evcosim, fmu, "--as", "scooter.vehicle", "--write", swap)
    swap.write_text(edited := f"# mine\n{swap.read_text()}")
    refused = evcosim("check", fmu, "--as", "scooter.vehicle", "--write", swap)
    assert refused.code == 2 and f"--write {swap}: the file is there" in " ".join(refused.err.split())
    assert swap.read_text() == edited
    check(evcosim, swap, "--as", "scooter.vehicle", "--write", swap)  # the file that is checked, as was asked
    assert swap.read_text() != edited


def test_names_that_would_end_a_line_of_a_swap_file(evcosim, tmp_path: Path) -> None:
    """What an FMU calls its variables stays a text."""
    name = "v&quot;&#10;substeps = 7&#10;# &#127; \\ é"
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 2, **{'name="v"': f'name="{name}"'})
    swap = tmp_path / "swap.toml"
    check(evcosim, fmu, "--as", "scooter.vehicle", "--write", swap)
    entry = read_toml(swap, SwapFile)
    assert entry.substeps == 1
    assert entry.map.outputs["speed"].variable == 'v"\nsubsteps = 7\n# \x7f \\ é'


def test_the_report_says_who_needs_what(evcosim, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")  # so that no cell is wrapped
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    out = " ".join(check(evcosim, fmu, "--as", "scooter.vehicle").out.split())
    assert "(from ecu.throttle over can0.VCU_Request.VCU_ThrottleRequest)" in out
    assert "(to battery.power)" in out


def test_a_place_whose_own_fmu_cannot_be_read(evcosim, tmp_path: Path) -> None:
    text = load_system("scooter").path.read_text().replace('fmu = "Scooter"', 'fmu = "gone.fmu"')
    (tmp_path / "mine.toml").write_text(text)
    found = check(evcosim, vehicle_fmu(tmp_path / "Vehicle.fmu", 2), "--as", "mine.toml.vehicle")
    assert found.code == 2
    assert "mine.toml: units.vehicle.fmu = 'gone.fmu' cannot be read, so that the interface" in found.err
    assert "gone.fmu: there is no such FMU file" in found.err


def test_a_place_that_has_a_mapping_already(evcosim, tmp_path: Path) -> None:
    """A system of the user's own, whose vehicle is a mapped FMU: another one is compared with that."""
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    mapped = """fmu = "Vehicle.fmu"
absent = ["power", "distance"]
[units.vehicle.map.inputs]
throttle = "pedal"
brake_force = "F_brake"
[units.vehicle.map.outputs]
speed = { variable = "v", unit = "m/s" }"""
    text = load_system("scooter").path.read_text().replace('fmu = "Scooter"', mapped)
    (tmp_path / "mine.toml").write_text(text)
    found = check(evcosim, "Scooter", "--as", "mine.toml.vehicle", "--json")
    rows = {row["need"]: row for row in found.json["rows"]}
    assert (rows["speed"]["variable"], rows["throttle"]["variable"]) == ("speed", "throttle")


def test_all_that_a_swap_lacks_is_told_at_once(evcosim, tmp_path: Path) -> None:
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    (tmp_path / "swap.toml").write_text('fmu = "Vehicle.fmu"\n[map.inputs]\nthrottle = "pedal"\n')
    found = evcosim("run", "scooter", "--swap", "vehicle=swap.toml")
    assert found.code == 2
    for name in ("speed", "power", "distance"):
        assert f"unit 'vehicle' has no variable '{name}' (" in found.err
    assert "brake_force" not in found.err  # fig8 leaves the rider out
    assert "'evcosim check swap.toml --as scooter.vehicle' shows" in found.err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("period = 0.015\n", "swap.toml: period = 0.015 s is not a multiple of the communication step"),
        ("[parameters]\nmas = 1.0\n", "swap.toml: parameters.mas: unit 'vehicle' has no variable 'mas'"),
        (
            "[start]\nspeed = 1.0\n",
            "swap.toml: start.speed: vehicle.speed is a continuous output whose initial value",
        ),
        ("[map.inputs]\nx = 'throtle'\n", "swap.toml: map.inputs.x: "),
        ("absent = ['speed']\n", "swap.toml: absent: "),
        ("substep = 1\n", "swap.toml: substep: unknown key (did you mean 'substeps'?)"),
    ],
)
def test_a_key_of_a_swap_file_is_named_as_it_stands_there(
    evcosim, tmp_path: Path, text: str, said: str
) -> None:
    (tmp_path / "swap.toml").write_text(f"fmu = 'Scooter'\n{text}")
    found = evcosim("run", "scooter", "--swap", "vehicle=swap.toml")
    assert found.code == 2
    assert f"evcosim: {said}" in found.err


DEFECT = {'unit="kg" start="200"': 'unit="kg" start="heavy"'}


@pytest.mark.parametrize(
    "arguments",
    [
        ("info", "Vehicle.fmu"),
        ("check", "Vehicle.fmu", "--as", "scooter.vehicle"),
        ("run", "scooter", "--fmu", "vehicle=Vehicle.fmu"),
    ],
)
def test_strict_refuses_an_fmu_with_defects(evcosim, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2, **DEFECT)
    found = evcosim(*arguments, "--strict")
    assert found.code == 2
    assert "strict: 1 defect: m_total: start = 'heavy' is no Real; it is ignored" in found.err
    assert "strict" not in evcosim(*arguments).err
    vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    assert "strict" not in evcosim(*arguments, "--strict").err


def test_strict_runs_refuse_it_from_python_too(tmp_path: Path) -> None:
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 2, **DEFECT)
    with pytest.raises(ConfigError, match="strict: 1 defect"):
        simulate("scooter", fmus={"vehicle": fmu}, strict=True)


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
        (
            ("Scooter", "--as", "scooter.vehicle", "--try", "soon"),
            "--try soon: it is a time of up to an hour",
        ),
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


NEUTRAL = {"F_brake": "u2", "slope": "u3"}


def unlike(path: Path) -> Path:
    """The vehicle in C with inputs whose names say nothing."""
    source = vehicle_fmu(path.with_name("source.fmu"), 2)
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            if name == "modelDescription.xml":
                for known, neutral in NEUTRAL.items():
                    data = data.replace(f'name="{known}"'.encode(), f'name="{neutral}"'.encode())
                data = re.sub(rb'(name="u\d"[^>]*) description="[^"]*"', rb"\1", data)
            new.writestr(name, data)
    return path


def test_a_swap_with_open_rows_runs_only_where_that_is_allowed(evcosim, tmp_path: Path) -> None:
    fmu, swap = unlike(tmp_path / "Vehicle.fmu"), tmp_path / "swap.toml"
    written = check(evcosim, fmu, "--as", "scooter.vehicle", "--write", swap)
    assert written.code == 1
    entry = read_toml(swap, SwapFile)
    assert (entry.open, list(entry.map.inputs)) == (["brake_force"], ["throttle"])
    assert f"--swap vehicle={swap} --allow-open" in written.out
    assert f"choose in {swap}, where each guess stands as a comment: brake_force" in written.out
    options = ("--swap", f"vehicle={swap}", "--stop-time", "1", "-o", tmp_path / "out", "--no-plot")
    refused = evcosim("run", "scooter", *options)
    assert refused.code == 2
    assert f"{swap}: open: no variable of" in refused.err and "--allow-open" in refused.err
    allowed = evcosim("run", "scooter", *options, "--allow-open")
    assert allowed.code == 0, allowed
    said = " ".join((allowed.out + allowed.err).split())
    assert "open: nothing drives vehicle.u2, vehicle.u3, which keep their start values" in said
    assert "left out, since it is absent: rider.brake_force -> vehicle.brake_force" in said
    with pytest.raises(ConfigError, match="allow_open=True"):
        simulate("scooter", swaps={"vehicle": swap}, stop_time=0.1)
    assert simulate("scooter", swaps={"vehicle": swap}, stop_time=0.1, allow_open=True).time[-1] == 0.1


def test_the_likeness_below_which_a_guess_is_open_is_stated(evcosim, tmp_path: Path) -> None:
    fmu, swap = unlike(tmp_path / "Vehicle.fmu"), tmp_path / "swap.toml"
    check(evcosim, fmu, "--as", "scooter.vehicle", "--write", swap, "--likeness", "0")
    assert read_toml(swap, SwapFile).open == []
    swap = tmp_path / "likely.toml"
    check(evcosim, fmu, "--as", "scooter.vehicle", "--write", swap)
    assert f"guesses of a likeness below {LIKENESS:g} stand below" in swap.read_text()
