"""The table of names: pint's value for each; of all that pint knows, what is read is read alike."""

from __future__ import annotations

import functools
import math
import re

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.units.conversion import between
from evcosim.cosim.units.definition import by_text, defined
from evcosim.cosim.units.measure import BASE_UNITS, OpenUnitError, UnitOfMeasure, UnknownUnitError
from evcosim.cosim.units.names import DOUBTFUL, NAMES, doubt
from evcosim.cosim.units.symbols import is_level, symbol
from support.pints import errors, registry

SYMBOLS = {"kilogram": "kg", "meter": "m", "second": "s", "ampere": "A", "kelvin": "K", "mole": "mol"}
SYMBOLS |= {"candela": "cd", "radian": "rad"}
IN_PINT = {
    "US_gallon": "gallon", "US_quart": "quart", "US_fluid_ounce": "fluid_ounce",
    "US_liquid_ounce": "fluid_ounce", "US_liquid_pint": "US_pint", "survey_feet": "survey_foot",
    "cubic_inches": "cubic_inch", "gauss": "1e-4 tesla", "maxwell": "1e-8 weber", "curie": "3.7e10 / second",
    "mechanical_horsepower": "horsepower", "revolution_per_minute": "revolutions_per_minute",
    "revolution_per_second": "revolutions_per_second", "Nmm": "newton * millimeter",
    "Ncm": "newton * centimeter", "conventional_inHg": "inch_Hg", "conventional_inH2O": "249.08891 pascal",
    "inHg_60F": "inch_Hg_60F", "inH2O_60F": "inch_H2O_60F", "degRk": "degree_Rankine",
    "psf": "lbf / ft**2", "mH2O": "100 * cmH2O",
}  # fmt: skip # names that pint has not, or defines in other base units
OTHERWISE = {
    "G": "standard gravity or gauss; pint defines it in units of the CGS system", "gauss": "as G",
    "maxwell": "as G", "Gal": "a gallon in capitals; pint: galileo", "hbar": "a hectobar; pint: a constant",
    "\u210e": "h in plain characters; pint: a constant", "kG": "kg in capitals",
    "Nm": "newton meter; pint: a yarn", "Tt": "teratonne; pint: a yarn",
    "kmph": "km/h; pint: 1000 mph", "kMPH": "as kmph", "Min": "minutes; pint: megainches",
    "Msec": "ms in capitals; pint: megaseconds", "mcd": "millicandela; pint: a micro-day",
    "cfm": "cubic feet a minute; pint: 1e-17 m",
}  # fmt: skip # what is read otherwise, and why


def otherwise(text: str) -> bool:
    """Return True for a text of OTHERWISE, or for one with a prefix."""
    return text in OTHERWISE or text.endswith(("gauss", "maxwell", "Nm"))


def in_base_units(text: str) -> tuple[float, dict[str, float]] | None:
    """Return pint's factor of a unit in SI base units, and their exponents; None where pint has others."""
    try:
        zero, one = (registry().Quantity(x, text).to_base_units() for x in (0.0, 1.0))
    except (errors(), ArithmeticError, TypeError, ValueError, AttributeError):
        return None
    powers = {str(base): power for base, power in one.unit_items()}
    if not powers.keys() <= SYMBOLS.keys():
        return None
    return one.magnitude - zero.magnitude, {SYMBOLS[base]: power for base, power in powers.items()}


def same(unit: UnitOfMeasure, factor: float, powers: dict[str, float]) -> bool:
    """Return True for a reading that pint has too, but for the angle, which pint leaves out."""
    own = {base: e for base, e in zip(BASE_UNITS, unit.exponents or (), strict=False) if e and base != "rad"}
    angles = {2.0 * math.pi, 1.0} if unit.exponents[-1] else {1.0}
    return own == {b: e for b, e in powers.items() if e and b != "rad"} and any(
        math.isclose(unit.factor, factor * angle, rel_tol=1e-5) for angle in angles
    )


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_pints(name):
    unit = by_text(name)
    assert unit is not None and not unit.also
    amount = registry().Quantity(IN_PINT.get(name, name))
    factor, powers = in_base_units(str(amount.units))
    assert same(unit, factor * amount.magnitude, powers)


