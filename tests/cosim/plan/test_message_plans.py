"""The messages of connected signals: their times, their pages, and who sends them."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import BusEntry
from support.car import BUS, SENT, ecu, plan, unit
from support.mocks import MockUnit, column, plan_of, real, started


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


def test_a_signal_may_have_a_dot_in_its_name(tmp_path):
    long = 'BA_DEF_ SG_ "SystemSignalLongSymbol" STRING ;\nBA_ "SystemSignalLongSymbol" SG_ 256 All'
    (tmp_path / "p.dbc").write_text(f'{PAGES}{long} "Temp. of all";\n')
    connect = [{"from": "a.y", "via": "can0.M.Temp. of all"}]
    buses = {"can0": {"dbc": str(tmp_path / "p.dbc"), "cycle_time": 0.02}}
    (message,) = plan_of(
        [MockUnit("a", [real("y", "output")])], {"connect": connect, "buses": buses}
    ).messages
    assert list(message.senders) == ["Temp. of all"]
