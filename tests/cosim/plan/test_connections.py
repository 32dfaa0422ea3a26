"""Connections: routes, messages and drivers, and every wrong one refused with place, rule and values."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.system.system import BusEntry
from evcosim.cosim.units.measure import Affine
from support.car import BUS, SENT, car, ecu, plan, unit
from support.databases import HEAD
from support.mocks import MockUnit, column, plan_of, real, started


def test_a_direct_connection_converts_units():
    (route,) = [
        r for r in plan([{"from": "car.speed", "to": ["ecu.speed"]}]).units[0].routes if not r.map.identity
    ]
    assert route.map == Affine(3.6)


def test_a_bus_connection_converts_on_both_sides():
    (message,) = plan([SENT], **BUS).messages
    (signal,) = message.routes
    assert signal.to_bus == Affine(3.6)  # m/s to the signal's km/h
    assert [map_ for _, map_ in signal.sinks] == [Affine()]
    assert (message.every, message.first) == (1, 0)


def test_ideal_leaves_the_bus_out():
    assert plan([SENT], **BUS, options={"ideal": True}).messages == ()


@pytest.mark.parametrize(
    ("connect", "said"),
    [
        (
            [{"from": "car.spede", "to": ["ecu.speed"]}],
            r"'car' has no variable 'spede' \(did you mean 'speed'\?\)",
        ),
        ([{"from": "caar.speed", "to": ["ecu.speed"]}], r"no unit 'caar' \(did you mean 'car'\?\)"),
        (
            [{"from": "car.speed", "to": ["ecu.sped"]}],
            r"'ecu' has no variable 'sped' \(did you mean 'speed'\?\)",
        ),
        ([{"from": "ecu.speed", "to": ["car.throttle"]}], "causality input, not output or local"),
        ([{"from": "car.speed", "to": ["ecu.throttle"]}], "causality output, not input"),
        (
            [{"from": "car.speed", "to": ["car.throttle"]}],
            r"car.speed \[m/s\] cannot feed car.throttle \[%\]: .*different quantities",
        ),
        ([{"from": "car.speed", "to": ["ecu.flag"]}], "car.speed is of type Real, ecu.flag of type Boolean"),
        ([{"from": "car.speed"}], "needs a receiver in 'to' or a signal in 'via'"),
        (
            [{"from": "car.speed", "to": ["ecu.speed"]}, {"from": "car.speed", "to": ["ecu.speed"]}],
            "ecu.speed is driven already, by car.speed",
        ),
        ([SENT | {"via": "can1.EMD_Status.EMD_VehicleSpeed"}], r"no bus 'can1' \(did you mean 'can0'\?\)"),
        (
            [SENT | {"via": "can0.EMD_Stats.EMD_VehicleSpeed"}],
            r"no message 'EMD_Stats' \(did you mean 'EMD_Status'",
        ),
        ([SENT | {"via": "can0.EMD_Status.EMD_Speed"}], "no signal 'EMD_Speed'"),
        ([SENT | {"from": "car.force"}], r"car.force \[N\] cannot feed .* \[km/h\]"),
        ([SENT, SENT | {"from": "ecu.throttle", "to": []}], "is sent already, by car.speed$"),
        ([SENT, SENT | {"to": []}], "is sent already, by car.speed; name all its receivers in the `to`"),
        (
            [SENT, {"from": "ecu.throttle", "via": "can0.EMD_Status.EMD_Power", "factor": 1.0}],
            r"EMD_Status.EMD_Power is sent by unit 'ecu', and EMD_Status.EMD_VehicleSpeed by 'car': one node",
        ),
    ],
)
def test_a_wrong_connection_is_named(connect, said):
    for ideal in (False, True):
        if ideal and ("sent already" in said or "one node" in said):
            continue  # without the bus there is no message that two send
        with pytest.raises(ConfigError, match=said) as caught:
            plan(connect, **BUS, options={"ideal": ideal})
        assert "mocks.toml: connect" in str(caught.value)


def test_a_unit_left_out_frees_its_receivers():
    connect = [{"from": "ecu.throttle", "to": ["car.throttle"]}, {"from": "car.speed", "to": ["ecu.speed"]}]
    both = plan_of([ecu(), car()], {"connect": connect})
    assert both.inputs["car.throttle"].driver == "ecu.throttle"
    alone = plan_of([ecu(), car()], {"connect": connect}, {"leave_out": ["ecu"]})
    assert [u.name for u in alone.units] == ["car"]
    assert alone.inputs["car.throttle"].driver == ""


def test_a_missing_unit_of_measure_is_said():
    bare = unit("car", real("speed", "output"))
    plan_ = plan_of([ecu(), bare], {"connect": [{"from": "car.speed", "to": ["ecu.speed"]}]})
    assert plan_.warnings == ("car.speed declares no unit of measure; it is taken as [km/h]",)


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


def test_a_mailbox_stands_between_a_bus_and_its_receiver():
    made = plan([SENT], **BUS)
    (message,) = made.messages
    ((mailbox, _),) = message.routes[0].sinks
    received = made.inputs["ecu.speed"]
    assert (received.mailbox, received.driver) == (mailbox, "car.speed via can0.EMD_Status.EMD_VehicleSpeed")
    (route,) = [route for route in made.units[0].routes if route.source == mailbox]
    assert (route.sink, route.map) == (received.slot, Affine())


def test_a_direct_connection_has_no_mailbox():
    received = plan([{"from": "car.speed", "to": ["ecu.speed"]}]).inputs["ecu.speed"]
    assert (received.mailbox, received.driver) == (None, "car.speed")


def test_the_first_value_is_that_of_the_connection():
    made = plan([SENT | {"initial": 12.5}], **BUS)
    received = made.inputs["ecu.speed"]
    assert made.initial[received.slot] == made.initial[received.mailbox] == 12.5


@pytest.mark.parametrize("cycle", [1, 4])
def test_a_late_message_passes_slots_of_its_own(cycle):
    bus = {"dbc": "can/ev.dbc", "delay": 0.03, "cycle": cycle}
    made = plan([SENT], buses={"can0": bus})
    (message,) = made.messages
    ((slot, mailbox),) = message.arrivals
    assert message.routes[0].sinks[0][0] == slot != mailbox == made.inputs["ecu.speed"].mailbox
    assert (message.delay, message.every, message.first) == (3, cycle, 0)
    assert message.settings == BusEntry(**bus)


def test_a_message_is_sent_as_the_system_file_says():
    own = {"EMD_Status": {"cycle_time": 0.05, "start_delay": 0.02}}
    bus = {"dbc": "can/ev.dbc", "cycle": 3, "messages": own}
    (message,) = plan([SENT], buses={"can0": bus}).messages
    assert (message.every, message.first) == (15, 2)
    assert (message.message.cycle_time, message.message.start_delay) == (0.05, 0.02)


def test_settings_of_a_message_that_there_is_not_are_named():
    bus = {"dbc": "can/ev.dbc", "messages": {"EMD_Statsu": {"cycle_time": 0.05}}}
    said = r"mocks.toml: buses.can0.messages: .*no message 'EMD_Statsu' \(did you mean 'EMD_Status'\?\)"
    with pytest.raises(ConfigError, match=said):
        plan([], buses={"can0": bus})


def test_a_cycle_time_that_does_not_fit_is_named_with_the_key_that_changes_it():
    bus = {"dbc": "can/ev.dbc", "messages": {"EMD_Status": {"cycle_time": 0.013}}}
    said = r"the nearest are 0.01 s and 0.02 s \(`cycle_time` in \[buses.can0.messages.EMD_Status\]\)"
    with pytest.raises(ConfigError, match=said):
        plan([SENT], buses={"can0": bus})


PAGES = """VERSION ""
BS_:
BU_: ECU
BO_ 256 M: 9 ECU
 SG_ Page M : 0|4@1+ (1,0) [0|15] "" ECU
 SG_ All : 8|16@1+ (1,0) [0|0] "" ECU
 SG_ P1 m1 : 32|16@1+ (1,0) [0|0] "" ECU
 SG_ P2 m2 : 32|16@1+ (1,0) [0|0] "" ECU
 SG_ P4 m4 : 32|16@1+ (1,0) [0|0] "" ECU