@functools.cache
def known_to_pint() -> list[str]:
    return sorted(set(dir(registry())) | set(registry()._units))


def test_of_all_that_pint_knows_what_is_read_is_read_alike():
    """Each of its names and aliases, or one of its readings, where the other end decides."""
    wrong, read = [], 0
    for name in known_to_pint():
        unit = by_text(name) if name.isidentifier() else None
        if unit is None or unit.logarithmic or (found := in_base_units(name)) is None:
            continue
        read += 1
        if not (otherwise(name) or any(same(reading, *found) for reading in unit.readings)):
            wrong.append((name, unit.dimension, unit.factor, found))
    assert wrong == []
    assert read > 250


@pytest.mark.parametrize("prefix", ["kilo", "micro", "mega", "k", "M", "m", "da", "c"])
def test_of_all_with_a_prefix_what_is_read_is_read_alike(prefix):
    wrong = []
    for name in known_to_pint():
        text = prefix + name
        unit = by_text(text) if text.isidentifier() and text not in registry()._units else None
        if unit is None or unit.logarithmic or (found := in_base_units(text)) is None:
            continue
        if not (otherwise(text) or any(same(reading, *found) for reading in unit.readings)):
            wrong.append((text, unit.dimension, unit.factor, found))
    assert wrong == []


@pytest.mark.parametrize("name", DOUBTFUL)
def test_a_doubtful_name_is_no_unit_and_the_message_says_why(name):
    with pytest.raises(UnknownUnitError) as caught:
        defined(name)
    assert str(caught.value) == f"unit of measure '{name}' is not known: {name} may be {DOUBTFUL[name]}"
    if len(name) > 2:  # U/s is a turn a second, and us a microsecond
        for text in (f"{name}/s", f"{name}s", f"kg.{name}2"):
            with pytest.raises(UnknownUnitError, match=f"is not known: {name}s? may be"):
                defined(text)
    assert doubt(["m", name]) == f": {name} may be {DOUBTFUL[name]}" and doubt(["m", "s"]) == ""


@pytest.mark.parametrize(
    ("text", "target"),
    [
        ("gal", "L"), ("gallon/h", "L/h"), ("quart", "L"), ("pint", "mL"), ("fluid_ounce", "mL"),
        ("oz", "g"), ("ounces", "g"), ("hp", "W"), ("HP", "kW"), ("horsepower", "W"), ("ton", "kg"),
        ("hundredweight", "kg"), ("cwt", "kg"), ("BTU/h", "W"), ("cal", "J"), ("kcal", "J"), ("calorie", "J"),
        ("therm", "J"), ("year", "s"), ("yr", "d"), ("grad", "rad"),
    ],
)  # fmt: skip # a table
def test_a_name_that_trades_and_countries_have_several_of_is_open(text, target):
    for ends in ((text, target), (target, text)):
        with pytest.raises(OpenUnitError, match="the text has several meanings"):
            between(*ends)
    assert between(text, text).identity


@pytest.mark.parametrize(
    ("text", "target", "factor"),
    [
        ("imperial_gallon", "L", 4.54609), ("US_gallons", "L", 3.785411784),
        ("mechanical_horsepower", "W", 745.69987158), ("metric_horsepower", "W", 735.49875),
        ("long_ton", "kg", 1016.0469088), ("troy_ounce", "g", 31.1034768), ("kilocal_th", "J", 4184.0),
        ("Btu_it", "J", 1055.05585262), ("thou", "mm", 0.0254), ("keV", "J", 1.602176634e-16),
        ("milliarcsecond", "rad", math.pi / 648e6), ("kilotonne", "kg", 1e6), ("centistokes", "mm2/s", 1.0),
        ("kvar", "W", 1000.0), ("cmH2O", "Pa", 98.0665), ("kt", "m/s", 1852 / 3600), ("kt", "kg", 1e6),
        ("micromole", "mol", 1e-6), ("weeks", "d", 7.0),
    ],
)  # fmt: skip # a table
def test_names_that_are_one_unit_convert(text, target, factor):
    assert between(text, target).scale == pytest.approx(factor, rel=1e-7)


