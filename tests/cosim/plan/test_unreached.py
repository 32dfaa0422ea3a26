"""What comes before the start or at the stop of a run is told: events, stimuli, messages."""

from __future__ import annotations

from typing import Any

import pytest

from evcosim.cosim.plan.plan import Plan
from support.car import plan
from support.databases import write
from support.mocks import MockUnit, column, plan_of, real, started

RUN = {"start_time": 0.0, "stop_time": 10.0, "step_size": 0.1}


def made(scenario: dict[str, Any] | None = None, **more: Any) -> Plan:
    return plan([], scenario, **{"experiment": RUN} | more)


def event(time: float, **more: Any) -> dict[str, Any]:
    return {"time": time, "action": "override", "variable": "car.throttle", "value": 1.0} | more


@pytest.mark.parametrize("time", [10.0, 9.91, 1e9])
def test_an_event_that_never_acts_is_told(time):
    found = made({"event": [event(9.9), event(time)]})
    assert found.unreached == (
        f"test.toml: event 2, override of car.throttle at t = {time:.10g} s, never acts: the stop time 10 s "
        "comes before it has an effect",
    )
    assert found.warnings == ()
    assert found.open_ended().unreached == ()  # it may be stepped on to its time


@pytest.mark.parametrize("action", [{"action": "bias"}, {"action": "reset", "value": None}])
def test_events_of_all_kinds(action):
    table = {key: value for key, value in event(11.0, **action).items() if value is not None}
    (said,) = made({"event": [table]}).unreached
    assert said.startswith(f"test.toml: event 1, {action['action']} of car.throttle at t = 11 s, never acts")


@pytest.mark.parametrize(
    ("begin", "date"),
    [
        (1.7e9, "seconds since 1970 (2023-11-14 22:13:20 UTC)"),
        (9e11, "milliseconds since 1970 (1998-07-09 16:00:00 UTC)"),
    ],
)
def test_times_that_look_like_dates_are_told(begin, date):
    stimulus = {"to": "car.grade", "table": [(begin, 1.0), (begin + 1.0, 2.0)]}
    found = made({"stimulus": [stimulus]})
    said = (
        f"test.toml: stimulus 1, the table of car.grade, begins at {begin:.10g} s, "
        f"which looks like {date}: the run, from 0 s to 10 s, has its first value throughout; "
        "write times from the start of the run on, or set start_time"
    )
    assert (found.warnings, found.open_ended().warnings, found.unreached) == ((said,), (said,), ())
    reached = made({"stimulus": [stimulus]}, experiment=RUN | {"start_time": begin, "stop_time": begin + 2.0})
    assert reached.warnings == reached.unreached == ()


def test_an_event_after_the_last_turn_of_its_unit_is_told():
    units = {"car": {"period": 3.0}}  # turns at 0, 3, 6 and 9 s
    (said,) = made({"event": [event(9.0), event(9.1)]}, units=units).unreached
    assert "event 2, override of car.throttle at t = 9.1 s, never acts: car has its next turn at 12 s" in said


def test_the_turns_of_a_unit_begin_at_its_offset():
    units = {"car": {"period": 3.0, "offset": 0.8}}  # turns at 0.8, 3.8, 6.8 and 9.8 s
    (said,) = made({"event": [event(9.8), event(9.9)]}, units=units).unreached
    assert (
        "event 2, override of car.throttle at t = 9.9 s, never acts: car has its next turn at 12.8 s" in said
    )


def test_an_event_before_the_start_is_told():
    scenario = {"event": [event(4.9), event(5.0), event(4.95)]}
    found = made(scenario, experiment=RUN | {"start_time": 5.0})
    assert found.warnings == (
        "test.toml: event 1, override of car.throttle at t = 4.9 s, is before the start time 5 s, at which "
        "it acts",
    )
    assert found.unreached == ()


def test_many_events_take_a_few_lines():
    found = made({"event": [event(20.0 + k) for k in range(1000)]}).unreached
    assert len(found) == 4
    assert found[-1] == "... and 997 more events of this kind"