"""


def paged(folder, *signals, **bus):
    """The plan and the units of a system in which `a` counts, and sends that in these signals to `b`."""
    (folder / "p.dbc").write_text(PAGES)

    def count(values, time, step_size):
        values["y"] += 1.0

    a = MockUnit("a", [real("y", "output")], count)
    b = MockUnit("b", [real(name, "input", start=-1.0) for name in signals])
    connect = [{"from": "a.y", "to": [f"b.{name}"], "via": f"can0.M.{name}"} for name in signals]
    buses = {"can0": {"dbc": str(folder / "p.dbc"), "cycle_time": 0.02, **bus}}
    return [a, b], plan_of([a, b], {"connect": connect, "buses": buses, "experiment": {"stop_time": 0.2}})


def test_every_page_of_a_message_has_its_turn(tmp_path):
    _, made = paged(tmp_path, "All", "P4", "P1", cycle=2)
    assert [(m.every, m.first, dict(m.page)) for m in made.messages] == [
        (8, 0, {"Page": 1}),
        (8, 4, {"Page": 4}),
    ]
    assert [list(m.senders) for m in made.messages] == [["All", "P1"], ["All", "P4"]]
    assert [list(m.message.signals) for m in made.messages] == [["Page", "All", "P1"], ["Page", "All", "P4"]]
    assert [m.message.signals["Page"].start_raw for m in made.messages] == [1, 4]
    assert {(m.message.length, m.message.fd) for m in made.messages} == {(12, True)}


@pytest.mark.parametrize("delay", [0.0, 0.03])
def test_a_receiver_holds_what_the_last_frame_with_its_signal_said(tmp_path, delay):
    units, made = paged(tmp_path, "All", "P4", "P1", delay=delay)
    engine = started(units, made)
    engine.advance(made.steps)
    late = round(delay / 0.01)
    y = column(engine, "a.y")

    def held(every, first):
        return [-1.0] * late + [
            y[k - (k - first) % every] if k >= first else -1.0 for k in range(len(y) - late)
        ]

    # nothing is sent at the stop time
    assert column(engine, "b.All")[:-1].tolist() == held(2, 0)[:-1]
    assert column(engine, "b.P1")[:-1].tolist() == held(4, 0)[:-1]
    assert column(engine, "b.P4")[:-1].tolist() == held(4, 2)[:-1]


def test_a_page_that_the_run_does_not_reach_is_told_without_what_others_bring(tmp_path):
    _, made = paged(tmp_path, "All", "P4", "P1", cycle=10)
    assert made.unreached == (
        "can0.M first arrives at 0.2 s, not before the stop time 0.2 s: b.P4 keeps its first value",
    )


def test_a_message_that_a_classic_bus_cannot_send_is_named(tmp_path):
    with pytest.raises(
        ConfigError,
        match=r"connect a.y -> b.All: .*p.dbc: line 6: M.All: the message has 9 bytes, and `fd = false`",
    ):
        paged(tmp_path, "All", fd=False)


def test_a_signal_may_have_a_dot_in_its_name(tmp_path):
    long = 'BA_DEF_ SG_ "SystemSignalLongSymbol" STRING ;\nBA_ "SystemSignalLongSymbol" SG_ 256 All'
    (tmp_path / "p.dbc").write_text(f'{PAGES}{long} "Temp. of all";\n')
    connect = [{"from": "a.y", "via": "can0.M.Temp. of all"}]
    buses = {"can0": {"dbc": str(tmp_path / "p.dbc"), "cycle_time": 0.02}}
    (message,) = plan_of(
        [MockUnit("a", [real("y", "output")])], {"connect": connect, "buses": buses}
    ).messages
    assert list(message.senders) == ["Temp. of all"]


def test_a_coarser_signal_is_in_the_message_and_in_the_route():
    made = plan([SENT], buses={"can0": {"dbc": "can/ev.dbc", "resolution": 4.0}})
    (message,) = made.messages
    (route,) = message.routes
    assert message.message.signals["EMD_VehicleSpeed"] == route.signal
    assert route.signal.scale == 4 * plan([SENT], **BUS).messages[0].routes[0].signal.scale


@pytest.mark.parametrize(
    ("variability", "algorithm", "after"),
    [
        ("continuous", "gauss_seidel", None),
        ("discrete", "gauss_seidel", 1),
        ("discrete", "jacobi", None),
    ],
)
def test_a_message_of_discrete_values_waits_for_its_sender(variability, algorithm, after):
    sender = unit("car", real("speed", "output", unit="km/h", variability=variability))
    made = plan_of([ecu(), sender], {"connect": [SENT], **BUS}, algorithm=algorithm)
    assert [m.after for m in made.messages] == [after]


def test_a_receiver_that_is_not_real_needs_whole_values():
    flag = VariableInfo("flag", "Boolean", "input", "discrete", start=False)
    connect = [{"from": "car.throttle", "to": ["ecu.flag"], "via": "can0.VCU_Request.VCU_ThrottleRequest"}]
    sender = unit("car", real("throttle", "output", unit="%"))
    said = r"ecu.flag is of type Boolean, the signal has scale 0.4 and offset 0$"
    with pytest.raises(ConfigError, match=said):
        plan_of([unit("ecu", flag), sender], {"connect": connect, **BUS})


def test_every_input_has_one_route_or_a_stimulus():
    connect = [SENT, {"from": "ecu.throttle", "to": ["car.throttle"]}]
    made = plan(connect, {"stimulus": [{"to": "car.grade", "constant": 1}]}, **BUS)
    driven = [route.sink for u in made.units for route in u.routes] + [drive.sink for drive in made.drives]
    assert sorted(driven) == sorted(i.slot for i in made.inputs.values())
    assert set(made.inputs) == {"ecu.speed", "ecu.flag", "car.throttle", "car.grade"}


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


def test_a_unit_of_differences_meets_no_absolute_one_directly():
    for units in (("delta_degC", "K"), ("degC", "delta_degC")):
        ends = [
            real(*end, unit=unit) for end, unit in zip((("y", "output"), ("u", "input")), units, strict=True)
        ]
        with pytest.raises(ConfigError, match=r"a.y \[.*\] cannot feed b.u .* means nothing to the other"):
            plan_of(
                [MockUnit(n, [v]) for n, v in zip("ab", ends, strict=True)],
                {"connect": [{"from": "a.y", "to": ["b.u"]}]},
            )


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


def test_a_factor_is_for_numbers():
    number = {"from": "car.gear", "to": ["ecu.flag"], "factor": 2.0, "convert": False}
    with pytest.raises(ConfigError, match=r"factor = 2, convert = false: ecu.flag is of type Boolean"):
        plan([number])
    units = [
        MockUnit("a", [VariableInfo("y", "Boolean", "output", "discrete")]),
        MockUnit("b", [real("u", "input")]),
    ]
    made = plan_of(units, {"connect": [{"from": "a.y", "to": ["b.u"], "factor": 100.0, "convert": False}]})
    assert made.links[0].map == Affine(100.0)
