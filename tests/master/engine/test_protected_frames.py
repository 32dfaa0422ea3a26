"""A protected message of a built-in system: results as without protection, and frames that others accept."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from e2e import p01

from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import System, load_system
from evcosim.master.simulation import Simulation

E2E = {"profile": "1A", "data_id": 0x120, "crc": "VCU_SteerRequestCrc", "counter": "VCU_SteerRequestCounter"}


def system(timing: str = "instant", **own: object) -> System:
    """Lane keeping, with these settings of the message of the steering angles."""
    found = load_system("lane_keeping")
    messages = {"VCU_SteerRequest": MessageSettings.model_validate(own)}
    bus = found.file.buses["can0"].model_copy(update={"messages": messages, "timing": timing})
    return dataclasses.replace(found, file=found.file.model_copy(update={"buses": {"can0": bus}}))


def ran(tmp_path, engine, of, **options):
    """The columns of a run by name, its log's payloads of the message, and what was counted."""
    scenario = options.pop("scenario", None)
    with Simulation(of, scenario, engine=engine, isolation="none", log_frames=True, **options) as simulation:
        simulation.step(200)
        results, counted = simulation.results, simulation.manifest()["frames"]
        simulation.write_can_log(tmp_path / "bus.log")
    lines = (tmp_path / "bus.log").read_text().splitlines()
    payloads = [bytes.fromhex(line.split("#")[1].split()[0]) for line in lines if " 120#" in line]
    return {v.name: results[v.name] for v in results.variables}, payloads, counted.get("can0", {})


@pytest.mark.parametrize("timing", ["instant", "frame"])
def test_results_are_those_without_and_the_library_accepts_each_frame(tmp_path, timing):
    before, *_ = ran(tmp_path, "compiled", system(timing))
    found = {engine: ran(tmp_path, engine, system(timing, e2e=E2E)) for engine in ("python", "compiled")}
    for name, column in before.items():
        assert np.array_equal(column, found["python"][0][name])
        assert np.array_equal(column, found["compiled"][0][name])
    assert found["python"][1:] == found["compiled"][1:]
    _, payloads, frames = found["compiled"]
    assert len(payloads) >= 199
    assert [payload[1] & 15 for payload in payloads] == [n % 15 for n in range(len(payloads))]
    for payload in payloads:
        assert p01.e2e_p01_check(bytearray(payload), 0x120, data_id_mode=p01.E2E_P01_DATAID_BOTH)
    message = frames["messages"]["VCU_SteerRequest"]
    assert message["rejected"] == 0
    assert message["statuses"] == {"ok": message["arrived"] - 1, "initial": 1}


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_an_input_receives_the_status(tmp_path, engine):
    of = system(e2e=E2E, status=["vehicle.crosswind"], timeout=3)
    columns, *_ = ran(tmp_path, engine, of, record=["vehicle.crosswind"])
    status = columns["vehicle.crosswind"]
    first = int(np.flatnonzero(status)[0])
    assert status[first] == 4.0
    assert not status[first + 1 :].any()


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize(
    ("fault", "statuses"),
    [
        ('action = "corrupt"\nbyte = 3\nmask = 1', {"wrong_crc": 10}),
        ('action = "freeze"\ncounter = "frozen"', {"repeated": 10}),
        ('action = "freeze"', {"ok": 198}),  # nobody sees it: the counter runs, and the checksum is right
        ('action = "lose"', {"no_new_data": 10}),
    ],
)
def test_what_a_receiver_says_of_a_fault(tmp_path, engine, fault, statuses):
    text = f'[[fault]]\ntime = 0.5\nduration = 0.1\nmessage = "can0.VCU_SteerRequest"\n{fault}\n'
    (tmp_path / "fault.toml").write_text(text)
    _, _, frames = ran(tmp_path, engine, system(e2e=E2E), scenario=tmp_path / "fault.toml")
    found = frames["messages"]["VCU_SteerRequest"]["statuses"]
    assert {name: found.get(name, 0) for name in statuses} == statuses


@pytest.mark.parametrize(
    ("own", "reason"),
    [
        ({"e2e": E2E | {"crc": "VCU_SteerReqCrc"}}, "no signal 'VCU_SteerReqCrc' (did you mean"),
        ({"e2e": E2E | {"crc": "VCU_SteerRequestCounter"}}, "has 4 bits, and 8 are needed"),
        ({"e2e": E2E | {"counter": "VCU_SteerRequestCrc"}}, "has 8 bits, and 4 are needed"),
        ({"e2e": E2E | {"crc": "VCU_SteerAngReqFront"}}, "is fed by a connection, and by the protection"),
        ({"e2e": E2E | {"profile": "2"}}, "profile 2 has 16 from 0 to 255, not 288"),
        ({"e2e": E2E | {"data_id": [1, 2]}}, "profile 1A has 1 from 0 to 65535, not [1, 2]"),
        ({"e2e": E2E | {"profile": "1C"}}, "profile 1C has a `nibble`, and no other"),
        ({"e2e": E2E | {"max_delta": 15}}, "max_delta = 15: the counter of profile 1A has 15 values"),
        ({"e2e": E2E, "status": ["vehicle.wind"]}, "status: unit 'vehicle' has no"),
        ({"e2e": E2E, "status": ["car.wind"]}, "status: there is no unit of 'car.wind'"),
        ({"e2e": E2E, "status": ["controller.yaw_rate"]}, "controller.yaw_rate is driven already"),
        ({"status": ["vehicle.crosswind"]}, "there is a status with `e2e`, `checksum` or `timeout`"),
        ({"on_timeout": "sna"}, "on_timeout: it needs a `timeout`, in cycles"),
    ],
)
def test_what_does_not_fit_is_refused(own, reason):
    with pytest.raises(ConfigError) as error:
        Simulation(system(**own), isolation="none").close()
    assert reason in str(error.value)
    assert "buses.can0.messages.VCU_SteerRequest" in str(error.value)