@pytest.mark.parametrize(
    ("signal", "kind"),
    [
        ({"table": [(10.0, 1.0), (20.0, 2.0)]}, "table"),
        ({"table": [(10.0, 1.0)]}, "table"),
        ({"csv": "late.csv"}, "csv"),
        ({"sine": {"amplitude": 1.0, "period": 1.0, "delay": 10.0}}, "sine"),
        ({"ramp": {"slope": 1.0, "delay": 10.0}}, "ramp"),
    ],
)
def test_a_stimulus_that_begins_at_the_end_is_told(tmp_path, monkeypatch, signal, kind):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "late.csv").write_text("time,grade\n10,1\n12,2\n", encoding="utf-8")
    stimulus = {"to": "car.grade"} | signal
    assert made({"stimulus": [stimulus]}).unreached == (
        f"test.toml: stimulus 1, the {kind} of car.grade, begins at 10 s, not before the stop time 10 s: it "
        "stays at its first value",
    )
    assert made({"stimulus": [stimulus]}, experiment=RUN | {"stop_time": 10.1}).unreached == ()


def test_a_table_that_ends_before_the_start_is_told():
    stimuli = [
        {"to": "car.grade", "table": [(0.0, 1.0), (4.0, 2.0)]},
        {"to": "car.throttle", "table": [(0.0, 1.0)]},  # a constant
    ]
    found = made({"stimulus": stimuli}, experiment=RUN | {"start_time": 5.0})
    assert found.warnings == (
        "test.toml: stimulus 1, the table of car.grade, ends at 4 s, before the start time 5 s: its last "
        "value holds throughout",
    )
    assert made({"stimulus": stimuli}, experiment=RUN | {"start_time": 4.0}).warnings == ()


@pytest.mark.parametrize(("start_delay", "delay"), [(1000, 0.0), (900, 0.1), (0, 1.0)])
def test_a_message_that_never_arrives_is_told(tmp_path, start_delay, delay):
    tail = f'BA_ "GenMsgCycleTime" BO_ 1 100;\nBA_ "GenMsgStartDelayTime" BO_ 1 {start_delay};\n'
    file = write(tmp_path, 'S : 0|16@1+ (0.01,0) [0|600] "" B', tail=tail)

    def units() -> list[MockUnit]:
        return [MockUnit("a", [real("y", "output", start=5.0)]), MockUnit("b", [real("u", "input")])]

    def run(stop: float) -> Plan:
        system = {
            "experiment": {"stop_time": stop, "step_size": 0.1},
            "buses": {"can0": {"dbc": str(file), "delay": delay}},
            "connect": [{"from": "a.y", "to": ["b.u"], "via": "can0.M.S"}],
        }
        return plan_of(units(), system)

    assert run(1.0).unreached == (
        "can0.M first arrives at 1 s, not before the stop time 1 s: b.u keeps its first value",
    )
    assert run(1.1).unreached == ()
    # and so it is
    for stop, arrives in ((1.0, False), (1.1, True)):
        engine = started(units(), run(stop))
        engine.advance(engine.plan.steps)
        assert (5.0 in column(engine, "b.u")) == arrives


def test_a_message_that_nobody_receives_is_not_waited_for():
    sent = {"from": "car.speed", "to": [], "via": "can0.EMD_Status.EMD_VehicleSpeed"}
    short = {"stop_time": 0.1, "step_size": 0.01}
    for to, count in ([], 0), (["ecu.speed"], 1):
        buses = {"can0": {"dbc": "can/ev.dbc", "delay": 0.5}}
        assert len(plan([sent | {"to": to}], experiment=short, buses=buses).unreached) == count


def test_nothing_is_told_of_what_acts():
    scenario = {
        "event": [event(0.0), event(9.9)],
        "stimulus": [
            {"to": "car.grade", "table": [(-5.0, 0.0), (9.9, 1.0)]},
            {"to": "car.throttle", "constant": 3.0},
        ],
    }
    found = made(scenario)
    assert (found.warnings, found.unreached) == ((), ())
