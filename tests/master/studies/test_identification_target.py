"""The target of an identification: a system with its scenario, or one FMU as a system."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import load_system
from evcosim.master.builtin import fmu_file
from evcosim.master.single_fmu import UNIT
from evcosim.master.studies.identification_target import (
    SCENARIO,
    default_scenario,
    is_fmu,
    one_unit_system,
    spec_of,
)
from support.descriptions import changed, described


def test_a_system_of_one_fmu_takes_its_step_from_it():
    assert one_unit_system("Scooter").file.experiment.step_size == 0.01
    assert one_unit_system("Scooter", 0.02).file.experiment.step_size == 0.02


def test_scenario_names_the_experiment():
    found = spec_of("scooter")
    assert found is not None
    assert (found.input, found.output, found.at) == ("ecu.throttle_request", "ecu.speed_measured", [30.0])
    assert spec_of("scooter", "fig8") is None
    assert spec_of("Scooter") is None


def test_systems_and_fmus_are_told_apart(tmp_path):
    assert is_fmu("Scooter")
    assert is_fmu(str(tmp_path / "own.fmu"))
    assert not is_fmu("scooter")
    assert not is_fmu("own.toml")
    assert not is_fmu("folder/own")
    with pytest.raises(
        ConfigError, match=r"no system or FMU 'scoter' \(did you mean 'scooter'\?\); systems: "
    ):
        is_fmu("scoter")


def test_a_system_of_a_file_has_the_name_of_the_file(tmp_path):
    copy = tmp_path / "mine.fmu"
    copy.write_bytes(fmu_file("Battery").read_bytes())
    system = one_unit_system(str(copy))
    assert system.file.name == "mine"
    assert list(system.file.units) == [UNIT]
    odd = copy.rename(tmp_path / "my-pack 2.fmu")
    assert one_unit_system(str(odd)).file.name == "my_pack_2"  # the name that a run of it has


@pytest.mark.parametrize("declared", ["0", "-0.1", "1e999"])
def test_a_step_size_of_an_fmu_that_is_none_counts_for_nothing(declared: str, tmp_path: Path) -> None:
    changes = ("<ModelVariables>", f'<DefaultExperiment stepSize="{declared}"/><ModelVariables>')
    path = described(tmp_path, changed(changes))
    assert one_unit_system(str(path)).file.experiment.step_size == 0.01


def test_the_scenario_of_its_name_is_the_default():
    assert default_scenario(load_system("scooter"), None) == SCENARIO
    assert default_scenario(load_system("scooter"), "fig8") == "fig8"
    assert default_scenario(load_system("braking"), None) is None
