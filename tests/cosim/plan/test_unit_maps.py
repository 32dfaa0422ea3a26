"""The map between two ends of a connection: what is converted, what is warned of, what is refused."""

from __future__ import annotations

import dataclasses
import re

import pytest

from evcosim.cosim.can.database import Signal
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.unit_maps import End, check_texts, converts, scaled_map, unit_map, with_unit
from evcosim.cosim.system.scaling import Scaling
from evcosim.cosim.units.measure import Affine, UnitOfMeasure

NONE, SPEED, RATE = (0,) * 8, (0, 1, -1, 0, 0, 0, 0, 0), (0, 0, -1, 0, 0, 0, 0, 0)


def made(source, target, *others):
    """The map between two ends and the warnings."""
    warnings: list[str] = []
    ends = [
        end if isinstance(end, End) else End(name, end)
        for name, end in zip("ab", (source, target), strict=True)
    ]
    return unit_map(*ends, others, "here", warnings), warnings


@pytest.mark.parametrize(
    ("source", "target", "map_"),
    [
        ("km/h", "m/s", Affine(5 / 18)),
        ("Hz", "rad/s", Affine(6.283185307179586)),
        ("degC", "K", Affine(1.0, 273.15)),
        ("RPM", "RPM", Affine()),
        ("gibberish", "gibberish", Affine()),
        ("", "", Affine()),
        ("", "1", Affine()),
    ],
)
def test_what_is_converted(source, target, map_):
    assert made(source, target) == (map_, [])


@pytest.mark.parametrize(
    ("source", "target", "warning"),
    [
        ("", "m/s", "a declares no unit of measure; it is taken as [m/s]"),
        ("V", " ", "b declares no unit of measure; it is taken as [V]"),
        ("gibberish", "", "b declares no unit of measure; it is taken as [gibberish]"),
        ("count", "1", "a [count]: this unit of measure is not known; it is taken as [1]"),
        ("1", "#", "b [#]: this unit of measure is not known; it is taken as [1]"),
        ("-", "1", "a [-] names no unit of measure; it is taken as [1]"),
    ],
)
def test_what_is_warned_of(source, target, warning):
    assert made(source, target) == (Affine(), [warning])


@pytest.mark.parametrize("text", ["#", "??", "€", "V(", "9**9**9**9", "count", "x" * 999])
@pytest.mark.parametrize("turned", [False, True])
def test_an_unknown_unit_is_refused_against_a_dimension(text, turned):
    ends = [End("can0.M.S", text, bus="can0"), End("b.u", "V")]
    with pytest.raises(ConfigError, match=r"^here: .* cannot feed .* is not known; say what it is") as error:
        made(*(reversed(ends) if turned else ends))
    assert f'[buses.can0.units]: "{text}" = "V"' in str(error.value)


def test_other_refusals_and_their_ways_out():
    for source, target, said in (
        ("m/s", "K", r"a \[m/s\] cannot feed b \[K\]: .* measure different quantities$"),
        ("tbd", "%", "is not known; say what a is in: `unit`"),
        ("1/s", "rpm", "may count turns .* or radians .*; say what a is in"),
        (End("c.M.S", "1/s", bus="c"), "rpm", r'\[buses.c.units\]: "1/s" = "rpm"$'),
        (End("c.M.S", "-", bus="c"), "V", r'\[buses.c.units\]: "-" = "V"$'),
        (End("c.M.S", "dB", bus="c"), "1", "is logarithmic, and converts to nothing but itself$"),
    ):
        with pytest.raises(ConfigError, match=said):
            made(source, target)


