"""Preparing a run finds what is wrong before any FMU is loaded, and changes nothing that it is given."""

from __future__ import annotations

import re
from fractions import Fraction as F

import pytest

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.scenario import load_scenario
from evcosim.cosim.system.system import load_system
from evcosim.fmus import recipes
from evcosim.master.builtin import fmu_file
from evcosim.master.prepare import prepare
from evcosim.master.simulation import Simulation
from support.needs import need_c_compiler


def test_what_is_known_before_the_first_step():
    prepared = prepare("scooter", parameters={"vehicle.mass": 180.0}, stop_time=2.0)
    assert prepared.scenario.name == "fig8"
    assert list(prepared.fmus) == [unit.name for unit in prepared.plan.units]
    vehicle = next(unit for unit in prepared.plan.units if unit.name == "vehicle")
    assert vehicle.parameters == {"mass": 180.0}
    assert prepared.plan.experiment.stop_time == 2.0


def test_files_and_what_is_made_in_memory_are_the_same():
    system = load_system("scooter")
    scenario = load_scenario(system, "fig9")
    by_name, in_memory = prepare("scooter", "fig9"), prepare(system, scenario)
    assert (by_name.system, by_name.scenario) == (in_memory.system, in_memory.scenario)
    assert by_name.plan.memory_size == in_memory.plan.memory_size


def test_buses_are_varied_in_this_run_only():
    system = load_system("scooter")
    varied = prepare(system, bus=BusVariation(delay_steps=3)).plan
    assert {message.delay for message in varied.messages} == {3}
    assert {message.delay for message in prepare(system).plan.messages} == {0}


def test_a_delay_is_added_to_that_of_the_files_and_of_a_variation():
    late = prepare("lane_keeping", delay=0.02, step_size=0.005, stop_time=1.0)
    assert {m.delay for m in late.plan.messages} == {4}
    both = prepare("scooter", delay=0.02, bus=BusVariation(delay_steps=3))
    assert {m.delay for m in both.plan.messages} == {5}


def test_the_step_size_of_an_option_counts_before_those_of_the_files():
    plan = prepare("scooter", step_size=0.005).plan
    assert (plan.clock.step, plan.steps) == (0.005, 8000)
    assert {m.every for m in plan.messages} <= {2, 20}


def test_what_an_option_records_takes_the_place_of_the_files_or_something_out_of_it():
    names = [v.name for v in prepare("scooter").plan.columns]
    alone = prepare("scooter", record=["vehicle.speed", "ecu.*", "!ecu.state"])
    assert {n.partition(".")[0] for n in (v.name for v in alone.plan.columns)} == {"ecu", "vehicle"}
    assert "ecu.state" not in [v.name for v in alone.plan.columns]
    assert any("left out for want of" in text for text in alone.plan.warnings)
    less = prepare("scooter", record=["!battery.*"])
    assert [v.name for v in less.plan.columns] == [n for n in names if not n.startswith("battery.")]


def test_the_command_that_repeats_a_run():
    prepared = prepare("scooter", "fig9", delay=0.02, start={"vehicle.road_grade": 0.01})
    assert prepared.options == {"delay": 0.02, "start": {"vehicle.road_grade": 0.01}}
    assert prepared.command == (
        "evcosim run scooter --scenario fig9 --start vehicle.road_grade=0.01 --delay 0.02"
    )
    assert prepare(load_system("scooter")).command == ""


