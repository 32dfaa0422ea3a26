"""Units of measure in names of columns: those of the input's quantity that are other ones are warnings."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.csv_numbers import CsvFile
from evcosim.cosim.plan.column_units import note_units
from evcosim.cosim.plan.unit_maps import End


def noted(folder: Path, name: str, unit: str, given: str | None = None, time: str = "t") -> list[str]:
    path = folder / "v.csv"
    path.write_text(f'"{time}","{name}"\n0,1\n')
    return note_units(CsvFile.of(path), (0, 1), End("car.x", unit), given, "the stimulus")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("speed [km/h]", "km/h"), ("speed (km/h)", "km/h"), ("speed{km/h}", "km/h"), ("speed <km/h>", "km/h"),
        ("speed [km/h] (filtered)", "km/h"), ("speed [in km/h]", "km/h"), ("speed/(km/h)", "km/h"),
        ("speed_kmh", "kmh"), ("Speed_KMH", "KMH"), ("speed_km_h", "km/h"), ("speed_km_per_h", "km/h"),
        ("v_speed_kph", "kph"), ("speed_mph", "mph"), ("speed / km/h", "km/h"), ("speed/km/h", "km/h"),
        ("speed km/h", "km/h"), ("speed in km/h", "km/h"), ("speed, km/h", "km/h"), ("speed: km/h", "km/h"),
        ("speed_in_km_h", "km/h"), ("km/h", "km/h"), ("mph", "mph"), ("speed in cm s-1", "cm s-1"),
        ("kmh_speed", "kmh"), ("km/h speed", "km/h"), ("speedKmh", "Kmh"), ("speedKMH", "KMH"),
        ("kmhSpeed", "kmh"), ("speedKmPerH", "km/h"), ("mph-of-the-wheel", "mph"), ("vehicleSpeedMph", "Mph"),
    ],
)  # fmt: skip # a table
def test_a_name_that_says_another_unit_than_the_input(tmp_path, name, said):
    assert noted(tmp_path, name, "m/s") == [
        f"{tmp_path / 'v.csv'}: column '{name}': its values are taken in [m/s], the unit of car.x; "
        f'`unit = "{said}"` in the stimulus converts them'
    ]


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("speed", "m/s"), ("speed_m_s", "m/s"), ("speed_mps", "m/s"), ("speed in m/s", "m/s"), ("m/s", "m/s"),
        ("speed_a", "m/s"), ("speed_h", "m/s"), ("speed [filtered]", "m/s"), ("speed_kmh", "km/h"),
        ("speed_kmh", ""), ("mass_m", "kg"), ("torque_m", "N.m"), ("torque_Nm", "N.m"), ("position_in", "m"),
        ("angle in", "rad"), ("position_y", "m"), ("current_a", "A"), ("voltage_v", "V"), ("power_w", "W"),
        ("ratio_2", "1"), ("soc_ref", "1"), ("motor_01", "1"), ("[km/h] m/s", "V"), ("", "m/s"),
        ("minSpeed", "s"), ("min_delay", "s"), ("m_position", "km"), ("positionM", "km"), ("mpsSpeed", "m/s"),
        ("speedRef", "m/s"), ("inPosition", "m"), ("wheelSpeed", "m/s"), ("MSpeed", "m/s"), ("motorMin", "s"),
    ],
)  # fmt: skip # a table
def test_a_name_that_says_no_other_unit(tmp_path, name, unit):
    assert noted(tmp_path, name, unit) == []


@pytest.mark.parametrize(
    ("name", "unit", "said"),
    [
        ("soc_percent", "1", "percent"),
        ("temp_degF", "degC", "degF"),
        ("angle_deg", "rad", "deg"),
        ("P kW", "W", "kW"),
    ],
)
def test_other_quantities(tmp_path, name, unit, said):
    (note,) = noted(tmp_path, name, unit)
    assert f'taken in [{unit}], the unit of car.x; `unit = "{said}"`' in note


@pytest.mark.parametrize("name", ["speed [m/s]", "speed_m_s", "speed_mph"])
def test_a_unit_that_contradicts_the_name_is_named_with_it(tmp_path, name):
    (note,) = noted(tmp_path, name, "m/s", given="km/h")
    said = {"speed_m_s": "m/s", "speed_mph": "mph"}.get(name, "m/s")
    assert note.endswith(
        f"column '{name}': its values are taken in [km/h], the `unit` of the stimulus, not [{said}]"
    )


def test_a_unit_that_the_name_has_too_is_no_warning(tmp_path):
    assert noted(tmp_path, "speed_km_h", "m/s", given="km/h") == []
    assert noted(tmp_path, "speed [kph]", "m/s", given="km/h") == []
    assert noted(tmp_path, "speed [m/s]", "", given="km/h") != []  # the input has no unit: the two are named


@pytest.mark.parametrize(("time", "said"), [("t [ms]", "ms"), ("time_us", "us"), ("time in min", "min")])
def test_a_column_of_times_in_another_unit(tmp_path, time, said):
    assert noted(tmp_path, "x", "m", time=time) == [
        f"{tmp_path / 'v.csv'}: column '{time}': its values are taken in [s], the unit of the time, "
        f"not [{said}]"
    ]
    assert noted(tmp_path, "x", "m", time="time_s") == []
