"""Everyday spellings of units of measure, each with what it means and where it is met.

A meaning is in the symbols of `symbols` and the grammar of `grammar`; where a spelling has two, they are
separated by "|", the usual one first, and the unit at the other end of the connection decides. Most files
are of commaai/opendbc (MIT), a collection of CAN databases; a source names one of those that have it.
"""

from __future__ import annotations

import re

from .grammar import plain
from .words import WORDS, Row

EXACT: tuple[Row, ...] = (
    ("C", "degC | C", "bmw_e9x_e8x.dbc (Celsius); SI: coulomb"),
    ("F", "degF | F", "hyundai_2015_mcan.dbc (Fahrenheit); SI: farad"),
    ("g", "gn | g", "hyundai_can.dbc (acceleration); SI: gram"),
    ("G", "gn | gauss", "toyota_2017_ref_pt.dbc (acceleration); gauss"),
    ("Grad", "deg", "German: degree of angle; vw_pq.dbc: Grad/sec"),
    ("grad", "deg | gon", "gm_global_a_powertrain.dbc: grad/s (degree); ISO 80000-3 (gon)"),
    ("ton", "t | short_ton | long_ton", "the metric ton; NIST SP 811: ton, short (2000 lb), long (2240 lb)"),
    ("tons", "t | short_ton | long_ton", "plural of ton"),
    ("kt", "kn | kt", "knot; SI brochure: kilotonne"),
    ("cal", "cal_th | cal_it", "NIST SP 811: thermochemical; International Table"),
    ("calorie", "cal_th | cal_it", "as cal"),
    ("kcal", "kilocal_th | kilocal_it", "as cal"),
    ("kilocalorie", "kilocal_th | kilocal_it", "as cal"),
    ("calories", "cal_th | cal_it", "as cal"),
    ("NM", "Nm", "chrysler_pacifica_2017_hybrid.dbc"),
    ("nM", "Nm", "nissan_xterra_2011.dbc"),
    ("Km", "km", "as KW"),
    ("KM", "km", "as KW"),
    ("KN", "kN | kn", "as KW; knots in capitals"),
    ("KT", "kn | kt", "as kt"),
    ("inHg", "inHg | inHg_60F", "NIST SP 811: conventional; at 60 degF"),
    ("inH2O", "inH2O | inH2O_60F", "as inHg"),
    ("in Hg", "inHg | inHg_60F", "as inHg"),
    ("in H2O", "inH2O | inH2O_60F", "as inHg"),
    ("mm Hg", "mmHg", "NIST SP 811: millimeter of mercury"),
    ("cm Hg", "cmHg", "as mm Hg"),
    ("mm H2O", "mmH2O", "NIST SP 811: millimeter of water"),
    ("cm H2O", "cmH2O", "as mm H2O"),
    ("m H2O", "mH2O", "as mm H2O"),
    ("mg", "mg | ‰.gn", "SI: milligram; thousandths of gravity"),
    ("g's", "gn", "gravities"),
    ("G's", "gn", "gravities"),
    ("PA", "Pa | PA", "capitals: pascal; as written"),
    ("1/S", "1/s | 1/S", "capitals: second; SI: siemens"),
    ("%/S", "%/s | %/S", "as 1/S"),
    ("A/S", "A/s | A/S", "as 1/S"),
    ("V/S", "V/s | V/S", "as 1/S"),
    ("MPA", "MPa | mPa", "capitals: mega or milli"),
    ("mpa", "MPa | mPa", "small letters: mega or milli"),
    ("mhz", "MHz | mHz", "as mpa"),
    ("MWH", "MWh | mWh", "as MPA"),
    ("mwh", "MWh | mWh", "as mpa"),
    ("MAH", "mAh | MAh", "as MPA"),
    ("mah", "mAh | MAh", "as mpa"),
    ("MBAR", "mbar | Mbar", "as MPA"),
    ("MOHM", "Mohm | mohm", "as MPA"),
    ("mTorr", "millitorr", "SI prefix"),
    ("mtorr", "millitorr", "SI prefix"),
    ("kp", "kgf", "German: Kilopond"),
    ("KP", "kgf", "as kp"),
    ("Pas", "Pa.s", "without a sign for the product"),
    ("mPas", "mPa.s", "as Pas"),
    ("W/mK", "W/(m.K) | W/mK", "as Pas; as written"),
    ("W/(mK)", "W/(m.K) | W/mK", "as W/mK"),
    ("W/m2K", "W/(m2.K)", "as Pas"),
    ("W/(m2K)", "W/(m2.K)", "as Pas"),
    ("J/kgK", "J/(kg.K)", "as Pas"),
    ("J/(kgK)", "J/(kg.K)", "as Pas"),
    ("kJ/kgK", "kJ/(kg.K)", "as Pas"),
    ("kJ/(kgK)", "kJ/(kg.K)", "as Pas"),
    ("Mpa", "MPa", "toyota_2017_ref_pt.dbc"),
    ("Mhz", "MHz", "as Mpa"),
    ("MHZ", "MHz | mHz", "as MPA"),
    ("mOhm", "mohm", "as Ohm"),
    ("MOhm", "Mohm", "as Ohm"),
    ("uOhm", "uohm", "as Ohm"),
    ("µOhm", "uohm", "as Ohm"),
    ("nOhm", "nohm", "as Ohm"),
    ("mOhms", "mohm", "as Ohms"),
    ("MOhms", "Mohm", "as Ohms"),
    ("uOhms", "uohm", "as Ohms"),
    ("µOhms", "uohm", "as Ohms"),
    ("mdeg", "‰.deg", "SI prefix"),
    ("millidegree", "‰.deg", "SI prefix"),
    ("millidegrees", "‰.deg", "SI prefix"),
    ("mdps", "‰.deg/s", "as dps"),
    ("mBar", "mbar", "as Bar"),
    ("Unit_Volt", "V", "vw_mqb.dbc"),
    ("Unit_MilliVolt", "mV", "vw_mlb.dbc"),
    ("Unit_Amper", "A", "vw_mqb.dbc"),
    ("Unit_MilliAmper", "mA", "_vw_meb_common.dbc"),
    ("Unit_AmperHour", "Ah", "_vw_meb_common.dbc"),
    ("Unit_Ohm", "ohm", "vw_mqb.dbc"),
    ("Unit_Watt", "W", "vw_mqb.dbc"),
    ("Unit_KiloWatt", "kW", "vw_mqb.dbc"),
    ("Unit_WattHour", "Wh", "_vw_meb_common.dbc"),
    ("Unit_Hertz", "Hz", "vw_mqb.dbc"),
    ("Unit_MinutInver", "1/min", "vw_mqb.dbc"),
    ("Unit_NewtoMeter", "Nm", "vw_mqb.dbc"),
    ("Unit_centiNewtoMeter", "cN.m", "vw_mqb.dbc"),
    ("Unit_NewtoMeterPerSecon", "Nm/s", "vw_mqb.dbc"),
    ("Unit_KiloNewto", "kN", "vw_mqb.dbc"),
    ("Unit_KiloGram", "kg", "vw_mqb.dbc"),
    ("Unit_KiloGramMeterSquar", "kg.m2", "vw_mqb.dbc"),
    ("Unit_GramPerLiter", "g/L", "vw_mqb.dbc"),
    ("Unit_Secon", "s", "vw_mqb.dbc"),
    ("Unit_MilliSecon", "ms", "vw_mqb.dbc"),
    ("Unit_Minut", "min", "vw_mqb.dbc"),
    ("Unit_Hours", "h", "vw_mqb.dbc"),
    ("Unit_Day", "d", "vw_mqb.dbc"),
    ("Unit_Meter", "m", "vw_mqb.dbc"),
    ("Unit_MilliMeter", "mm", "vw_mqb.dbc"),
    ("Unit_Centimeter", "cm", "_vw_meb_common.dbc"),
    ("Unit_KiloMeter", "km", "vw_mqb.dbc"),
    ("Unit_KiloMeterPerHour", "km/h", "vw_mqb.dbc"),
    ("Unit_KilometerPerHour", "km/h", "vw_meb.dbc"),
    ("Unit_MeterPerSecon", "m/s", "vw_mlb.dbc"),
    ("Unit_MeterPerSecond", "m/s", "_vw_meb_common.dbc"),
    ("Unit_MeterPerSeconSquar", "m/s2", "vw_mqb.dbc"),
    ("Unit_MeterPerSquareSecond", "m/s2", "_vw_meb_common.dbc"),
    ("Unit_MeterPerCubicSecon", "m/s3", "vw_mqb.dbc"),
    ("Unit_ForceOfGravi", "gn", "vw_mqb.dbc"),
    ("Unit_PerCentOfForceOfGravi", "%.gn", "vw_mqb.dbc"),
    ("Unit_DegreOfArc", "deg", "vw_mqb.dbc"),
    ("Unit_DegreeOfArc", "deg", "vw_pq.dbc"),
    ("Unit_DegreOfArcPerSecon", "deg/s", "vw_mqb.dbc"),
    ("Unit_DegreePerSecond", "deg/s", "_vw_meb_common.dbc"),
    ("Unit_rad/m", "rad/m", "_vw_meb_common.dbc"),
    ("Unit_DegreCelsi", "degC", "vw_mqb.dbc"),
    ("Unit_Bar", "bar", "vw_mqb.dbc"),
    ("Unit_MilliBar", "mbar", "vw_mqb.dbc"),
    ("Unit_BarPerSecon", "bar/s", "vw_mqb.dbc"),
    ("Unit_Liter", "L", "vw_mqb.dbc"),
    ("Unit_MilliLiter", "mL", "vw_mqb.dbc"),
    ("Unit_MicroLiter", "uL", "vw_mqb.dbc"),
    ("Unit_Lux", "lx", "_vw_meb_common.dbc"),
    ("Unit_PerCent", "%", "vw_mqb.dbc"),
    ("Unit_Percent", "%", "vw_meb.dbc"),
    ("Unit_PerCentPerSecon", "%/s", "vw_mqb.dbc"),
)
"""Spellings that are read as they stand."""

