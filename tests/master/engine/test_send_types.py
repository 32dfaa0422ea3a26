"""Messages that are not sent at each cycle: relations between send types, in both engines."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import DATA, System, load_system
from evcosim.master.simulation import Simulation, simulate

NAMES = ("EMD_Status", "VCU_Request", "VCU_State", "BMS_Status", "GRIP_Status")
KINDS = ("on_change", "cyclic_and_on_change", "if_active", "on_write")


def sent(own: dict[str, Any], names: tuple[str, ...] = NAMES, system: Any = "scooter", **bus: Any) -> System:
    """A built-in system with settings of its messages and of its bus."""
    system = load_system(system)
    entry = system.file.buses["can0"]
    messages = dict(entry.messages) | {name: MessageSettings(**own) for name in names}
    changed = entry.model_copy(update={"messages": messages, **bus})
    return dataclasses.replace(system, file=system.file.model_copy(update={"buses": {"can0": changed}}))


def ran(system: System, **options: Any) -> tuple[bytes, dict[str, Any]]:
    """The bits of 3 s, and the counts of frames."""
    results = simulate(system, "fig8", stop_time=3.0, **{"isolation": "none"} | options)
    return results.data.tobytes(), results.manifest["frames"]


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_what_is_sent_on_change_or_on_write_is_seen_as_what_is_sent_at_each_step(algorithm):
    cyclic, _ = ran(sent({"cycle_time": 0.01}), algorithm=algorithm)
    for kind in ("on_change", "on_write"):
        bits, frames = ran(sent({"send_type": kind}), algorithm=algorithm)
        assert bits == cyclic
        count = frames["can0"]["messages"]["VCU_State"]["sent"]
        assert (count == 300) if kind == "on_write" else (1 <= count < 50)


def test_a_mixed_message_is_seen_as_the_same_too_and_comes_each_cycle():
    cyclic, _ = ran(sent({"cycle_time": 0.01}))
    bits, frames = ran(sent({"send_type": "cyclic_and_on_change", "cycle_time": 0.5}))
    assert bits == cyclic
    counts = {name: about["sent"] for name, about in frames["can0"]["messages"].items()}
    assert counts["VCU_State"] >= 6  # every 0.5 s
    assert max(counts.values()) < 300


def test_a_minimum_interval_bounds_how_often():
    bits, frames = ran(sent({"send_type": "on_change", "min_interval": 0.1}))
    assert max(about["sent"] for about in frames["can0"]["messages"].values()) <= 30
    assert bits != ran(sent({"cycle_time": 0.01}))[0]
    at_most = ran(sent({"send_type": "on_write", "min_interval": 0.1}))
    assert at_most[0] == ran(sent({"cycle_time": 0.1}))[0]


def written(engine: str, **own: Any) -> tuple[list[int], np.ndarray, np.ndarray]:
    """The steps at which VCU_Request is sent in 3 s, the throttle of the ecu, which writes it with its steps
    (at 20, 120, 220 ms ...), and that of the vehicle."""
    system = sent({"send_type": "on_write", **own}, ("VCU_Request",))
    ecu = system.file.units["ecu"].model_copy(update={"period": 0.1, "offset": 0.02})
    units = system.file.units | {"ecu": ecu}
    system = dataclasses.replace(system, file=system.file.model_copy(update={"units": units}))
    with Simulation(system, "fig8", log_frames=True, engine=engine, isolation="none") as simulation:
        simulation.step(300)
        frames = [f for log in simulation._engine.frames.log_of("can0").frames for f in log.frames()]
        steps = [end // 10**10 for _, end, message, _ in frames if message.name == "VCU_Request"]
        return steps, simulation.results["ecu.throttle"], simulation.results["vehicle.throttle"]


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize(("interval", "apart"), [(None, 10), (0.03, 10), (0.1, 10), (0.15, 15), (0.27, 27)])
def test_a_unit_writes_at_its_turns_and_what_comes_too_soon_waits_for_the_end_of_the_interval(
    engine, interval, apart
):
    steps, wanted, seen = written(engine, **({} if interval is None else {"min_interval": interval}))
    assert steps == list(range(2, 300, apart))
    assert len(set(wanted[steps].tolist())) > 5
    assert np.abs(seen - wanted)[steps].max() <= 0.2 + 1e-9  # half of the signal's resolution
    changes = np.flatnonzero(np.diff(seen)) + 1
    assert set(changes.tolist()) <= set(steps)


@pytest.mark.parametrize("timing", ["instant", "frame"])
@pytest.mark.parametrize("kind", KINDS)
def test_both_engines_are_equal(kind, timing):
    own: dict[str, Any] = {"send_type": kind, "min_interval": 0.02}
    own |= {"cycle_time": 0.04} if kind in ("cyclic_and_on_change", "if_active") else {}
    system = sent(own, timing=timing, jitter=0.004, bit_error_rate=2e-3, seed=3, delay=0.01, cycle=2)
    assert ran(system, engine="python") == ran(system, engine="compiled")


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("kind", ["on_change", "cyclic_and_on_change", "on_write"])
def test_counters_of_protected_frames_go_on_with_each_frame(kind, engine):
    place = {"crc": "VCU_SteerRequestCrc", "counter": "VCU_SteerRequestCounter"}
    e2e = {"profile": "1A", "data_id": 0x120, **place}
    own: dict[str, Any] = {"send_type": kind, "min_interval": 0.03, "e2e": e2e}
    own |= {"cycle_time": 0.06} if kind == "cyclic_and_on_change" else {}
    system = sent(own, ("VCU_SteerRequest",), system="lane_keeping")
    frames = simulate(system, engine=engine, isolation="none", stop_time=3.0).manifest["frames"]
    about = frames["can0"]["messages"]["VCU_SteerRequest"]
    assert about["rejected"] == 0
    assert set(about["statuses"]) <= {"initial", "ok", "no_new_data"}
    assert about["sent"] > 20


def test_faults_and_timeouts_of_a_message_that_comes_each_cycle(tmp_path):
    own = {"send_type": "cyclic_and_on_change", "cycle_time": 0.05, "timeout": 2, "on_timeout": "initial"}
    (tmp_path / "s.toml").write_text(
        (DATA / "scenarios/scooter/fig8.toml").read_text()
        + '\n[[fault]]\naction = "silence"\ntime = 1.0\nduration = 0.5\nmessage = "can0.EMD_Status"\n'
    )
    runs = []
    for engine in ("python", "compiled"):
        results = simulate(sent(own, ("EMD_Status",)), tmp_path / "s.toml", stop_time=3.0, engine=engine)
        runs.append(results.data.tobytes())
        about = results.manifest["frames"]["can0"]["messages"]["EMD_Status"]
        assert about["timeouts"] == 1
        assert about["silenced"] >= 10
        assert np.any(results["ecu.speed_measured"][110:150] == 0.0)
    assert runs[0] == runs[1]


def test_what_does_not_fit_the_step_or_the_senders_is_refused():
    rules = {
        "is not a multiple of the communication step 0.01 s": {
            "send_type": "on_change",
            "min_interval": 0.015,
        },
        "is longer than the cycle time 0.02 s": {
            "send_type": "if_active",
            "cycle_time": 0.02,
            "min_interval": 0.03,
        },
    }
    for rule, own in rules.items():
        with pytest.raises(ConfigError, match=r"can0\.messages\.EMD_Status\.min_interval") as refused:
            simulate(sent(own, ("EMD_Status",)), stop_time=0.1)
        assert rule in str(refused.value)
