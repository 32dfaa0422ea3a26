"""A new folder runs as it is; a copy of a built-in system gives its results to the last bit."""

from __future__ import annotations

import subprocess
import sys

import pytest

from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.scenario import load_scenario, scenario_names
from evcosim.cosim.system.system import load_system, system_names
from evcosim.cosim.system.toml import is_built_in
from evcosim.master.builtin import build_models, builtin_names
from evcosim.master.new_system import new_system
from evcosim.master.prepare import prepare
from evcosim.master.simulation import simulate


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    folder = tmp_path_factory.mktemp("new") / "my_car"
    new_system(folder)
    return folder


def test_the_example_is_whole_and_does_what_it_says(example):
    there = {path.relative_to(example).as_posix() for path in example.rglob("*") if path.is_file()}
    assert {"README.md", "my_car.toml", "can/bus.dbc", "scenarios/my_car/hill.toml", "run.py"} <= there
    assert not any("@" in path.read_text(encoding="utf-8") for path in example.glob("*.*"))
    results = simulate(example / "my_car.toml")
    for time in (15.0, 44.0, 59.0):  # it keeps the speed: on the flat, behind the hill, and behind the fault
        assert results["vehicle.speed"][round(time * 100)] * 3.6 == pytest.approx(30.0, abs=1.0)
    measured = results["controller.speed_measured"]
    assert set(measured[:4400] % 0.5) == {0.0}  # the resolution of its signal
    assert prepare(example / "my_car.toml").outside == ()
    assert results.manifest["units"]["vehicle"]["isolation"] == "none"


@pytest.mark.parametrize("name", ["a", "mine", "my_car", "a_car_with_a_long_name"])
@pytest.mark.parametrize("base", [None, "braking"])
def test_the_comments_of_the_commands_stand_in_one_column(tmp_path, name, base):
    new_system(tmp_path / name, base)
    commands = (tmp_path / name / "README.md").read_text(encoding="utf-8").split("```")[1].splitlines()[1:]
    assert len(commands) >= 2 and len({line.index("  # ") for line in commands}) == 1


def test_the_script_of_the_example_runs(example):
    done = subprocess.run([sys.executable, "run.py"], cwd=example, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(done.stdout.splitlines()) == 3 and "900.0 kg: highest speed 33." in done.stdout


def test_a_changed_model_changes_the_run(example):
    before = simulate(example / "my_car.toml", stop_time=10.0)
    file = example / "models" / "controller.py"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("gain: float = var(800.0", "gain: float = var(400.0"), encoding="utf-8")
    build_models(file)
    changed = simulate(example / "my_car.toml", stop_time=10.0)
    file.write_text(text, encoding="utf-8")
    build_models(file)
    again = simulate(example / "my_car.toml", stop_time=10.0)
    assert (changed["vehicle.speed"] != before["vehicle.speed"]).any()
    assert again.data.tobytes() == before.data.tobytes()


def test_the_messages_of_the_example_have_cycle_times(example):
    for message in load_dbc(example / "can" / "bus.dbc").messages.values():
        assert message.cycle_time == 0.02


@pytest.mark.parametrize("name", system_names())
def test_a_copy_gives_the_same_results(tmp_path, name):
    new_system(tmp_path / "mine", name)
    system = load_system(str(tmp_path / "mine" / "mine.toml"))
    assert not {unit.fmu for unit in system.file.units.values()} & set(builtin_names())
    assert set(scenario_names(system)) == set(scenario_names(load_system(name)))
    for scenario in scenario_names(system):
        read = load_scenario(system, scenario)
        assert read.path is not None and not is_built_in(read.path)
        for _, entry in read.file.stimuli:
            assert entry.csv is None or (read.path.parent / entry.csv).is_file()
    copy, original = (simulate(system, stop_time=1.0) for system in (str(system.path), name))
    assert copy.names == original.names
    assert copy.data.tobytes() == original.data.tobytes()


@pytest.mark.parametrize(
    ("folder", "base", "said"),
    [
        ("my-car", None, r"my-car: a system's name is made of letters, digits and '_', as in my_car$"),
        ("1car", None, r"1car: a system's name is made of letters, digits and '_'$"),
        ("vélo", None, r"a system's name is made of letters"),
        (".", None, r"is there already, and nothing is overwritten"),
        ("scooter", None, r"scooter is the name of a built-in system"),
        ("there", None, r"there: is there already, and nothing is overwritten"),
        ("a_file", None, r"a_file: is there already"),
        ("gone", None, r"gone: is there already"),
        ("a_file/car", None, r"car: cannot be made: "),
        ("mine", "scoter", r"--from scoter: it is no built-in system \(did you mean 'scooter'\?\)"),
    ],
)
def test_what_cannot_be_made_is_said_and_nothing_is_left(tmp_path, monkeypatch, folder, base, said):
    home = tmp_path / "home"
    (home / "there").mkdir(parents=True)
    (home / "a_file").write_text("mine", encoding="utf-8")
    (home / "gone").symlink_to("nowhere")
    before = sorted(home.rglob("*"))
    monkeypatch.chdir(home)
    with pytest.raises(ConfigError, match=said):
        new_system(home / folder, base)
    assert sorted(home.rglob("*")) == before
    assert (home / "a_file").read_text(encoding="utf-8") == "mine"


def test_a_model_that_cannot_be_built_leaves_nothing(tmp_path, monkeypatch):
    def broken(path):
        raise ConfigError("no space")

    monkeypatch.setattr("evcosim.master.new_system.build_models", broken)
    with pytest.raises(ConfigError, match="no space"):
        new_system(tmp_path / "car")
    assert list(tmp_path.iterdir()) == []
