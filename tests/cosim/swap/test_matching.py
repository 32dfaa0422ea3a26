"""Matches: names as other tools write them, for what our systems need."""

from __future__ import annotations

import functools
from typing import get_args

import pytest

from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.swap.matching import Match, Verdict, fits, is_open, matches
from evcosim.cosim.swap.requirements import Requirement, requirements
from evcosim.cosim.system.scenario import load_scenario, scenario_names
from evcosim.cosim.system.system import UnitEntry, load_system, system_names
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


def found(place: str, text: str, entry: UnitEntry | None = None) -> dict[str, Match]:
    """Return the matches by what they are for."""
    return {match.need: match for match in matches(needs(place), offer(text), entry) if match.need}


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
    matched = found(place, text)
    for name, variable in zip(names, expected.split(), strict=True):
        assert matched[name].variable in variable.split("|"), matched[name]


def test_a_derivative_is_not_what_it_is_derived_from() -> None:
    assert found("scooter.vehicle", PLAIN)["speed"].candidates[0] == "speed_kmh"


def test_two_that_are_as_likely_are_the_users_to_choose() -> None:
    power = found("scooter.vehicle", DYMOLA)["power"]
    assert power.verdict == "your choice"
    assert "others are as likely" in power.reason
    assert {power.variable, *power.others} >= {"battery.P", "motor.P"}


def test_a_unit_in_the_name_is_assumed_where_none_is_declared() -> None:
    matched = found("scooter.vehicle", PLAIN)
    speed = matched["speed"]
    assert (speed.verdict, speed.unit) == ("your choice", "km/h")
    assert speed.reason == "declares no unit of measure; its name says [km/h], the system has [m/s]"
    assert (matched["distance"].unit, matched["power"].unit) == ("m", "kW")
    assert found("scooter.vehicle", "output v_Nm")["speed"].verdict == "missing"
    declared = found("scooter.vehicle", "output v_kmh m/s")["speed"]
    assert (declared.verdict, declared.unit) == ("fits", "")


def test_matches_say_who_needs_them() -> None:
    throttle = found("scooter.vehicle", PLAIN)["throttle"]
    assert throttle.needed == ("from ecu.throttle over can0.VCU_Request.VCU_ThrottleRequest",)


PLACES = [(s, unit) for s in system_names() for unit in load_system(s).file.units]


def matches_of(system: str, unit: str, scenario: str | None = None) -> list[Match]:
    """The matches for a unit's own FMU in its own place."""
    described = load_system(system)
    interface = read_fmu(fmu_file(described.file.units[unit].fmu)).interface
    return matches(requirements(described, load_scenario(described, scenario), unit, interface), interface)


@pytest.mark.parametrize(("system", "unit"), PLACES)
def test_every_unit_fits_in_its_own_place(system: str, unit: str) -> None:
    for scenario in scenario_names(load_system(system)):
        rows = matches_of(system, unit, scenario)
        assert fits(rows), rows
        assert all(row.variable == row.need and row.verdict == "fits" for row in rows if row.need)


@pytest.mark.parametrize("text", [DYMOLA, PLAIN, SIMULINK, GERMAN])
def test_every_need_has_one_match_and_no_variable_two(text: str) -> None:
    wanted = needs("scooter.vehicle")
    made = matches(wanted, offer(text))
    assert [m.need for m in made if m.need] == [need.name for need in wanted]
    taken = [m.variable for m in made if m.variable]
    assert len(taken) == len(set(taken))
    assert set(offer(text).variables) >= set(taken)


@pytest.mark.parametrize("text", [DYMOLA, PLAIN, SIMULINK, GERMAN])
def test_the_order_in_which_an_fmu_declares_does_not_count(text: str) -> None:
    """But for variables that are as likely, of which either may come first."""
    parts = [part.strip() for line in text.split("\n") for part in line.split("|") if part.strip()]
    turned = found("scooter.vehicle", " | ".join(reversed(parts)))
    for need, match in found("scooter.vehicle", text).items():
        if "others are as likely" not in match.reason:
            assert (turned[need].variable, turned[need].verdict) == (match.variable, match.verdict)


def test_what_is_mapped_is_judged_as_it_is() -> None:
    tables = {"inputs": {"throttle": "brake_force"}, "outputs": {"speed": "gone"}}
    entry = UnitEntry.model_validate({"fmu": "F", "map": tables, "absent": ["power"]})
    matched = found("scooter.vehicle", PLAIN, entry)
    assert matched["throttle"].variable == "brake_force"
    assert matched["throttle"].reason.startswith("as mapped: ")
    assert (matched["speed"].verdict, matched["speed"].reason) == (
        "missing",
        "the FMU has no variable of this name",
    )
    assert (matched["power"].verdict, matched["power"].variable) == ("fits", "")


def test_an_input_that_nothing_drives_is_unused() -> None:
    made = matches(needs("scooter.vehicle"), offer(DYMOLA + "| input wind m/s"))
    assert [(m.variable, m.verdict) for m in made if not m.need] == [("wind", "unused")]


@pytest.mark.parametrize("verdict", get_args(Verdict))
def test_what_is_missing_or_to_choose_does_not_fit(verdict: Verdict) -> None:
    good = verdict in ("fits", "fits after conversion", "unused")
    assert fits([Match("a", "input", "x", verdict, "")]) is good
    assert fits([Match("b", "input", "y", "fits", ""), Match("a", "input", "x", verdict, "")]) is good


def test_what_is_optional_is_taken_by_its_own_name_or_not_at_all() -> None:
    """A power that is delivered is no limit, however alike the names are."""
    without = found("scooter.vehicle", PLAIN + " | input available_pwr W")
    assert (without["available_power"].variable, without["available_power"].verdict) == ("", "fits")
    assert "optional" in without["available_power"].reason
    own = found("scooter.vehicle", PLAIN + " | input available_power kW")["available_power"]
    assert (own.variable, own.verdict) == ("available_power", "fits after conversion")


def test_a_guess_of_a_low_likeness_is_open() -> None:
    matched = found("scooter.vehicle", "input xyz %\noutput speed m/s\noutput s m")
    assert matched["throttle"].verdict == "your choice" and is_open(matched["throttle"])
    assert f"(likeness {matched['throttle'].likeness:.2f})" in matched["throttle"].reason
    assert matched["speed"].likeness is None and not is_open(matched["speed"], 1.0)
    assert not is_open(matched["throttle"], 0.0) and not is_open(matched["brake_force"], 1.0)  # missing
    mapped = UnitEntry.model_validate({"fmu": "V.fmu", "map": {"inputs": {"throttle": "xyz"}}})
    assert not is_open(found("scooter.vehicle", "input xyz %", mapped)["throttle"], 1.0)