OWN = End("the stimulus of b.u", "tbd", advice="say what it is in: its own `unit`")
ON_BUS = r'say what it is in the system file, \[buses.c.units\]: "{}" = "{}"'
OF_MAP = "say what {} is in: `unit` in the unit's `map`"


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("one", "other", "advice"),
    [
        # unknown at one end, at the other, at both
        (End("a.y", "tbd"), End("b.u", "V"), [OF_MAP.format("a.y")]),
        (End("c.M.S", "V", bus="c"), End("b.u", "tbd"), [OF_MAP.format("b.u")]),
        (End("c.M.S", "tbd", bus="c"), End("b.u", "V"), [ON_BUS.format("tbd", "V")]),
        (
            End("c.M.S", "tbd", bus="c"),
            End("b.u", "foo"),
            [ON_BUS.format("tbd", "..."), OF_MAP.format("b.u")],
        ),
        (OWN, End("b.u", "V"), [OWN.advice]),
        (OWN, End("b.u", "foo"), [OWN.advice, OF_MAP.format("b.u")]),
        # open
        (End("a.y", "1/s"), End("b.u", "rad/s"), [OF_MAP.format("a.y")]),
        (End("c.M.S", "rad/s", bus="c"), End("b.u", "1/s"), [OF_MAP.format("b.u")]),
        (End("c.M.S", "1/s", bus="c"), End("b.u", "rad/s"), [ON_BUS.format("1/s", "rad/s")]),
        (End("a.y", "kg"), End("b.u", "ton"), [OF_MAP.format("b.u")]),
        (dataclasses.replace(OWN, unit="ton"), End("b.u", "kg"), [OWN.advice]),
        # a word for no unit of measure
        (End("c.M.S", "-", bus="c"), End("b.u", "V"), [ON_BUS.format("-", "V")]),
        (End("c.M.S", "V", bus="c"), End("b.u", "-"), []),
        # another quantity: no text would help
        (End("a.y", "m/s"), End("b.u", "K"), []),
        (dataclasses.replace(OWN, unit="m/s"), End("b.u", "K"), []),
    ],
)
def test_what_to_do_is_said_of_the_end_that_is_to_blame(one, other, advice, turned):
    with pytest.raises(ConfigError) as error:
        made(*((other, one) if turned else (one, other)))
    said = str(error.value)
    found = [text for text in ("map`", "own `unit`", ".units]") for _ in range(said.count(text))]
    assert len(found) == len(advice), said
    for text in advice:
        assert re.search(text, said), said


def test_one_text_is_one_unit_where_one_end_defines_it():
    """A bus signal has no definition of its own: what the FMU calls km/h is the bus' km/h too."""
    odd = {"km/h": UnitOfMeasure("km/h", SPEED, 1.0)}
    assert made(End("a.v", "km/h", odd), End("c.M.S", "km/h", bus="c")) == (Affine(), [])
    map_, (warning,) = made(End("a.v", "km/h", odd), "m/s")
    assert map_ == Affine()
    said = "[km/h] is defined as 1 [m.s-1], and usually is 0.277778 [m.s-1]"
    assert warning == f"a.v: its FMU's definition is taken: {said}"
    with pytest.raises(ConfigError, match=r"define .* otherwise"):
        made(End("a.v", "km/h", odd), End("b.v", "km/h", {"km/h": UnitOfMeasure("km/h", SPEED, 1 / 3.6)}))


def test_the_definition_of_another_fmu_is_the_last_resort():
    others = {"mine": UnitOfMeasure("mine", SPEED, 2.0), "km/h": UnitOfMeasure("km/h", SPEED, 1.0)}
    assert made("mine", "m/s", others)[0] == Affine(2.0)
    assert made("km/h", "m/s", others)[0] == Affine(5 / 18)


KELVINS = [(("K", "K"), 1.0), (("K", "mK"), 1000.0), (("kelvin", "K"), 1.0)]


@pytest.mark.parametrize(("units", "scale"), KELVINS)
def test_a_difference_in_kelvins_and_a_temperature_are_a_warning(units, scale):
    for kinds in ((True, False), (False, True)):
        ends = [End(f"{name}.t", u, difference=d) for name, u, d in zip("ab", units, kinds, strict=True)]
        map_, warnings = made(*ends)
        assert map_ == Affine(scale)
        first, second = ("a difference" if each else "an absolute temperature" for each in kinds)
        said = f"{ends[0]} is {first} and {ends[1]} {second} (FMI: relativeQuantity)"
        assert [text for text in warnings if "relativeQuantity" in text] == [
            f"{said}: the number is taken as it is"
        ]
    for same in (True, False):
        ends = [End(f"{name}.t", u, difference=same) for name, u in zip("ab", units, strict=True)]
        assert not [text for text in made(*ends)[1] if "relativeQuantity" in text]
    lengths = End("a.x", "m", difference=True), End("b.x", "km")
    assert made(*lengths)[1] == [], "no unit of length has an offset"
    assert made(End("a.t", "delta_K"), End("b.t", "K", difference=True))[1] == []


