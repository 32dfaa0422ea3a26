"""The names of units that are no symbols of the SI, each reviewed: one value whatever the trade and country.

A name whose values in use differ by more than 0.01 % is not here: it has several meanings in `spellings`, or
is among DOUBTFUL, which nobody can convert. Sources: NIST SP 811 (2008), appendix B; the international yard
and pound agreement (1959); the UK Units of Measurement Regulations (1995); CODATA 2022 for the dalton. A test
compares each with pint, and what pint knows beside them is refused.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

_FOOT, _POUND = Fraction("0.3048"), Fraction("0.45359237")
_DAY = 86_400
_GRAIN = _POUND / 7000
_IMPERIAL = Fraction("4.54609")  # gallon [L]

NAMES: dict[str, tuple[Fraction | int, str]] = {
    # time and angle
    "week": (7 * _DAY, "s"), "fortnight": (14 * _DAY, "s"), "julian_year": (_DAY * 1461 // 4, "s"),
    "common_year": (365 * _DAY, "s"),
    "arcminute": (Fraction(1, 60), "deg"), "arcmin": (Fraction(1, 60), "deg"),
    "arc_minute": (Fraction(1, 60), "deg"), "angular_minute": (Fraction(1, 60), "deg"),
    "arcsecond": (Fraction(1, 3600), "deg"), "arcsec": (Fraction(1, 3600), "deg"),
    "arc_second": (Fraction(1, 3600), "deg"), "angular_second": (Fraction(1, 3600), "deg"),
    "arcdegree": (1, "deg"), "angular_degree": (1, "deg"), "gradian": (1, "gon"),
    "krpm": (1000, "rpm"),
    "revolutions_per_minute": (1, "rpm"), "revolution_per_minute": (1, "rpm"),
    "revolutions_per_second": (60, "rpm"), "revolution_per_second": (60, "rpm"),
    # length
    "micron": (1, "um"), "angstrom": (Fraction(1, 10), "nm"), "ångström": (Fraction(1, 10), "nm"),
    "Å": (Fraction(1, 10), "nm"), "thou": (Fraction(1, 1000), "in"), "yard": (1, "yd"),
    "international_inch": (1, "in"), "international_foot": (1, "ft"), "international_feet": (1, "ft"),
    "international_yard": (1, "yd"), "international_mile": (1, "mi"),
    "survey_foot": (Fraction(1200, 3937), "m"), "survey_feet": (Fraction(1200, 3937), "m"),
    "survey_mile": (Fraction(5280 * 1200, 3937), "m"),
    "nautical_mile": (1852, "m"), "nmi": (1852, "m"), "astronomical_unit": (149_597_870_700, "m"),
    "light_year": (9_460_730_472_580_800, "m"), "lightyear": (9_460_730_472_580_800, "m"),
    # area and volume
    "are": (Fraction(1, 100), "ha"), "hectare": (1, "ha"), "acre": (Fraction("0.40468564224"), "ha"),
    "square_foot": (_FOOT**2 / 10_000, "ha"), "square_feet": (_FOOT**2 / 10_000, "ha"),
    "square_inch": (_FOOT**2 / 1_440_000, "ha"), "square_inches": (_FOOT**2 / 1_440_000, "ha"),
    "square_yard": (_FOOT**2 * 9 / 10_000, "ha"), "square_mile": (_FOOT**2 * 5280**2 / 10_000, "ha"),
    "cubic_foot": (_FOOT**3 * 1000, "L"), "cubic_feet": (_FOOT**3 * 1000, "L"),
    "cubic_inch": (_FOOT**3 * 1000 / 1728, "L"), "cubic_inches": (_FOOT**3 * 1000 / 1728, "L"),
    "cubic_yard": (_FOOT**3 * 27_000, "L"), "cubic_centimeter": (1, "mL"), "cc": (1, "mL"),
    "US_gallon": (1, "gal"), "US_liquid_gallon": (1, "gal"), "US_liquid_quart": (Fraction(1, 4), "gal"),
    "US_dry_quart": (Fraction("67.200625") * _FOOT**3 * 1000 / 1728, "L"),
    "US_dry_pint": (Fraction("33.6003125") * _FOOT**3 * 1000 / 1728, "L"),
    "US_liquid_pint": (Fraction(1, 8), "gal"), "US_fluid_ounce": (Fraction(1, 128), "gal"),
    "US_liquid_ounce": (Fraction(1, 128), "gal"), "oil_barrel": (42, "gal"), "oil_bbl": (42, "gal"),
    "imperial_gallon": (_IMPERIAL, "L"), "UK_gallon": (_IMPERIAL, "L"),
    "imperial_quart": (_IMPERIAL / 4, "L"), "UK_quart": (_IMPERIAL / 4, "L"),
    "imperial_pint": (_IMPERIAL / 8, "L"), "UK_pint": (_IMPERIAL / 8, "L"),
    "imperial_fluid_ounce": (_IMPERIAL / 160, "L"), "UK_fluid_ounce": (_IMPERIAL / 160, "L"),
    # speed
    "knot": (1, "kn"), "international_knot": (1, "kn"), "mile_per_hour": (1, "mph"),
    "kilometer_per_hour": (1, "kph"), "foot_per_second": (_FOOT * Fraction(18, 5), "kph"),
    "fps": (_FOOT * Fraction(18, 5), "kph"), "meter_per_second": (Fraction(18, 5), "kph"),
    "mps": (Fraction(18, 5), "kph"),
    # mass
    "metric_ton": (1, "t"), "pound": (1, "lb"), "avdp_pound": (1, "lb"), "avoirdupois_pound": (1, "lb"),
    "avdp_ounce": (Fraction(1, 16), "lb"), "avoirdupois_ounce": (Fraction(1, 16), "lb"),
    "troy_ounce": (480 * _GRAIN, "kg"), "ozt": (480 * _GRAIN, "kg"), "troy_pound": (5760 * _GRAIN, "kg"),
    "grain": (_GRAIN, "kg"), "carat": (200, "mg"), "stone": (14, "lb"),
    "slug": (_POUND * Fraction("9.80665") / _FOOT, "kg"),
    "long_ton": (2240, "lb"), "UK_ton": (2240, "lb"), "US_ton": (2000, "lb"),
    "long_hundredweight": (112, "lb"), "UK_hundredweight": (112, "lb"),
    "short_hundredweight": (100, "lb"), "US_hundredweight": (100, "lb"),
    "dalton": (Fraction("1.66053906892e-27"), "kg"), "Da": (Fraction("1.66053906892e-27"), "kg"),
    # force and pressure
    "Nmm": (Fraction(1, 1000), "Nm"), "Ncm": (Fraction(1, 100), "Nm"),
    "kilogram_force": (1, "kgf"), "gram_force": (Fraction(1, 1000), "kgf"),
    "pond": (Fraction(1, 1000), "kgf"), "gf": (Fraction(1, 1000), "kgf"),
    "metric_ton_force": (1000, "kgf"), "pound_force": (1, "lbf"),
    "force_pound": (1, "lbf"), "force_kilogram": (1, "kgf"), "ounce_force": (Fraction(1, 16), "lbf"),
    "ozf": (Fraction(1, 16), "lbf"), "kip": (1000, "lbf"), "long_ton_force": (2240, "lbf"),
    "short_ton_force": (2000, "lbf"), "poundal": (_POUND * _FOOT, "N"), "pdl": (_POUND * _FOOT, "N"),
    "dyne": (Fraction(1, 100_000), "N"), "dyn": (Fraction(1, 100_000), "N"),
    "atmosphere": (1, "atm"), "standard_atmosphere": (1, "atm"),
    "technical_atmosphere": (Fraction("98066.5"), "Pa"),
    "torr": (Fraction(101_325, 760), "Pa"), "barye": (Fraction(1, 10), "Pa"), "ksi": (1000, "psi"),
    "mmH2O": (Fraction(1, 10), "cmH2O"), "mH2O": (100, "cmH2O"), "cmHg": (10, "mmHg"),
    "psf": (Fraction(1, 144), "psi"), "conventional_inHg": (1, "inHg"), "conventional_inH2O": (1, "inH2O"),
    "inHg_60F": (Fraction("3376.85"), "Pa"), "inH2O_60F": (Fraction("248.84"), "Pa"),
    "kip_per_square_inch": (1000, "psi"), "pound_force_per_square_inch": (1, "psi"),
    # energy and power
    "erg": (Fraction(1, 10**7), "J"), "foot_pound": (_FOOT * _POUND * Fraction("9.80665"), "J"),
    "footpound": (_FOOT * _POUND * Fraction("9.80665"), "J"), "cal_th": (Fraction("4.184"), "J"),
    "thermochemical_calorie": (Fraction("4.184"), "J"), "cal_it": (Fraction("4.1868"), "J"),
    "international_calorie": (Fraction("4.1868"), "J"), "Btu_it": (Fraction("1055.05585262"), "J"),
    "international_british_thermal_unit": (Fraction("1055.05585262"), "J"),
    "Btu_th": (_POUND * 1000 * Fraction("4.184") * Fraction(5, 9), "J"),
    "thermochemical_british_thermal_unit": (_POUND * 1000 * Fraction("4.184") * Fraction(5, 9), "J"),
    "EC_therm": (105_505_600, "J"), "US_therm": (105_480_400, "J"),
    "mechanical_horsepower": (1, "hp"), "metric_horsepower": (1, "PS"), "electrical_horsepower": (746, "W"),
    # the rest
    "gauss": (Fraction(1, 10_000), "T"), "maxwell": (Fraction(1, 10**8), "Wb"), "mho": (1, "S"),
    "poise": (100, "cP"), "stokes": (100, "cSt"), "curie": (37 * 10**9, "Bq"),
    "rem": (Fraction(1, 100), "Sv"), "permille": (Fraction(1, 10), "%"), "strain": (100, "%"),
    "degree_Rankine": (Fraction(5, 9), "K"), "rankine": (Fraction(5, 9), "K"),
    "degRk": (Fraction(5, 9), "K"),
}  # fmt: skip # related units side by side
"""Names with a factor and a symbol; in the plural, and with a prefix that is written out, too."""

DOUBTFUL = {
    "mil": "1/6400 or 1/6000 of a turn, or 1/1000 inch",
    "barrel": "of oil, of beer or of dry goods, US or imperial",
    "bbl": "a barrel of oil, of beer or of dry goods",
    "league": "3 miles on land or at sea", "chain": "66 or 100 ft", "link": "0.66 or 1 ft",
    "rod": "16.5 ft of the US, or another country's", "perch": "a length, an area or a volume",
    "pole": "16.5 ft of the US, or another country's", "cup": "US, imperial or metric",
    "furlong": "660 ft of US surveys, or international ones",
    "fathom": "6 ft of US surveys, or international ones",
    "tablespoon": "US, imperial or metric", "teaspoon": "US, imperial or metric", "gill": "US or imperial",
    "bushel": "US or imperial", "peck": "US or imperial", "hogshead": "US or imperial",
    "minim": "US or imperial",
    "dram": "a mass or a volume", "gr": "a gram or a grain", "quarter": "of a ton or of a hundredweight",
    "month": "28 to 31 days", "a": "a year or an are", "grade": "a gon or a slope",
    "point": "1/72 inch, or one of another typography", "pt": "a pint, a point or 1/100 carat",
    "ton_force": "of 2000 lb, 2240 lb or 1000 kg", "force_ton": "of 2000 lb, 2240 lb or 1000 kg",
    "refrigeration_ton": "of the US or of Japan", "degR": "Rankine, Réaumur or Rømer",
    "toe": "41.868 GJ, or another agency's", "tonne_of_oil_equivalent": "41.868 GJ, or another agency's",
    "tsp": "US, imperial or metric", "tbsp": "US, imperial or metric",
    "ppb": "1e-9, or 1e-12 where a billion is that", "ADC": "a direct current or counts of a converter",
    "scfm": "at one of several standard temperatures", "sccm": "at one of several standard temperatures",
    "slpm": "at one of several standard temperatures", "atü": "a pressure above that of the air",
    "Cal": "4.184 or 4184 J", "Calorie": "4.184 or 4184 J", "candle": "a candela, or an older one",
    "U": "a turn or a unit of enzymes", "u": "an atomic mass", "M": "molar, or a prefix",
    "P": "poise, or a prefix", "R": "röntgen, Rankine or Réaumur", "B": "a bel or a byte",
    "b": "a barn or a bit", "mb": "a millibar or a millibarn", "D": "a debye or a day",
    "c": "the speed of light, or a prefix", "e": "a charge", "k": "a prefix, or Boltzmann's constant",
}  # fmt: skip # several in a line
"""Names that are read as no unit, and what they may be."""


def doubt(names: Iterable[str]) -> str:
    """Return what the first doubtful one of some names may be, as a sentence to append; "" without one."""
    for name in names:
        for known in (name, name.removesuffix("s")):
            if known in DOUBTFUL:
                return f": {name} may be {DOUBTFUL[known]}"
    return ""
