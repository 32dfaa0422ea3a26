"""Which node a unit's inputs are behind, so that they hear nothing while it is off the bus."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.plan.faults import framed, planned
from evcosim.cosim.plan.nodes import node_of, receiving_nodes
from evcosim.cosim.system.fault_spec import BusOff
from evcosim.cosim.system.system import load_system
from evcosim.master.prepare import prepare


def behind(name: str, node: str, struck: set[str], system=None) -> dict[str, str]:
    """The nodes of the inputs of a system, with a fault of one of them."""
    plan = prepare(name).plan
    fault = BusOff(action="bus_off", time=0.0, node=node)
    messages = framed(plan.messages, planned([fault], plan.messages, 0.0, "test.toml"))
    found = receiving_nodes(messages, plan.inputs, system or load_system(name), struck)
    return {i: found[p.mailbox][1] for i, p in plan.inputs.items() if p.mailbox in found}


def test_a_unit_is_the_node_that_sends_its_messages():
    found = behind("scooter", "can0.EMD", {"can0"})
    assert (found["ecu.speed_measured"], found["vehicle.throttle"]) == ("VCU", "EMD")


def test_of_several_nodes_it_is_the_one_that_the_database_names():
    found = behind("multi_drive", "can0.MCU_L", {"can0"})
    assert found["left_drive.torque_request"] == "MCU_L"
    assert found["right_drive.torque_request"] == "MCU_R"
    assert found["controller.left_wheel_speed"] == "VCU"


def test_without_a_fault_or_wrong_bits_nobody_can_be_off():
    assert behind("multi_drive", "can0.MCU_L", set()) == {}


def test_a_message_that_no_node_sends_is_its_units():
    plan = prepare("scooter").plan.messages[0]
    assert node_of(plan) in plan.message.senders
    bare = dataclasses.replace(plan, message=dataclasses.replace(plan.message, senders=()))
    assert node_of(bare) == next(iter(plan.senders.values())).split(".")[0]


@pytest.mark.parametrize("nodes", [["EMD"], ["EMD", "VCU"]])
def test_nodes_of_a_unit_count_before_the_database(nodes):
    system = load_system("scooter")
    units = dict(system.file.units)
    units["vehicle"] = units["vehicle"].model_copy(update={"nodes": nodes})
    changed = dataclasses.replace(system, file=system.file.model_copy(update={"units": units}))
    assert behind("scooter", "can0.EMD", {"can0"}, changed)["vehicle.throttle"] == "EMD"