@pytest.mark.parametrize(
    "text", ["alpha", "pi", "standard_gravity", "g0", "speed_of_light", "avogadro_number", "ct", "at",
             "count", "bit", "circle", "zeta", "statfarad", "Bi", "degree_day", "of_mine",
             "m0", "kg^0"]
)  # fmt: skip # a list
def test_constants_and_what_nobody_has_reviewed_are_no_units(text):
    assert by_text(text) is None
    with pytest.raises(ConfigError):
        between(text, "1")


def test_nothing_of_the_tables_is_doubtful():
    assert not {name for name in DOUBTFUL if name in NAMES or symbol(name) or is_level(name)}


WRITTEN = """
permille = ‰, per mille, Promille, permil
ppm = PPM, ppm
percent = Prozent, per cent
liter / (100 * kilometer) = l/100km, L/100km, L/100 km, l / 100 km, l/(100 km), L/(100km), l per 100km
liter / (100 * kilometer) = liters per 100 km
kilowatt_hour / (100 * kilometer) = kWh/100km, kWh/100 km, KWH/100KM, kWh/(100 km), kW h/100km
watt_hour / kilometer = Wh/km, W h/km, WH/KM, W·h/km
volt / (1000 * revolutions_per_minute) = V/krpm, V/kRPM, V/1000rpm, V/1000 rpm, V/(1000 rpm)
radian = Rad, RAD, rad
radian / second = RAD/S, Rad/s, rad/S, rad s-1, rad per second
degree / second = DEG/S, Deg/s, dps, degrees per second
meter / second = m s-1, m s^-1, m·s⁻¹, m•s-1, m*s^-1, M/S, m/S, m per s, meters per second
meter / second ** 2 = m s-2, M/S2, m/s^2, m/s², M/S², m/s/s, m / s2
newton * meter = N m, N·m, N*m, N.m, NM, N⋅m, N-m
newton * meter * second = N m s, Nm s
newton * second / meter = Ns/m, N s/m, N*s/m, N·s/m
kilogram * meter ** 2 = kgm2, kgm^2, kgm², kg m2, kg m², kg*m^2, KGM2, kgm**2
kilogram * meter ** 2 / second = kgm2/s, kg m2/s, kg m2 s-1
hour = hrs, HRS, Hrs, Stunden
knot = kts, KTS, knots, KNOTS, Knots, KT
volt = VDC, V DC
liter / minute = lpm, LPM, l/min, L per min
foot ** 3 / minute = cfm, CFM, cubic feet per minute
centimeter ** 3 = ccm, CCM, cc
centimeter ** 3 / minute = ccm
psi = psia, PSI, lb/in2, lb/in², LBS/IN2
torr = Torr, TORR, torr
millitorr = mTorr
hectopascal = HPA, hPA, hpa, HPa
kilopascal = KPA, kpa, KPa
megapascal = Mpa
pascal = PA, Pa
foot * force_pound = ft lb, ft-lb, ft·lb, lb·ft, lb ft, FT-LB, ft-lbf, lbf-ft, foot pound
inch * force_pound = in lb, in-lb, lb-in, IN-LBS
milligram = mg
standard_gravity / 1000 = mg
standard_gravity = g's, G's
watt / (meter * kelvin) = W/mK, W/(m K), W/m·K, W/(m·K), W m-1 K-1
watt / (meter ** 2 * kelvin) = W/m2K, W/m²K, W/(m2 K)
joule / (kilogram * kelvin) = J/kgK, J/(kg K), J/kg K, J kg-1 K-1
kilogram_force / centimeter ** 2 = kg/cm2, kg/cm², kgf/cm2, kp/cm2
pascal * second = Pas, Pa s
millipascal * second = mPas, mPa s
nautical_mile = nautical mile, Nautical Mile, nautical miles
gallon = US gallon
mile / hour = miles per hour, MPH
degree = deg., Deg, DEG
kelvin = deg K, degrees Kelvin
volt * ampere = VA, V A
kilovolt * ampere = KVA, kVA, kva
newton * millimeter = Nmm
foot * force_pound = lbft, ftlbf, ftlbs, lbfft, LBFT
inch * force_pound = inlb, inlbf, lbf-in, lbin, inlbs
mmHg = mm Hg, mmHg
cmHg = cm Hg, cmHg
100 * cmH2O = mH2O, m H2O
cmH2O / 10 = mm H2O, mmH2O
force_pound / foot ** 2 = psf, lbf/ft2
microohm = µOhm, μOhm, uOhm, µOhms
milliohm = mOhms
revolution / minute = rot/min, ROT/MIN
millidegree = mdeg, millidegrees
millidegree / second = mdeg/s, mdps
kelvin = °K, ° K, deg.K
"""
"""A unit as pint has it, and how people write it."""
PAIRS = [
    (meant, text)
    for meant, _, texts in (line.partition(" = ") for line in WRITTEN.strip().splitlines())
    for text in texts.split(", ")
]


