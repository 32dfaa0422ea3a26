"""A maker's checksum in a run: frames, judgments and errors, in both engines alike."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.system.system import System, load_system
from evcosim.master.prepare import prepare
from evcosim.master.simulation import Simulation

SOURCE = '''
"""The sum of all nibbles, and of the identifier's, in four bits."""


def nibbles(payload, identifier, counter):
    total = sum((byte & 15) + (byte >> 4) for byte in payload) + (identifier & 15) + (identifier >> 4)
    return (8 - total) & 255


def late(payload, identifier, counter):
    if counter == 9:
        raise ValueError("nine")
    return 0
'''
KEYS = {"checksum_signal": "VCU_SteerRequestCrc", "checksum_counter": "VCU_SteerRequestCounter"}

ALONE = {"checksum_signal": "VCU_SteerRequestCrc"}
E2E = {"profile": "1A", "data_id": 1, "crc": "VCU_SteerRequestCrc", "counter": "VCU_SteerRequestCounter"}


def system(tmp_path, **own: object) -> System:
    """Lane keeping in a folder with the module, and these settings of the message of the steering angles."""
    (tmp_path / "maker.py").write_text(SOURCE)
    found = load_system("lane_keeping")
    bus = found.file.buses["can0"]
    messages = {"VCU_SteerRequest": MessageSettings.model_validate(own)}
    file = found.file.model_copy(update={"buses": {"can0": bus.model_copy(update={"messages": messages})}})
    return dataclasses.replace(found, file=file, path=tmp_path / "s.toml")


def ran(tmp_path, engine, of, fault: str = "", isolation="none"):
    """Columns of a run by name, payloads of the message, and what was counted of it."""
    text = f'[[fault]]\ntime = 0.5\nduration = 0.1\nmessage = "can0.VCU_SteerRequest"\n{fault}\n'
    (tmp_path / "fault.toml").write_text(text if fault else "")
    with Simulation(
        of, tmp_path / "fault.toml", engine=engine, isolation=isolation, log_frames=True
    ) as simulation:
        simulation.step(100)
        results, counted = simulation.results, simulation.manifest()["frames"].get("can0", {"messages": {}})
        simulation.write_can_log(tmp_path / "bus.log")
    lines = (tmp_path / "bus.log").read_text().splitlines()
    payloads = [bytes.fromhex(line.split("#")[1].split()[0]) for line in lines if " 120#" in line]
    columns = {v.name: results[v.name].tobytes() for v in results.variables}
    return columns, payloads, counted["messages"].get("VCU_SteerRequest")


def test_frames_have_what_the_function_says_and_results_are_those_without(tmp_path):
    bare, *_ = ran(tmp_path, "compiled", system(tmp_path))
    of = system(tmp_path, checksum="maker:nibbles", **KEYS)
    found = {engine: ran(tmp_path, engine, of) for engine in ("python", "compiled")}
    apart = ran(tmp_path, "compiled", of, isolation="process")
    assert found["python"] == found["compiled"] == apart
    assert found["compiled"][0] == bare
    _, payloads, counted = found["compiled"]
    assert [data[1] & 15 for data in payloads] == [n % 15 for n in range(len(payloads))]
    for data in payloads:
        # independently: with the checksum among them, all digits of the identifier and of the bytes
        total = sum(int(digit, 16) for digit in data[1:].hex())
        assert (total + 0x12 + data[0]) & 255 == 8
    assert counted["statuses"] == {"initial": 1, "ok": len(payloads) - 1}


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize(
    ("fault", "keys", "statuses"),
    [
        ('action = "corrupt"\nbyte = 3\nmask = 1', KEYS, {"wrong_crc": 10}),
        ('action = "freeze"\ncounter = "frozen"', KEYS, {"repeated": 10}),
        ('action = "freeze"', KEYS, {"ok": 98}),
        ('action = "lose"', KEYS, {"no_new_data": 10}),
        # without a counter nobody sees a frame that is sent twice
        ('action = "corrupt"\nbyte = 3\nmask = 1', ALONE, {"wrong_crc": 10}),
        ('action = "freeze"', ALONE, {"ok": 98, "repeated": 0}),
    ],
)  # fmt: skip # a table
def test_what_a_receiver_says_of_a_fault(tmp_path, engine, fault, keys, statuses):
    _, _, counted = ran(tmp_path, engine, system(tmp_path, checksum="maker:nibbles", **keys), fault)
    assert {name: counted["statuses"].get(name, 0) for name in statuses} == statuses


@pytest.mark.parametrize(("delta", "wrong"), [({}, True), ({"checksum_max_delta": 4}, False)])
def test_max_delta_bounds_the_steps_of_a_makers_counter(tmp_path, delta, wrong):
    # sent on change it has no cycle, and nobody counts those without a frame
    of = system(tmp_path, checksum="maker:nibbles", **KEYS, send_type="on_change", **delta)
    moving = (
        'action = "lose"\ncount = 3\n'
        '[[stimulus]]\nto = "controller.displacement_reference"\nramp = { slope = 0.5 }'
    )
    found = [ran(tmp_path, engine, of, moving) for engine in ("python", "compiled")]
    assert found[0] == found[1]
    statuses = found[0][2]["statuses"]
    assert ("wrong_sequence" in statuses) == wrong
    assert ("ok_some_lost" in statuses) != wrong


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_an_error_of_the_function_ends_the_run_by_name(tmp_path, engine):
    said = (
        r"at t = 0.1 s \(step 10\): the checksum VCU_SteerRequest.VCU_SteerRequestCrc by maker:late of "
        r".*maker.py: ValueError: nine"
    )
    with pytest.raises(RunError, match=said):
        ran(tmp_path, engine, system(tmp_path, checksum="maker:late", **KEYS))


@pytest.mark.parametrize(
    ("own", "reason"),
    [
        ({"checksum_signal": "VCU_SteerRequestCrc"}, "checksum_signal: it needs `checksum`, the function"),
        ({"checksum": "maker:nibbles"}, "checksum: `checksum_signal` names the signal that it fills"),
        ({"checksum": "maker:nibbles", "checksum_signal": "VCU_SteerReqCrc"}, "no signal 'VCU_SteerReqCrc'"),
        (
            {"checksum": "maker:nibbles", "checksum_signal": "VCU_SteerAngReqFront"},
            "is fed by a connection, and by the protection",
        ),
        (
            {"checksum": "maker:nibbles", **KEYS, "checksum_counter": "VCU_SteerRequestCrc"},
            "VCU_SteerRequestCrc is the checksum's signal",
        ),
        ({"checksum_max_delta": 2}, "checksum_max_delta: it needs `checksum`, the function"),
        (
            {"checksum": "maker:nibbles", **ALONE, "checksum_max_delta": 2},
            "checksum_max_delta = 2: it needs a `checksum_counter`, whose steps it bounds",
        ),
        (
            {"checksum": "maker:nibbles", **KEYS, "checksum_max_delta": 15},
            "checksum_max_delta = 15: VCU_SteerRequestCounter has 15 values, so that no frame",
        ),
        ({"checksum": "maker:nibble", **KEYS}, "maker.py has no 'nibble' (did you mean 'nibbles'"),
        ({"checksum": "makers:nibbles", **KEYS}, "there is no module 'makers'"),
        (
            {"checksum": "maker:nibbles", **KEYS, "e2e": E2E},
            "`checksum` and `e2e` both protect the message; give one of them",
        ),
    ],
)  # fmt: skip # a table
def test_what_does_not_fit_is_refused(tmp_path, own, reason):
    with pytest.raises(ConfigError) as error:
        Simulation(system(tmp_path, **own), isolation="none").close()
    assert reason in str(error.value)
    assert "buses.can0.messages.VCU_SteerRequest" in str(error.value)


def test_another_function_in_the_file_is_another_run_and_a_missing_file_is_said_before_one(tmp_path):
    of = system(tmp_path, checksum="maker:nibbles", **KEYS)
    first, again = prepare(of).digest, prepare(of).digest
    (tmp_path / "maker.py").write_text(SOURCE.replace("8 - total", "7 - total"))
    assert first == again != prepare(of).digest
    (tmp_path / "maker.py").unlink()
    with pytest.raises(ConfigError, match="there is no module 'maker'"):
        prepare(of, runnable=False)  # as `info` does
