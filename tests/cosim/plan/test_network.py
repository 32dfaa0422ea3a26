"""Drivers and mailboxes of inputs."""

from __future__ import annotations

from evcosim.cosim.units.measure import Affine
from support.car import BUS, SENT, plan


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


def test_every_input_has_one_route_or_a_stimulus():
    connect = [SENT, {"from": "ecu.throttle", "to": ["car.throttle"]}]
    made = plan(connect, {"stimulus": [{"to": "car.grade", "constant": 1}]}, **BUS)
    driven = [route.sink for u in made.units for route in u.routes] + [drive.sink for drive in made.drives]
    assert sorted(driven) == sorted(i.slot for i in made.inputs.values())
    assert set(made.inputs) == {"ecu.speed", "ecu.flag", "car.throttle", "car.grade"}