@pytest.mark.parametrize(("meant", "text"), PAIRS)
def test_what_people_write_is_what_pint_makes_of_what_they_mean(meant, text):
    """One reading is it: beside those of other quantities, which the other end of a connection rules out."""
    amount = registry()(meant)
    factor, powers = in_base_units(str(amount.units))
    factor *= amount.magnitude
    unit = by_text(text)
    assert unit is not None and any(same(reading, factor, powers) for reading in unit.readings)
    alike = [r for r in unit.readings if r.exponents == unit.exponents]
    assert len(alike) == 1  # it is open between quantities at most


@pytest.mark.parametrize(
    ("text", "target"),
    [
        ("MPA", "bar"), ("mpa", "Pa"), ("MHZ", "Hz"), ("mhz", "1/min"), ("MWH", "kWh"), ("MAH", "A.h"),
        ("MBAR", "Pa"), ("MOHM", "ohm"), ("rps", "rpm"), ("rps", "Hz"), ("mpg", "km/L"), ("gpm", "L/min"),
        ("inHg", "kPa"), ("inH2O", "Pa"), ("US_quart", "L"), ("US pint", "L"), ("qt", "L"),
    ],
)  # fmt: skip # a table
def test_what_may_be_two_sizes_of_one_quantity_is_open(text, target):
    for ends in ((text, target), (target, text)):
        with pytest.raises(OpenUnitError, match="the text has several meanings"):
            between(*ends)


@pytest.mark.parametrize(
    ("text", "said"),
    [("mv", "MV or mV"), ("MM", "Mm or mm"), ("ma", "MA or mA"), ("kj", "kJ"), ("KNM/s", "kNm"), ("w", "W")],
)
def test_an_unknown_name_that_other_capitals_make_known_is_said(text, said):
    with pytest.raises(UnknownUnitError, match=f"capitals count, and .* may be .*{said}"):
        defined(text)


def test_a_capital_inside_a_name_makes_another_one():
    assert by_text("microN") is None
    assert by_text("Micron").factor == by_text("MICRON").factor == 1e-6
    assert by_text("MmH2O") is None


@pytest.mark.parametrize("letter", "CF")
@pytest.mark.parametrize(
    "degree", ["° ", "°", "º ", "°  ", "deg.", "Deg.", "DEG.", "Deg. ", "deg ", "deg-", "°.", "Deg", "[° "]
)
def test_a_degree_sign_apart_from_its_letter_is_a_scale_of_temperature(degree, letter):
    text = degree + letter + ("]" if "[" in degree else "")
    assert between(text, f"deg{letter}").identity and between(f"W/{degree.strip('[')}{letter}", "W/K").scale
    assert between(text, "K") == between(f"deg{letter}", "K")


@pytest.mark.parametrize("text", ["deg*C", "deg/C", "deg Cm", "°/s C"])
def test_another_sign_between_them_makes_no_temperature(text):
    with pytest.raises(ConfigError):
        between(text, "K")


@pytest.mark.parametrize(
    ("text", "product"),
    [("W/m^2-K", "W/m^2.K"), ("kg-m2", "kg.m2"), ("kN-m", "kN.m"), ("W/(m-K)", "W/(m.K)")],
)
def test_a_hyphen_for_a_product_is_refused_with_how_it_is_written(text, product):
    with pytest.raises(UnknownUnitError, match=re.escape(f"where '-' is a product write {product}")):
        defined(text)
    assert by_text(product) is not None


def test_in_hg_apart_is_open_as_in_one_word():
    with pytest.raises(OpenUnitError, match="the text has several meanings"):
        between("in Hg", "kPa")
