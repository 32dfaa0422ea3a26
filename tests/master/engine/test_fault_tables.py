"""The rows of faults; tests/cosim/plan/test_faults.py runs systems with faults."""

from __future__ import annotations

import numpy as np

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.channel import MessageChannel
from evcosim.cosim.can.database import Message
from evcosim.cosim.can.wire import tables as T
from evcosim.cosim.plan.faults import FOREVER, babblers, planned
from evcosim.cosim.plan.plan import MessagePlan
from evcosim.cosim.system.scenario import ScenarioFile
from evcosim.master.engine.fault_tables import hits_of, nodes_of, numbers_of, owner_of
from evcosim.master.engine.sender import Sender
from evcosim.master.engine.wire_tables import wire_arrays

FAULTS = [
    {"action": "bus_off", "time": 3.0, "duration": 1.0, "node": "can0.N"},
    {"action": "delay", "time": 2.0, "by": 0.03, "every": 2, "probability": 0.5, "message": "can0.M"},
    {"action": "babble", "time": -1.0, "id": 5, "period": 0.002, "bus": "can0"},
]


def test_rows_stand_in_the_order_of_their_times():
    use = BusSettings(timing="frame")
    message = Message("test.dbc", "M", 16, senders=("N",))
    plans = [MessagePlan("can0", message, use, (), {}, 1, 0, None)]
    faults = planned(ScenarioFile.model_validate({"fault": FAULTS}).faults, plans, 0.0, "test.toml")
    plans += babblers(faults, plans)
    view = memoryview(np.zeros(1))
    senders = [Sender(plan, MessageChannel(plan.message, (), use), view, None) for plan in plans]
    made = wire_arrays(senders, np.zeros(1), 0.01, False, faults=faults)
    rows = made["faults"]
    assert rows[:, T.FAULT_KIND].tolist() == [T.BABBLE, T.LATE, T.BUS_OFF]
    assert rows[:, T.SINCE_TIME].tolist() == [0, 2 * 10**12, 3 * 10**12]
    assert rows[:, T.UNTIL_TIME].tolist() == [FOREVER, FOREVER, 4 * 10**12]
    assert rows[:, T.AMOUNT].tolist() == [2 * 10**9, 3 * 10**10, 0]
    assert rows[2, T.FAULT_NODE] == nodes_of(plans).index(("can0", "N"))
    assert made["odds"].tolist() == [1.0, 0.5, 1.0]
    assert made["buses"][0, [T.STRIKES, T.TO_BABBLE]].tolist() == [1, 1]
    assert made["messages"][:, T.BABBLES].tolist() == [0, 1]
    rows[:, T.HITS] = 7, 8, 9
    assert hits_of(made, faults) == {0: 9, 1: 8, 2: 7}


def test_a_fault_more_changes_no_draw_of_those_on_others():
    """No two faults of one action that can hit one message have one number."""
    message = Message("test.dbc", "M", 16, senders=("N",))
    other = Message("test.dbc", "O", 17, senders=("N",))
    plans = [MessagePlan("can0", m, BusSettings(), (), {}, 1, 0, None) for m in (message, other)]
    lose, by_node = ({"action": "lose", "time": 9.0, key: f"can0.{name}"}
                     for key, name in (("message", "M"), ("node", "N")))  # fmt: skip # a table
    corrupt = {"action": "corrupt", "time": 0.0, "byte": 1, "message": "can0.M"}
    given = [lose, by_node, corrupt, {**lose, "time": 1.0}, {**lose, "message": "can0.O"}]

    def numbers(faults):
        faults = ScenarioFile.model_validate({"fault": faults}).faults
        return numbers_of(planned(faults, plans, 0.0, "test.toml"))

    assert numbers(given) == [2, 1, 0, 4, 2]
    assert numbers([{**lose, "message": "can0.O"}, *given[:4]])[1:] == [2, 1, 0, 4]


def test_the_node_behind_a_mailbox():
    nodes = [("can0", "A"), ("can0", "B")]
    assert owner_of(3, nodes, {3: ("can0", "B")}) == 1
    assert owner_of(3, nodes, {3: ("can1", "B")}) == owner_of(4, nodes, {3: ("can0", "B")}) == -1
