"""The actions of a communication step, in their order, for both algorithms, periods and delays."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from evcosim.master.engine.schedule import Action, Waiting, schedule, waiting


def message(after=None, every=1, first=0, delay=0, width=2, **more):
    arrivals = [(10 + i, 20 + i) for i in range(width if delay else 0)]
    values = {
        "framing": None,
        "timed": False,
        "watched": False,
        "latest": 0,
        "replayed": False,
        "settings": SimpleNamespace(delay=0.015),
    } | more
    values.setdefault("cycle", every)
    return SimpleNamespace(after=after, every=every, first=first, delay=delay, arrivals=arrivals, **values)


def plan(
    algorithm="gauss_seidel",
    periods=(1, 1),
    messages=(),
    drives=0,
    texts=0,
    steps=100,
    told=True,
    timed=(),
    first=0,
    replays=0,
):
    units = [SimpleNamespace(every=every, first=first) for every in periods]
    return SimpleNamespace(
        algorithm=algorithm,
        clock=SimpleNamespace(steps=steps, told=told, step=0.01),
        units=units,
        messages=messages,
        timed_buses=timed,
        drives=[None] * drives,
        replays=[None] * replays,
        memory_size=100,
        text_columns=[None] * texts,
    )


def words(actions):
    return " ".join(f"{a.kind}{a.index}" if a.kind != "record" else "record" for a in actions)


def test_texts_are_noted_with_the_row_where_there_are_any():
    assert words(schedule(plan(texts=1))).endswith("record note0 publish0 publish1")
    assert "note" not in words(schedule(plan()))


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_timed_buses_arrive_before_all_messages_and_contend_behind_all_turns(algorithm):
    actions = words(schedule(plan(algorithm, messages=[message()], drives=1, timed=("a", "b"))))
    assert actions.startswith("drive0 arrive0 arrive1 send0 take0")
    assert actions.endswith("end1 contend0 contend1 record publish0 publish1")


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_logs_are_replayed_before_all_messages_and_their_messages_are_sent_by_nobody(algorithm):
    of = {"bus": "a", "message": SimpleNamespace(name="M")}
    logged = message(every=5, first=2, replayed=True, watched=True, framing=1, **of)
    actions = schedule(plan(algorithm, messages=[message(), logged], replays=1, timed=("a",)))
    assert words(actions).startswith("arrive0 replay0 watch1 send0 take0") and "send1" not in words(actions)
    assert actions[2] == Action("watch", 1, 5, 2)
    timed = message(every=5, first=2, replayed=True, watched=True, framing=1, timed=True, **of)
    assert schedule(plan(algorithm, messages=[timed], replays=1))[1] == Action("watch", 0, 5, 2 + 5 + 2)


def test_pages_are_watched_once_a_cycle_of_their_message():
    of = {"bus": "a", "message": SimpleNamespace(name="M")}
    pages = [message(every=10, first=5 * i, watched=True, framing=1, timed=True, **of) for i in range(2)]
    found = [a for a in schedule(plan(messages=pages, timed=("a",))) if a.kind == "watch"]
    assert found == [Action("watch", 0, 10, 0 + 5 + 2), Action("watch", 1, 10, 5 + 5 + 2)]
    logged = [message(every=5, replayed=True, watched=True, framing=1, **of) for _ in range(2)]
    found = [a for a in schedule(plan(messages=logged, replays=1)) if a.kind == "watch"]
    assert found == [Action("watch", 0, 5, 0)]


def test_a_message_is_watched_once_a_cycle_behind_what_brings_it():
    watched = message(every=5, first=2, watched=True, framing=1)
    late = message(every=5, first=2, delay=3, watched=True, framing=1)
    name = SimpleNamespace(name="M")
    timed = message(every=5, first=2, watched=True, framing=1, timed=True, bus="a", message=name)
    assert words(schedule(plan(messages=[watched]))).startswith("send0 watch0 take0")
    assert words(schedule(plan(messages=[late]))).startswith("deliver0 watch0 send0 take0")
    actions = schedule(plan(messages=[timed], timed=("a",)))
    assert words(actions).startswith("arrive0 watch0 send0 take0")
    assert actions[1] == Action("watch", 0, 5, 2 + 5 + 2)  # a cycle and the bus' delay after the first one


def test_frames_that_a_fault_makes_late_arrive_at_any_step_before_newer_ones():
    here = message(every=5, first=2, watched=True, framing=1, latest=10**9)
    delayed = message(every=5, first=2, delay=3, framing=1, latest=10**9)
    actions = schedule(plan(messages=[here, delayed]))
    assert words(actions).startswith("deliver0 send0 watch0 deliver1 send1 take0")
    assert actions[0] == Action("deliver", 0, 1, 2)
    assert actions[3] == Action("deliver", 1, 1, 5)


def test_gauss_seidel_sends_first_then_takes_each_unit_with_its_discrete_messages():
    actions = schedule(plan(messages=[message(), message(after=0), message(after=1)], drives=1))
    assert words(actions) == (
        "drive0 send0 take0 begin0 end0 send1 take1 begin1 end1 send2 record publish0 publish1"
    )


def test_jacobi_sends_and_takes_all_before_any_unit_begins():
    actions = schedule(plan("jacobi", messages=[message(), message(after=0)], drives=1))
    assert words(actions) == (
        "drive0 send0 send1 take0 take1 begin0 begin1 end0 end1 record publish0 publish1"
    )


def test_a_unit_with_a_longer_period_publishes_at_the_end_of_it():
    actions = schedule(plan(periods=(5,)))
    every = {a.kind: (a.every, a.first) for a in actions}
    assert every["take"] == every["begin"] == every["end"] == (5, 0)
    assert every["publish"] == (5, 4)
    assert every["record"] == (1, 0)


def test_a_unit_with_an_offset_has_its_first_turn_there():
    actions = schedule(plan(periods=(5,), first=3))
    every = {a.kind: (a.every, a.first) for a in actions}
    assert every["take"] == every["begin"] == every["end"] == (5, 3)
    found = [a for a in schedule(plan(periods=(5,), first=3, steps=12)) if a.kind == "publish"]
    assert {k for a in found for k in range(12) if a.due(k)} == {7, 11}  # the turn of step 8 is cut short


@pytest.mark.parametrize(
    ("every", "steps", "at"), [(5, 12, 11), (5, 3, 2), (2, 1, 0), (5, 10, None), (1, 7, None)]
)
def test_a_unit_of_which_the_stop_time_cuts_the_last_period_publishes_there_too(every, steps, at):
    found = [a for a in schedule(plan(periods=(every,), steps=steps)) if a.kind == "publish"]
    due = {k for a in found for k in range(steps) if a.due(k)}
    assert due == set(range(every - 1, steps, every)) | ({at} - {None})
    # a run whose units were told no stop time may go beyond it
    (only,) = (a for a in schedule(plan(periods=(every,), steps=steps, told=False)) if a.kind == "publish")
    assert (only.every, only.first) == (every, every - 1)


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_on_a_bus_with_a_delay_the_older_values_arrive_before_the_newer_are_sampled(algorithm):
    actions = schedule(plan(algorithm, messages=[message(every=3, first=2, delay=7)]))
    assert actions[0] == Action("deliver", 0, every=3, first=9)
    assert actions[1] == Action("send", 0, every=3, first=2)


def test_always():
    assert Action("record").always
    assert not Action("send", every=2).always
    assert not Action("send", first=1).always


@pytest.mark.parametrize(("every", "delay", "rows"), [(1, 1, 1), (1, 4, 4), (3, 1, 1), (3, 3, 1), (3, 4, 2)])
def test_as_many_rows_as_transmissions_can_be_under_way(every, delay, rows):
    found, size = waiting(plan(messages=[message(), message(every=every, delay=delay)]))
    assert found == {1: Waiting(100, rows, 2)}
    assert size == 100 + 2 * rows
    places = [found[1].row(n) for n in range(3 * rows)]
    assert places == [100 + 2 * (n % rows) for n in range(3 * rows)]
    # transmission n is delivered `delay` steps after it, no later than the one that takes its row is sampled
    assert delay <= rows * every


def test_messages_without_a_delay_need_no_room():
    assert waiting(plan(messages=[message()])) == ({}, 100)
