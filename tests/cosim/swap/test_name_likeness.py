"""Likeness of names: relations that hold for all names, and names as tools write them."""

from __future__ import annotations

import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from evcosim.cosim.swap import name_likeness
from evcosim.cosim.swap.name_likeness import likeness, unit_in

NAMES = st.text("abcdefghijklmnopqrstuvwxyzVRSäöüß_.123", max_size=20)


@given(NAMES, NAMES, NAMES, NAMES)
def test_a_likeness_is_from_0_to_1(name: str, text: str, other: str, other_text: str) -> None:
    assert 0.0 <= likeness(name, text, other, other_text) <= 1.0 + 1e-12


@pytest.mark.parametrize(
    "name", ["speed", "brake_force", "yaw_rate", "state_of_charge", "front_steering_angle"]
)
def test_a_name_is_like_itself_most_of_all(name: str) -> None:
    assert likeness(name, "", name, "") == pytest.approx(1.0)
    for other in ("Body.Pos", "motor.w", "u", f"{name}s_of_the_other_axle"):
        assert likeness(name, "", other, "") < 1.0


@pytest.mark.parametrize(
    ("name", "english", "other"),
    [
        ("Geschwindigkeit", "speed", "Vel"),
        ("Bremskraft", "brake_force", "BrkFrc"),
        ("Lenkwinkel_vorn", "front_steering_angle", "SteerAngFrnt"),
        ("Gierrate", "yaw_rate", "YawRate"),
        ("Wegstrecke", "distance", "Pos"),
    ],
)
def test_german_and_abbreviations_mean_the_same(name: str, english: str, other: str) -> None:
    assert likeness(english, "", name, "") > 0.7
    assert likeness(english, "", other, "") > 0.7


def test_upper_case_and_the_unit_at_the_end_do_not_count() -> None:
    for other in ("vehicle_speed_kmh", "VehicleSpeed", "vehicleSpeed_mps"):
        assert likeness("speed", "", other, "") == likeness("speed", "", "vehicle_speed", "")


def test_a_description_helps() -> None:
    assert likeness("speed", "Speed", "y1", "Speed of the vehicle") > likeness("speed", "Speed", "y1", "")


def test_a_derivative_is_not_what_it_is_derived_from() -> None:
    own = ("speed", "Speed")
    assert likeness(*own, "vehicle.v", "") > likeness(*own, "der(vehicle.v)", "") + 0.3
    assert likeness(*own, "der(vehicle.s)", "") > likeness(*own, "vehicle.s", "") + 0.3
    assert likeness("acceleration", "", "der(vehicle.v)", "") == likeness("acceleration", "", "a", "")


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


@given(NAMES)
def test_a_unit_stands_at_the_end_of_a_word(name: str) -> None:
    assert unit_in(f"{name}_kmh") == "km/h"
    assert unit_in(f"{name}_kmh_x") == ""


PARTS = st.sampled_from(
    [
        "der(",
        ")",
        "_dot",
        "Dot",
        "_",
        ".",
        "[1,2]",
        "speed",
        "Vel",
        "mps2",
        "m_s2",
        "_mps",
        "23",
        "2",
        "1",
        "s2x",
        "ä2",
    ]
)
LONG = st.lists(PARTS, max_size=6).map("".join)


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(["speed", "speed_2", "x1", "accel_mps2", ""]), LONG, LONG, LONG)
def test_numbers_and_letters_that_are_passed_over_count_for_nothing(
    monkeypatch: pytest.MonkeyPatch, name: str, text: str, other: str, other_text: str
) -> None:
    found = likeness(name, text, other, other_text)
    with monkeypatch.context() as patch:
        nothing = re.compile("(?!)")
        patch.setattr(name_likeness, "_NUMBER", nothing)
        patch.setattr(name_likeness, "_others_than", lambda a: nothing)
        assert likeness(name, text, other, other_text) == found


def test_names_that_differ_by_their_numbers_are_compared_once() -> None:
    """A large FMU has 100,000 of them."""
    name_likeness._by_words.cache_clear()
    name_likeness._ratio.cache_clear()
    for i in range(500):
        likeness("speed", "Speed", f"body.part[{i}].T_{i}", f"Some text {i}")
    assert name_likeness._by_words.cache_info().misses == 1
    assert name_likeness._ratio.cache_info().misses <= 3  # of one, two and three digits