NO_UNIT = (
    "",
    "1",
    "-",
    "--",
    "none",
    "None",
    "NONE",
    "unitless",
    "Unitless",
    "dimensionless",
    "Unit_None",
    "N/A",
)
"""Texts that say that there is no unit: the unit 1 (psa_aee2010_r3.dbc, ford_lincoln_base_pt.dbc)."""

_BRACKETS = re.compile(r"\[(.*)\]|\((.*)\)")
_SPACED = re.compile(r"\s*([*/.^()])\s*")
_POWER = re.compile(r"(?:\^|\*\*)(?=[-+]?\d)")


def _key(text: str) -> str:
    """Return a text as it is looked up: "m / s^2" as "m/s2", "deg_C" as "deg C", "ft*lb" as "ft.lb"."""
    return (
        _POWER.sub("", _SPACED.sub(r"\1", plain(text))).replace("*", ".").replace("_", " ").removesuffix(".")
    )


_EXACT = {_key(spelling): meaning for spelling, meaning, _ in EXACT}
_WORDS = {_key(spelling).casefold(): meaning for spelling, meaning, _ in WORDS}


def says_none(text: str) -> bool:
    """Return True for a text that says that there is no unit, also in brackets: "[-]"."""
    text = text.strip()
    found = _BRACKETS.fullmatch(text)
    return text in NO_UNIT or (found is not None and (found[1] or found[2] or "").strip() in NO_UNIT)


def meanings(text: str) -> tuple[str, ...]:
    """Return the meanings of a spelling in plain characters, the usual one first; none for another text."""
    key = _key(text)
    found = _EXACT.get(key) or _WORDS.get(key.casefold(), "")
    return tuple(part.strip() for part in found.split("|")) if found else ()
