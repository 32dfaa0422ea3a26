"""Every built-in system has protected messages: their frames, as the CAN log has them, pass autosar-e2e."""

from __future__ import annotations

import dataclasses

import cantools
import pytest
from e2e import p01

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.system.system import load_system, system_names
from evcosim.cosim.system.toml import DATA
from evcosim.master.simulation import Simulation

PROTECTED = {
    "braking": {"VCU_TwoWheelBrakeRequest"},
    "lane_keeping": {"VCU_SteerRequest", "CAM_LaneStatus"},
    "multi_drive": {"VCU_WheelTorqueRequest"},
    "scooter": {"VCU_Request"},
}


def protected(system: str) -> dict[str, dict]:
    """The protection of each protected message, by name."""
    messages = load_system(system).file.buses["can0"].messages
    return {name: own.e2e for name, own in messages.items() if own.e2e is not None}


def payloads(tmp_path, system: str, **options) -> tuple[dict[int, list[bytes]], dict]:
    """The payloads of a run by frame id, as its CAN log has them, and the run's counts."""
    with Simulation(system, isolation="none", log_frames=True, **options) as simulation:
        simulation.step(120)
        simulation.write_can_log(tmp_path / "bus.log")
        counted = simulation.manifest()["frames"]["can0"]["messages"]
    found: dict[int, list[bytes]] = {}
    for line in (tmp_path / "bus.log").read_text().splitlines():
        id_, data = line.split()[2].split("#")
        found.setdefault(int(id_, 16), []).append(bytes.fromhex(data))
    return found, counted


def test_each_system_has_one():
    assert {system: set(protected(system)) for system in system_names()} == PROTECTED


@pytest.mark.parametrize("timing", ["instant", "frame"])
@pytest.mark.parametrize("system", system_names())
def test_each_frame_is_accepted_and_its_counter_goes_on(tmp_path, system, timing):
    sent, counted = payloads(tmp_path, system, bus=BusVariation(timing=timing))
    database = cantools.database.load_file(DATA / "can" / "ev.dbc", strict=False)
    for name, e2e in protected(system).items():
        message = database.get_message_by_name(name)
        frames = sent[message.frame_id]
        assert len(frames) >= 119
        for n, data in enumerate(frames):
            assert len(data) == message.length
            assert p01.e2e_p01_check(bytearray(data), e2e.data_id, data_id_mode=p01.E2E_P01_DATAID_BOTH)
            assert message.decode(data, decode_choices=False)[e2e.counter] == n % 15
        assert counted[name]["rejected"] == 0
        # what the database says of the message beside the settings
        assert e2e.data_id == message.dbc.attributes["E2EDataId"].value


def test_protection_leaves_no_bit_of_the_results_other():
    """Without it, and with values that are not quantized, for which there are no bytes to protect."""
    for system in system_names():
        of = load_system(system)
        bus = of.file.buses["can0"]
        bare = bus.model_copy(update={"messages": {}})
        without = dataclasses.replace(of, file=of.file.model_copy(update={"buses": {"can0": bare}}))
        for resolution in (1.0, "ideal"):
            found = [ran(it, BusVariation(resolution=resolution)) for it in (of, without)]
            assert found[0] == found[1], system


def ran(of, bus) -> bytes:
    with Simulation(of, isolation="none", bus=bus) as simulation:
        simulation.step(120)
        results = simulation.results
        return b"".join(results[v.name].tobytes() for v in results.variables)
