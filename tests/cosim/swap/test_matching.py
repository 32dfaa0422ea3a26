"""Names as other tools write them, beside what our systems need."""

from __future__ import annotations

import functools

import pytest

from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.swap.matching import Row, fit
from evcosim.cosim.swap.name_likeness import likeness, unit_in
from evcosim.cosim.swap.requirements import Requirement, requirements
from evcosim.cosim.system.scenario import load_scenario
from evcosim.cosim.system.system import load_system
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import read_fmu

DYMOLA = """
input accPedal 1 | input brakeForce N | local vehicle.v m/s | local der(vehicle.v) m/s2 | local vehicle.s m
local der(vehicle.s) m/s | local motor.w rad/s | local battery.P W | local motor.P W
"""
PLAIN = """
input throttle_pct | input brake_force | output speed_kmh | output der(speed) | output power_kW
output distance
"""
SIMULINK = """
input VehCmd.AccelPdl | input VehCmd.BrkFrc | output VehFdbk.Body.BdyFrm.Cg.Vel.xdot | output EM_Pwr
output VehFdbk.Body.BdyFrm.Cg.Acc.ax | output VehFdbk.Body.InertFrm.Cg.Disp.X
"""
GERMAN = """
input Fahrpedalstellung % | input Bremskraft N | output Fahrzeuggeschwindigkeit km/h | output Wegstrecke km
output Laengsbeschleunigung m/s2 | output Leistung_el kW | output Winkelgeschwindigkeit_Rad rad/s
"""
GERMAN_CAR = """
input Lenkwinkel_vorn deg | input Lenkwinkel_hinten deg | output Gierrate deg/s | output Gierwinkel deg
output Quergeschwindigkeit m/s | output Querablage m
"""
ISO_CAR = """
input delta_f rad | input delta_r rad | output v_y m/s | output psi rad | output w_z rad/s | output y m
local der(psi) rad/s | local der(y) m/s
"""
SCOOTER = ("throttle", "brake_force", "speed", "power", "distance")
CAR = ("front_steering_angle", "rear_steering_angle", "lateral_velocity", "yaw_rate", "heading_angle")


def offer(text: str) -> UnitInterface:
    """Variables written "causality name unit", apart by | or lines."""
    words = [part.split() for line in text.split("\n") for part in line.split("|") if part.strip()]
    variables = {n: VariableInfo(n, causality=c, unit="".join(unit)) for c, n, *unit in words}
    return UnitInterface("Vehicle.fmu", variables)


@functools.cache
def needs(place: str, scenario: str | None = None) -> tuple[Requirement, ...]:
    system, _, unit = place.partition(".")
    read = load_system(system)
    interface = read_fmu(fmu_file(read.file.units[unit].fmu)).interface
    return requirements(read, load_scenario(read, scenario), unit, interface)


def rows(place: str, text: str) -> dict[str, Row]:
    return {row.need: row for row in fit(needs(place), offer(text)) if row.need}


@pytest.mark.parametrize(
    ("text", "place", "names", "expected"),
    [
        (DYMOLA, "scooter.vehicle", SCOOTER, "accPedal brakeForce vehicle.v battery.P|motor.P vehicle.s"),
        (PLAIN, "scooter.vehicle", SCOOTER, "throttle_pct brake_force speed_kmh power_kW distance"),
        (SIMULINK, "scooter.vehicle", SCOOTER, "VehCmd.AccelPdl VehCmd.BrkFrc "
         "VehFdbk.Body.BdyFrm.Cg.Vel.xdot EM_Pwr VehFdbk.Body.InertFrm.Cg.Disp.X"),
        (GERMAN, "scooter.vehicle", SCOOTER,
         "Fahrpedalstellung Bremskraft Fahrzeuggeschwindigkeit Leistung_el Wegstrecke"),
        (GERMAN_CAR, "lane_keeping.vehicle", (*CAR, "displacement"),
         "Lenkwinkel_vorn Lenkwinkel_hinten Quergeschwindigkeit Gierrate Gierwinkel Querablage"),
        (ISO_CAR, "lane_keeping.vehicle", (*CAR, "displacement"), "delta_f delta_r v_y w_z psi y"),
    ],
)  # fmt: skip # a case a row
def test_names_of_other_tools(text: str, place: str, names: tuple[str, ...], expected: str) -> None:
    found = rows(place, text)
    for name, variable in zip(names, expected.split(), strict=True):
        assert found[name].variable in variable.split("|"), found[name]


def test_a_derivative_is_not_what_it_is_derived_from() -> None:
    assert rows("scooter.vehicle", PLAIN)["speed"].candidates[0] == "speed_kmh"
    own = ("speed", "Speed")
    assert likeness(*own, "vehicle.v", "") > likeness(*own, "der(vehicle.v)", "") + 0.3
    assert likeness(*own, "der(vehicle.s)", "") > likeness(*own, "vehicle.s", "") + 0.3
    assert likeness("acceleration", "", "der(vehicle.v)", "") == likeness("acceleration", "", "a", "")


def test_two_that_are_as_likely_are_the_users_to_choose() -> None:
    power = rows("scooter.vehicle", DYMOLA)["power"]
    assert power.verdict == "your choice"
    assert "others are as likely" in power.reason
    assert {power.variable, *power.others} >= {"battery.P", "motor.P"}


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("speed_kmh", "km/h"), ("vVehKmh", "km/h"), ("VxBody_mps", "m/s"), ("v_km_h", "km/h"),
        ("a_mps2", "m/s2"), ("n_rpm", "rpm"), ("trq_Nm", "N.m"), ("PedalPct", "%"), ("delta_deg", "deg"),
        ("speed", ""), ("rad", ""), ("psi_w", ""), ("mps", ""), ("programs", ""), ("Sperad", ""),
    ],
)  # fmt: skip # a table
def test_units_of_measure_in_names(name: str, unit: str) -> None:
    assert unit_in(name) == unit


def test_a_unit_in_the_name_is_assumed_and_told_where_none_is_declared() -> None:
    found = rows("scooter.vehicle", PLAIN)
    speed = found["speed"]
    assert (speed.verdict, speed.unit) == ("your choice", "km/h")
    assert speed.reason == "declares no unit of measure; its name says [km/h], the system has [m/s]"
    assert (found["distance"].unit, found["power"].unit) == ("m", "kW")
    assert rows("scooter.vehicle", "output v_Nm")["speed"].verdict == "missing"
    declared = rows("scooter.vehicle", "output v_kmh m/s")["speed"]
    assert (declared.verdict, declared.unit) == ("fits", "")


def test_rows_say_who_needs_them() -> None:
    throttle = rows("scooter.vehicle", PLAIN)["throttle"]
    assert throttle.needed == ("from ecu.throttle over can0.VCU_Request.VCU_ThrottleRequest",)
