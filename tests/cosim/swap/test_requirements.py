"""Needs of a system from a unit: which variables, in which order, and who needs them."""

from __future__ import annotations

import functools

import pytest

from evcosim.cosim.interface import UnitInterface
from evcosim.cosim.swap.requirements import ROLES, lacking, requirements
from evcosim.cosim.system.scenario import load_scenario, scenario_names
from evcosim.cosim.system.system import load_system, system_names
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import read_fmu

PLACES = [(s, unit) for s in system_names() for unit in load_system(s).file.units]


@functools.cache
def interface_of(system: str, unit: str) -> UnitInterface:
    return read_fmu(fmu_file(load_system(system).file.units[unit].fmu)).interface


def test_what_a_system_needs_is_named_with_its_other_end() -> None:
    system = load_system("scooter")
    interface = interface_of("scooter", "vehicle")
    needs = {n.name: n for n in requirements(system, load_scenario(system, "udds"), "vehicle", interface)}
    assert needs["throttle"].role == "input"
    assert needs["throttle"].needed == ("from ecu.throttle over can0.VCU_Request.VCU_ThrottleRequest",)
    assert needs["power"].needed == ("to battery.power", "figure or metrics")
    assert "figure or metrics" in needs["speed"].needed


@pytest.mark.parametrize(("system", "unit"), PLACES)
def test_needs_are_of_the_unit_each_once_and_by_role(system: str, unit: str) -> None:
    described, interface = load_system(system), interface_of(system, unit)
    for scenario in (None, *scenario_names(described)):
        needs = requirements(described, load_scenario(described, scenario), unit, interface)
        names = [need.name for need in needs]
        assert len(names) == len(set(names))
        roles = [ROLES.index(need.role) for need in needs]
        assert roles == sorted(roles)
        assert all(need.variable == interface.variables[need.name] and need.needed for need in needs)


@pytest.mark.parametrize(("system", "unit"), PLACES)
def test_a_units_own_fmu_lacks_nothing_and_an_empty_one_all_but_parameters(system: str, unit: str) -> None:
    described, interface = load_system(system), interface_of(system, unit)
    scenario = load_scenario(described, None)
    assert lacking(described, scenario, unit, interface) == []
    if unit in scenario.file.leave_out:
        return
    without = lacking(described, scenario, unit, UnitInterface("empty.fmu", {}))
    named = {clause.split("'")[1] for clause in without}
    needs = requirements(described, scenario, unit, interface)
    assert named <= {need.name for need in needs if need.role != "parameter"} | set(interface.variables)
    assert named


def test_what_optional_connections_and_lines_alone_need_may_be_missing() -> None:
    system, empty = load_system("scooter"), UnitInterface("empty.fmu", {})
    scenario = load_scenario(system, "udds")
    outputs = ["front_wheel_speed", "rear_wheel_speed", "acceleration"]
    for unit, optional in (("vehicle", ["available_power", *outputs]), ("battery", ["available_power"])):
        needs = requirements(system, scenario, unit, interface_of("scooter", unit))
        assert [n.name for n in needs if n.optional] == optional
        said = " ".join(lacking(system, scenario, unit, empty))
        assert not any(f"'{name}'" in said for name in optional)


def test_units_that_are_left_out_need_nothing() -> None:
    system = load_system("scooter")
    empty = UnitInterface("empty.fmu", {})
    all_units = " ".join(lacking(system, load_scenario(system, "udds"), "vehicle", empty))
    no_rider = " ".join(lacking(system, load_scenario(system, "fig8"), "vehicle", empty))
    assert "'brake_force' (from rider.brake_force" in all_units
    assert "brake_force" not in no_rider


def test_what_the_values_of_a_scenario_need_is_not_optional() -> None:
    system, interface = load_system("scooter"), interface_of("scooter", "vehicle")
    for name, optional in (("fig8", True), ("fig8_wheels", False)):
        needs = requirements(system, load_scenario(system, name), "vehicle", interface)
        found = {need.name: need.optional for need in needs}
        assert found["front_wheel_speed"] == found["rear_wheel_speed"] == optional
        assert found["available_power"]
