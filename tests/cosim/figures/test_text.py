"""Texts of figures."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.figures.text import broken, pretty


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("ecu.acceleration_estimate", ["ecu.", "acceleration_estimate"]),
        ("controller.rear_steering_angle", ["controller.", "rear_steering_angle"]),
        ("ecu.a_very_long_name_of_a_variable_that", ["ecu.a_very_long_name_of_", "a_variable_that"]),
        ("speed of the front wheel of the vehicle", ["speed of the front wheel", "of the vehicle"]),
        ("x" * 40, ["x" * 40]),
        ("", [""]),
    ],
)
def test_names_are_broken_at_their_marks(text: str, lines: list[str]) -> None:
    assert broken(text, 24).split("\n") == lines


@pytest.mark.parametrize(
    ("unit", "shown"),
    [
        ("m/s2", "m/s²"),
        ("N.m", "N·m"),
        ("kg/m3", "kg/m³"),
        ("1", "1"),
        ("m.s-1", "m·s⁻¹"),
        ("uH", "µH"),
        ("ohm", "Ω"),
        ("kohm.m", "kΩ·m"),
        ("unit", "unit"),
        ("u", "u"),
        ("urad/us", "urad/µs"),
        ("uohm", "µΩ"),
    ],
)
def test_units_are_printed_as_in_print(unit: str, shown: str) -> None:
    assert pretty(unit) == shown


words = st.text(st.sampled_from("ab._-/ "), max_size=60)


@given(words, st.integers(1, 30))
def test_breaking_adds_line_ends_and_nothing_else(text: str, width: int) -> None:
    lines = broken(text, width).split("\n")
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")
    assert all(len(line) <= width or not set(line.rstrip("._-/")) & set("._-/ ") for line in lines)


@given(words)
def test_what_has_room_stays_on_one_line(text: str) -> None:
    assert broken(text, 60) == " ".join(text.split())