def test_an_fmu_in_the_place_of_another_is_read_from_its_path(tmp_path):
    own = tmp_path / "own.fmu"
    own.write_bytes(fmu_file("Battery").read_bytes())
    assert prepare("scooter", fmus={"battery": own}).fmus["battery"].path == own


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"ideal": True, "bus": BusVariation(cycle=2)}, "'ideal' leaves the buses out"),
        ({"ideal": True, "delay": 0.01}, "'ideal' leaves the buses out, so that 'delay' has none"),
        ({"delay": 0.015}, r"^delay = 0\.015 s is not a multiple of the communication step 0\.01 s"),
        (
            {"step_size": 0.03},
            r"^step_size = 0\.03 s, where the files have 0\.01 s: .*fig8\.toml: experiment\.",
        ),
        (
            {"record": ["vehicle.sped"]},
            r"^record: 'vehicle\.sped' fits no variable \(did you mean 'vehicle.speed'",
        ),
        (
            {"fmus": {"batery": "x.fmu"}},
            r"^fmus: there is no unit 'batery' \(did you mean 'battery'\?\)",
        ),
        ({"fmus": {"battery": "x.fmu"}}, r"^fmus\.battery: x\.fmu: there is no such FMU file"),
        ({"swaps": {"batery": "x.toml"}}, "batery"),
        (
            {"swaps": {"battery": "a.toml"}, "fmus": {"vehicle": "x.fmu", "battery": "x.fmu"}},
            r"^--swap battery=a\.toml \(swaps\) and --fmu battery=x\.fmu \(fmus\) both put an FMU",
        ),
        ({"parameters": {"vehicle.mas": 1.0}}, r"parameter vehicle\.mas: .*did you mean 'mass'"),
        ({"stop_time": 0.015}, "not a multiple"),
    ],
)
def test_wrong_options(options, text):
    with pytest.raises(ConfigError, match=text):
        prepare("scooter", **options)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ('"Scooter"', '"no.fmu"', r"units\.vehicle\.fmu: no\.fmu: there is no such FMU file"),
        ('"Scooter"', '"Scoter"', r"units\.vehicle\.fmu: there is no built-in FMU 'Scoter' \(did you mean"),
        ("can/ev.dbc", "can/ev2.dbc", r"buses\.can0\.dbc: there is no file 'can/ev2\.dbc'"),
    ],
)
def test_a_file_that_is_missing_is_named_with_its_key(tmp_path, old, new, text):
    path = tmp_path / "mine.toml"
    path.write_text(load_system("scooter").path.read_text().replace(old, new))
    with pytest.raises(ConfigError, match=rf"^{re.escape(str(path))}: {text}"):
        prepare(path)


def test_the_fmu_that_a_swap_file_lacks_is_named_with_the_swap_file(tmp_path):
    path = tmp_path / "swap.toml"
    path.write_text('fmu = "no.fmu"\n')
    with pytest.raises(ConfigError, match=rf"^{re.escape(str(path))}: fmu: no\.fmu: there is no such FMU"):
        prepare("scooter", swaps={"vehicle": path})


def test_an_fmu_with_other_names_is_refused_with_advice():
    """For both ways of putting it in: the option's and Python's."""
    with pytest.raises(ConfigError) as refusal:
        prepare("scooter", fmus={"vehicle": "Battery"})
    first, advice = str(refusal.value).split("\n")
    assert "vehicle" in first
    assert "'evcosim check Battery --as scooter.vehicle' shows what the system needs" in advice
    assert advice.endswith("--swap vehicle=FILE, or in Python `swaps`")


def test_there_is_no_advice_about_an_fmu_that_is_not_at_fault():
    with pytest.raises(ConfigError, match=r"vehicle\.mass: 0\.1 kg is below") as refusal:
        prepare("scooter", fmus={"vehicle": "Scooter"}, parameters={"vehicle.mass": 0.1})
    assert "evcosim check" not in str(refusal.value)


def test_a_misspelled_option():
    with pytest.raises(TypeError, match=r"a run has no option 'algoritm' \(did you mean 'algorithm'\?\)"):
        prepare("scooter", algoritm="jacobi")


def test_variables_that_are_absent_may_not_be_there(tmp_path):
    path = tmp_path / "mine.toml"
    text = (
        load_system("scooter")
        .path.read_text()
        .replace('fmu = "Scooter"', 'fmu = "Scooter"\nabsent = ["power"]')
    )
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"mine\.toml: units\.vehicle\.absent: .* has 'power'"):
        prepare(path)


def test_a_time_may_be_a_fraction() -> None:
    plans = [prepare("scooter", stop_time=n, step_size=h).plan for n, h in ((1.0, 0.005), (F(1), F(1, 200)))]
    assert plans[0].clock == plans[1].clock
    with pytest.raises(ConfigError, match=r"^step_size = 0.5 s, where the files have 0.01 s"):
        prepare("scooter", stop_time=1.25, step_size=F(1, 2))


@pytest.mark.parametrize("units", ["python", "native", "auto"])
def test_a_run_asks_once_whether_the_models_of_its_units_were_changed(units, monkeypatch):
    if units != "python":
        need_c_compiler()
    asked, look = [], recipes._models
    monkeypatch.setattr(recipes, "_models", lambda folder: asked.append(folder) or look(folder))
    with Simulation("multi_drive", units=units, stop_time=0.1):  # 7 units of 5 FMUs
        assert len(asked) == 1
    prepare("multi_drive", units=units)
    assert len(asked) == 2