def test_a_difference_keeps_its_zero():
    celsius, kelvin = End("a.t", "degC", difference=True), End("b.t", "K", difference=True)
    assert made(celsius, kelvin)[0] == Affine()
    for absolute in ("K", "degC"):
        with pytest.raises(ConfigError, match="relativeQuantity"):
            made(celsius, absolute)


@pytest.mark.parametrize(
    ("text", "other"), [("mil", "rad"), ("bbl", "L"), ("gal", "L"), ("hp", "kW"), ("floops", "m")]
)
def test_a_doubtful_unit_is_refused_with_the_ways_out(text, other):
    bus, variable = End("c.M.S", text, bus="c"), End("a.x", text)
    for end, said in (
        (
            bus,
            rf'say what it is in the system file, \[buses.c.units\]: "{text}" = "{other}", or `factor` with',
        ),
        (
            variable,
            r"say what a.x is in: `unit` in the unit's `map`, or `factor` with `convert = false` in its",
        ),
    ):
        for ends in ((end, End("b.y", other)), (End("b.y", other), end)):
            with pytest.raises(ConfigError, match=said):
                unit_map(*ends, (), "here", [])
    assert scaled_map(
        variable, End("b.y", other), Scaling(factor=2.0, convert=False), (), "here", []
    ) == Affine(2.0)


def test_the_units_of_a_bus():
    signal = Signal("S", 0, 8, unit="Unit_X")
    assert with_unit(signal, {"Unit_X": "V"}).unit == "V"
    assert with_unit(signal, {"other": "V"}) is signal
    assert check_texts({"Unit_X": "V", "Unit_Y": "A"}, {"Unit_X"}, "here") == [
        "here: no signal has the unit of measure [Unit_Y]"
    ]
    with pytest.raises(ConfigError, match=r"^here: .Unit_X.: unit of measure .Volt-ish. is not known"):
        check_texts({"Unit_X": "Volt-ish"}, {"Unit_X"}, "here")


def scaled(source, target, **keys):
    """The map between two ends with a factor."""
    ends = (source if isinstance(source, End) else End("a", source), End("b", target))
    return scaled_map(*ends, Scaling(**keys), (), "here", [])


def test_a_factor_stands_between_two_different_quantities():
    assert scaled("%", "N.m", factor=0.45, offset=-1.0) == Affine(0.45, -1.0)
    assert scaled("dB", "1", factor=0.1) == Affine(0.1)
    assert scaled("km/h", "m/s") == Affine(5 / 18)


@pytest.mark.parametrize(
    ("source", "target"),
    [("km/h", "m/s"), ("", "m/s"), ("m/s", ""), ("", ""), ("count", "m/s"), ("1/s", "rad/s"), ("m/s", "m/s")],
)
def test_else_it_says_how_it_is_meant(source, target):
    for keys in ({"factor": 3.6}, {"offset": 1.0}):
        with pytest.raises(ConfigError, match=r"^here: .*say `convert = true` .* or `false`"):
            scaled(source, target, **keys)
    assert scaled(source, target, factor=3.6, offset=1.0, convert=False) == Affine(3.6, 1.0)


def test_a_factor_after_the_conversion():
    assert scaled("km/h", "m/s", factor=3.6, offset=1.0, convert=True) == Affine(pytest.approx(1.0), 1.0)
    assert scaled("degC", "K", factor=2.0, offset=1.0, convert=True) == Affine(2.0, 547.3)
    for source, target, said in (
        ("", "m/s", "a declares no unit of measure, so that nothing is converted"),
        ("m/s", "", "b declares no unit of measure"),
        ("N", "m/s", "different quantities"),
        ("1/s", "rad/s", "may count turns"),
    ):
        with pytest.raises(ConfigError, match=said):
            scaled(source, target, factor=2.0, convert=True)
    with pytest.raises(ConfigError, match="no number holds it"):
        scaled("km", "mm", factor=1e308, convert=True)


def test_what_converts():
    assert converts(End("a", "km/h"), End("b", "m/s"), ())
    assert converts(End("a", ""), End("b", "m/s"), ())
    assert not converts(End("a", "N"), End("b", "m/s"), ())
