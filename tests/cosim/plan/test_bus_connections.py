"""Connections over a bus: what converts where, and what a signal and its receivers do not fit."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.units.measure import Affine
from support.car import BUS, SENT, plan, unit
from support.databases import HEAD
from support.mocks import MockUnit, plan_of, real


def test_a_bus_connection_converts_on_both_sides():
    (message,) = plan([SENT], **BUS).messages
    (signal,) = message.routes
    assert signal.to_bus == Affine(3.6)  # m/s to the signal's km/h
    assert [map_ for _, map_ in signal.sinks] == [Affine()]
    assert (message.every, message.first) == (1, 0)


def test_limits_that_no_frame_holds_are_said_of_signals_in_use_alone(tmp_path):
    text = (HEAD + "BO_ 256 M: 8 A\n" + ' SG_ Speed : 0|8@1+ (1,0) [0|1000] "km/h" B\n'
            + ' SG_ Other : 8|8@1+ (1,0) [0.4|2.6] "" B\n' + 'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\n'
            + 'BA_ "GenMsgCycleTime" BO_ 256 10;\n')  # fmt: skip # a file
    (tmp_path / "car.dbc").write_text(text)
    bus = {"can0": {"dbc": str(tmp_path / "car.dbc")}}
    warned = plan([SENT | {"via": "can0.M.Speed"}], buses=bus).warnings
    (said,) = [warning for warning in warned if "limits" in warning]
    assert (
        f"line {text[: text.index('SG_ Speed')].count(chr(10)) + 1}: can0.M.Speed: its limits [0, 1000]"
        in said
    )
    assert "255 arrives for 1000" in said
    assert not [warning for warning in plan([SENT], **BUS).warnings if "limits" in warning]


def test_a_coarser_signal_is_in_the_message_and_in_the_route():
    made = plan([SENT], buses={"can0": {"dbc": "can/ev.dbc", "resolution": 4.0}})
    (message,) = made.messages
    (route,) = message.routes
    assert message.message.signals["EMD_VehicleSpeed"] == route.signal
    assert route.signal.scale == 4 * plan([SENT], **BUS).messages[0].routes[0].signal.scale


def test_a_receiver_that_is_not_real_needs_whole_values():
    flag = VariableInfo("flag", "Boolean", "input", "discrete", start=False)
    connect = [{"from": "car.throttle", "to": ["ecu.flag"], "via": "can0.VCU_Request.VCU_ThrottleRequest"}]
    sender = unit("car", real("throttle", "output", unit="%"))
    said = r"ecu.flag is of type Boolean, the signal has scale 0.4 and offset 0$"
    with pytest.raises(ConfigError, match=said):
        plan_of([unit("ecu", flag), sender], {"connect": connect, **BUS})


DBC = """VERSION ""
BS_:
BU_: ECU
BO_ 256 M: 8 ECU
 SG_ S : 0|32@1- (0.01,0) [0|0] "{unit}" ECU
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 256 10;
"""


def over(folder, text, source, target, **bus):
    """The maps from a source to a signal with this text as its unit, and from there to the target."""
    (folder / "it.dbc").write_text(DBC.format(unit=text), encoding="utf-8")
    units = [MockUnit("a", [source]), MockUnit("b", [target])]
    sent = {"from": "a.y", "to": ["b.u"], "via": "can0.M.S"}
    buses = {"can0": {"dbc": str(folder / "it.dbc"), **bus}}
    made = plan_of(units, {"connect": [sent], "buses": buses})
    (route,) = made.messages[0].routes
    assert route.signal.unit == bus.get("units", {}).get(text, text)
    return route.to_bus, route.sinks[0][1], made.warnings


def test_a_text_of_the_dbc_is_read_as_the_system_file_says(tmp_path):
    source, target = real("y", "output", unit="V"), real("u", "input", unit="mV")
    with pytest.raises(ConfigError, match=r'\[buses.can0.units\]: "Spannung" = "V"'):
        over(tmp_path, "Spannung", source, target)
    assert over(tmp_path, "Spannung", source, target, units={"Spannung": "kV"}) == (
        Affine(0.001), Affine(1_000_000.0), (),
    )  # fmt: skip # one line a thing
    _, _, warnings = over(tmp_path, "V", source, target, units={"Volt(s)": "V"})
    assert warnings == ("mocks.toml: buses.can0.units: no signal has the unit of measure [Volt(s)]",)
    with pytest.raises(ConfigError, match=r"mocks.toml: buses.can0.units: .V.: .*Volt-ish. is not known"):
        over(tmp_path, "V", source, target, units={"V": "Volt-ish"})


def test_a_difference_stays_one_over_the_bus(tmp_path):
    """No DBC says whether a temperature is absolute: a signal is what its sender is."""
    source, target = (
        real(name, causality, unit="K", difference=True)
        for name, causality in (("y", "output"), ("u", "input"))
    )
    assert over(tmp_path, "degC", source, target)[:2] == (Affine(), Affine())
    with pytest.raises(ConfigError, match=r"can0.M.S \[degC\] cannot feed b.u \[K\]: .* relativeQuantity"):
        over(tmp_path, "degC", source, real("u", "input", unit="K"))
    absolute = over(tmp_path, "degC", real("y", "output", unit="K"), real("u", "input", unit="K"))
    assert absolute[1] == Affine(1.0, 273.15)


@pytest.mark.parametrize(
    ("source", "signal", "target"),
    [
        ("delta_degC", "degC", "K"),
        ("delta_degC", "delta_degC", "degC"),
        ("K", "delta_degC", "degC"),
        ("degC", "delta_degC", "delta_K"),
        ("degC", "K", "delta_K"),
        ("delta_K", "degC", "degC"),
    ],
)
def test_a_unit_of_differences_meets_no_absolute_one_over_the_bus(tmp_path, source, signal, target):
    with pytest.raises(ConfigError, match=r"cannot feed .* the zero of the one means nothing to the other"):
        over(tmp_path, signal, real("y", "output", unit=source), real("u", "input", unit=target))
    by_name = {"units": {"Temp": signal}}
    with pytest.raises(ConfigError, match=r"cannot feed .* the zero of the one means nothing to the other"):
        over(tmp_path, "Temp", real("y", "output", unit=source), real("u", "input", unit=target), **by_name)
    for plain in ("degC", "delta_degC"):  # a signal is what its sender is
        to_bus, from_bus, _ = over(
            tmp_path, plain, real("y", "output", unit="delta_K"), real("u", "input", unit="delta_degF")
        )
        assert (to_bus, from_bus) == (Affine(), Affine(1.8))


def test_an_unknown_unit_between_bare_numbers_is_a_warning(tmp_path):
    to_bus, to_receiver, warnings = over(
        tmp_path, "raw", real("y", "output", unit="1"), real("u", "input", unit="1")
    )
    assert to_bus.identity and to_receiver.identity
    assert warnings == ("can0.M.S [raw]: this unit of measure is not known; it is taken as [1]",)


def scaled(folder, source, signal, target, ideal=False, to=("b.u",), **keys):
    """The maps of a connection with a factor: to the bus and from it, or with `ideal` both in one."""
    (folder / "it.dbc").write_text(DBC.format(unit=signal), encoding="utf-8")
    units = [
        MockUnit("a", [real("y", "output", unit=source)]),
        MockUnit("b", [real("u", "input", unit=target)]),
    ]
    sent = {"from": "a.y", "to": list(to), "via": "can0.M.S", **keys}
    buses = {"can0": {"dbc": str(folder / "it.dbc")}}
    made = plan_of(units, {"connect": [sent], "buses": buses}, ideal=ideal)
    if ideal:
        return made.links[0].map
    (route,) = made.messages[0].routes
    return (route.to_bus, *(map_ for _, map_ in route.sinks))


@pytest.mark.parametrize(
    ("ends", "keys", "maps"),
    [
        (("%", "%", "N.m"), {"factor": 0.45}, (Affine(), Affine(0.45))),
        (("1", "%", "N.m"), {"factor": 0.45, "offset": 1.0}, (Affine(100.0), Affine(0.45, 1.0))),
        (("%", "N.m", "N.m"), {"factor": 0.45}, (Affine(0.45), Affine())),
        (("%", "kN.m", "N.m"), {"factor": 0.5}, (Affine(0.5), Affine(1000.0))),
        (("km/h", "m/s", "m/s"), {"factor": 2.0, "convert": True}, (Affine(5 / 18), Affine(2.0))),
        (("km/h", "m/s", "km/h"), {"factor": 2.0, "convert": False}, (Affine(5 / 18), Affine(2.0))),
        (("count", "V", "mV"), {"factor": 0.1, "convert": False}, (Affine(0.1), Affine(1000.0))),
    ],
)
def test_a_factor_stands_where_the_quantity_changes(tmp_path, ends, keys, maps):
    to_bus, from_bus = scaled(tmp_path, *ends, **keys)
    assert (to_bus, from_bus) == maps
    ideal = scaled(tmp_path, *ends, ideal=True, **keys)
    assert ideal(7.0) == pytest.approx(from_bus(to_bus(7.0)))  # a bus changes no quantity


def test_a_factor_of_what_is_only_sent(tmp_path):
    assert scaled(tmp_path, "%", "N.m", "", to=(), factor=0.45) == (Affine(0.45),)


def test_a_factor_hides_no_unit_of_measure(tmp_path):
    for ideal in (False, True):
        for ends in (("km/h", "m/s", "m/s"), ("", "m/s", "m/s"), ("m/s", "m/s", "")):
            with pytest.raises(ConfigError, match=r"a.y -> b.u: factor = 3.6: .*say `convert = true`"):
                scaled(tmp_path, *ends, ideal=ideal, factor=3.6)
