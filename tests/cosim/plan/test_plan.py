"""The plan: what its parts say of each other."""

from __future__ import annotations

from support.car import BUS, SENT, plan

BOTH_WAYS = [
    SENT,
    {"from": "ecu.throttle", "to": ["car.throttle"], "via": "can0.VCU_Request.VCU_ThrottleRequest"},
]


def test_the_recorded_variables_have_their_slots_by_name():
    made = plan(BOTH_WAYS, **BUS)
    assert list(made.slots) == [column.name for column in made.columns]
    assert tuple(made.slots.values()) == made.column_slots
    for name, received in made.inputs.items():
        assert made.slots[name] == received.slot


def test_all_slots_are_within_the_memory():
    made = plan(BOTH_WAYS, buses={"can0": {"dbc": "can/ev.dbc", "delay": 0.02}})
    used = [*made.column_slots, *made.initial]
    used += [slot for u in made.units for route in u.routes for slot in (route.source, route.sink)]
    used += [slot for m in made.messages for route in m.routes for slot in (route.source, *dict(route.sinks))]
    used += [slot for m in made.messages for pair in m.arrivals for slot in pair]
    assert min(used) == 0
    assert max(used) < made.memory_size


def test_a_mailbox_is_no_other_value():
    made = plan(BOTH_WAYS, **BUS)
    mailboxes = [received.mailbox for received in made.inputs.values() if received.mailbox is not None]
    assert len(set(mailboxes)) == len(mailboxes) == len(made.inputs)
    assert set(mailboxes).isdisjoint(made.column_slots)


def test_inputs_and_mailboxes_have_a_first_value():
    made = plan(BOTH_WAYS, {"start": {"ecu": {"speed": 3.0}}}, **BUS)
    for received in made.inputs.values():
        assert made.initial[received.slot] == made.initial[received.mailbox]
    assert made.initial[made.inputs["ecu.speed"].slot] == 3.0
    assert set(made.initial) == {slot for i in made.inputs.values() for slot in (i.slot, i.mailbox)}
