"""CAN logs that drive a run: a unit that is left out is heard from its log as it was heard itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import can
import pytest

from evcosim import ConfigError, Results, Simulation, simulate
from evcosim.cosim.can.logs import recording
from evcosim.cosim.can.logs.reading.logged import DATA
from evcosim.cosim.row_store import RowStore
from support.logged import frames_in
from support.small_bench import DATABASE, SYSTEM

FULL = "[[stimulus]]\nto = 'ecu.speed_bound'\nconstant = 30\n"
REQUEST = "[[stimulus]]\nto = 'ecu.throttle_request'\ntable = [[0, 0], [1, 100]]\n"
HEAD = "leave_out = ['vehicle']\n"
SUFFIXES = {".log": 946684800.0, ".pcapng": 946684800.0, ".asc": 0.0, ".blf": 0.0}
E2E = "[buses.can0.messages.EMD_Status]\ne2e = { profile = '1A', data_id = 7, crc = 'EMD_Crc', counter = 'EMD_Counter' }\n"  # fmt: skip # a table


def system(folder: Path, more: str = "", database: str = DATABASE) -> Path:
    """Return a system of a controller and a vehicle, whose speed comes over a bus.

    `more` are keys of the bus, and tables after them.
    """
    (folder / "bench.dbc").write_text(database)
    path = folder / "bench.toml"
    text = SYSTEM.replace("stop_time = 0.03", "stop_time = 1.0").partition("[[metrics]]")[0]
    text = text.replace('buses = { can0 = { dbc = "bench.dbc" } }\n', "")
    path.write_text(f"{text}[buses.can0]\ndbc = 'bench.dbc'\n{more}")
    return path


def scenario(folder: Path, text: str) -> Path:
    path = folder / "replay.toml"
    path.write_text(text)
    return path


def replay(
    folder: Path, log: str, more: str = "", keys: str = "", of_system: str = "", **options: Any
) -> Results:
    """Return a run of the controller alone, which hears the log."""
    text = f"{HEAD}{FULL}[[stimulus]]\ncan_log = '{log}'\nbus = 'can0'\n{keys}\n{more}"
    return simulate(system(folder, of_system), scenario(folder, text), **options)


def candump(folder: Path, *frames: tuple[float, int], key: str = "148") -> str:
    """Write a log of speeds [km/h] at times [s], and return its name."""
    lines = [f"({time:.6f}) can0 {key}#{speed:02X}00000000000000" for time, speed in frames]
    (folder / "a.log").write_text("\n".join(lines) + "\n")
    return "a.log"


def heard(results: Results) -> list[float]:
    values: list[float] = results["ecu.speed_measured"].tolist()
    return values


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("timing", ["instant", "frame"])
def test_a_unit_that_is_left_out_is_heard_from_its_log_as_itself(
    tmp_path: Path, timing: str, engine: Any
) -> None:
    path = system(tmp_path, f"timing = '{timing}'\njitter = {0.001 if timing == 'frame' else 0.0}\n{E2E}")
    whole = scenario(tmp_path, FULL)
    with Simulation(path, whole, log_frames=True, engine=engine) as run:
        run.run()
        for suffix in SUFFIXES:
            run.write_can_log(tmp_path / f"drive{suffix}")
    for suffix, begin in SUFFIXES.items():
        keys = f"can_log = 'drive{suffix}'\nbus = 'can0'\ntime_offset = {begin}\n"
        alone = simulate(path, scenario(tmp_path, f"{HEAD}{FULL}[[stimulus]]\n{keys}"), engine=engine)
        for name in ("ecu.speed_measured", "ecu.throttle"):
            assert alone[name].tobytes() == run.results[name].tobytes(), suffix
        (made,) = alone.manifest["replays"]
        carried = run.results.manifest["frames"]["can0"]["messages"]["EMD_Status"]["arrived"]
        assert made["messages"] == {"EMD_Status": carried} and made["before"] == 0


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_frame_is_seen_at_the_first_point_at_or_after_its_time(tmp_path: Path, engine: Any) -> None:
    log = candump(tmp_path, (5.0, 1), (5.01, 2), (5.010001, 3), (5.035, 4), (5.0351, 5), (5.05, 6))
    results = replay(tmp_path, log, stop_time=0.07, engine=engine)
    assert heard(results) == [1, 2, 3, 3, 5, 6, 6, 6]
    # the last digit of the log is one of a microsecond, by half of which a time may miss its point
    log = candump(tmp_path, (5.0, 1), (5.016667, 2), (5.033333, 3))
    step = {"step_size": 1 / 60, "stop_time": 3 / 60}
    of_system = "[buses.can0.messages.EMD_Status]\ncycle_time = 0.05\n"
    assert heard(replay(tmp_path, log, of_system=of_system, engine=engine, **step)) == [1, 2, 3, 3]


def test_offsets_and_delays_move_the_log_and_initial_values_stand_before(tmp_path: Path) -> None:
    log = candump(tmp_path, (10.0, 1), (10.02, 2), (10.04, 3))
    assert heard(replay(tmp_path, log, keys="time_offset = 9.98", stop_time=0.06)) == [0, 0, 1, 1, 2, 2, 2]
    results = replay(tmp_path, log, keys="time_offset = 10.01", stop_time=0.04)
    assert heard(results) == [0, 2, 2, 3, 3] and results.manifest["replays"][0]["before"] == 1
    late = replay(tmp_path, log, of_system="delay = 0.01\n", stop_time=0.04)
    assert heard(late) == [0, 1, 1, 2, 2]
    of_system = "[buses.can0.messages.EMD_Status]\ninitial = { EMD_VehicleSpeed = 7.0 }\n"
    later = replay(tmp_path, log, keys="time_offset = 9.98", of_system=of_system, stop_time=0.03)
    assert heard(later) == [7, 7, 1, 1]


FAULTS = {
    "lose": (",count = 2", [1, 1, 1, 4, 5, 5]),
    "silence": (",duration = 0.02", [1, 1, 1, 4, 5, 5]),
    "freeze": (",duration = 0.02", [1, 1, 1, 4, 5, 5]),
    "corrupt": (",duration = 0.02, byte = 0, mask = 16", [1, 18, 19, 4, 5, 5]),
}


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("action", FAULTS)
def test_faults_hit_frames_of_a_log(tmp_path: Path, action: str, engine: Any) -> None:
    keys, expected = FAULTS[action]
    log = candump(tmp_path, *((k / 100, k + 1) for k in range(5)))
    fault = f"fault = [{{ action = '{action}', time = 0.01, message = 'can0.EMD_Status'{keys} }}]\n"
    text = f"{HEAD}{fault}{FULL}[[stimulus]]\ncan_log = '{log}'\nbus = 'can0'\n"
    results = simulate(system(tmp_path), scenario(tmp_path, text), stop_time=0.05, engine=engine)
    assert heard(results) == expected


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_a_node_of_a_log_is_off_the_bus_by_a_fault(tmp_path: Path, engine: Any) -> None:
    log = candump(tmp_path, *((k / 100, k + 1) for k in range(8)))
    fault = "fault = [{ action = 'bus_off', node = 'can0.EMD', time = 0.02, duration = 0.02 }]\n"
    text = f"{HEAD}{fault}{FULL}[[stimulus]]\ncan_log = '{log}'\nbus = 'can0'\n"
    results = simulate(system(tmp_path), scenario(tmp_path, text), stop_time=0.08, engine=engine)
    assert heard(results) == [1, 2, 2, 2, 2, 6, 7, 8, 8]  # it recovers in 2.8 ms
    assert results.manifest["frames"]["can0"]["messages"]["EMD_Status"]["held"] == 3


def test_frames_of_a_log_cannot_be_late(tmp_path: Path) -> None:
    log = candump(tmp_path, (0.0, 1))
    fault = "fault = [{ action = 'delay', message = 'can0.EMD_Status', time = 0.0, by = 0.02 }]\n"
    text = f"{HEAD}{fault}{FULL}[[stimulus]]\ncan_log = '{log}'\nbus = 'can0'\n"
    with pytest.raises(ConfigError, match=r"fault 1\.action: frames of can0\.EMD_Status come from a log"):
        simulate(system(tmp_path), scenario(tmp_path, text))


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("counter", ["runs", "frozen"])
def test_protection_and_timeouts_judge_frames_of_a_log(tmp_path: Path, counter: str, engine: Any) -> None:
    of_system = f"{E2E}timeout = 2\non_timeout = 'sna'\n"
    whole = scenario(tmp_path, FULL)
    with Simulation(system(tmp_path, of_system), whole, log_frames=True, engine="python") as run:
        run.run()
        run.write_can_log(tmp_path / "drive.blf")
    fault = (
        f"action = 'freeze', counter = '{counter}', time = 0.5, duration = 0.05, message = 'can0.EMD_Status'"
    )
    text = f"{HEAD}fault = [{{ {fault} }}]\n{FULL}[[stimulus]]\ncan_log = 'drive.blf'\nbus = 'can0'\n"
    results = simulate(system(tmp_path, of_system), scenario(tmp_path, text), engine=engine)
    found = results.manifest["frames"]["can0"]["messages"]["EMD_Status"]
    if counter == "runs":
        assert (found["rejected"], found["timeouts"]) == (0, 0) and found["statuses"]["ok"] == 99
    else:
        assert (found["rejected"], found["timeouts"]) == (5, 1) and found["statuses"]["repeated"] == 5
        assert heard(results)[52] == 255


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_pages_extended_identifiers_and_can_fd(tmp_path: Path, engine: Any) -> None:
    database = (
        'VERSION ""\nNS_ :\nBS_:\nBU_: A B\n'
        'BO_ 2147483904 Paged: 8 A\n SG_ Page M : 0|8@1+ (1,0) [0|0] "" B\n'
        ' SG_ One m1 : 15|8@0+ (1,0) [0|0] "m/s" B\n SG_ Two m2 : 8|8@1- (1,0) [0|0] "km/h" B\n'
        'BO_ 291 Long: 16 A\n SG_ Far : 96|16@1+ (0.1,0) [0|0] "" B\n'
    )
    lines = ["(0.0) x 00000100#0107", "(0.01) x 00000100#0209", "(0.01) x 123##1" + "00" * 12 + "0A000000"]
    lines = [line + "00" * 6 if "##" not in line else line for line in lines]
    lines += ["(0.02) x 00000100#0304" + "00" * 6, "(0.02) x 100#00"]
    (tmp_path / "a.log").write_text("\n".join(lines))
    to = "to = {'ecu.speed_measured' = 'Paged.One', 'ecu.speed_bound' = 'Paged.Two', 'ecu.acceleration_bound' = 'Long.Far'}"
    path = system(tmp_path, database=database)
    head, _, bus = path.read_text().partition("[[connect]]")
    path.write_text(f"{head}[[connect]]{bus.partition('[[connect]]')[2]}")
    text = f"[[stimulus]]\ncan_log = 'a.log'\nbus = 'can0'\n{to}\n"
    results = simulate(path, scenario(tmp_path, text), stop_time=0.03, engine=engine)
    assert heard(results) == [pytest.approx(7 * 3.6)] * 4
    assert results["ecu.speed_bound"].tolist()[1:] == [9.0] * 3
    assert results["ecu.acceleration_bound"].tolist()[1:] == [1.0] * 3


def paged(folder: Path, status: str) -> Results:
    """Return a run that hears two pages of a message, 0.3 s long, and whose timeout has a status."""
    database = (
        'VERSION ""\nNS_ :\nBS_:\nBU_: A B\nBO_ 256 Paged: 3 A\n'
        ' SG_ Page M : 0|8@1+ (1,0) [0|0] "" B\n SG_ One m1 : 8|8@1+ (1,0) [0|0] "km/h" B\n'
        ' SG_ Two m2 : 8|8@1+ (1,0) [0|0] "km/h" B\n'
    )
    own = f"cycle_time = 0.01\ntimeout = 3\nstatus = ['{status}']\n"
    path = system(folder, f"[buses.can0.messages.Paged]\n{own}", database)
    head, _, bus = path.read_text().partition("[[connect]]")
    path.write_text(f"{head}[[connect]]{bus.partition('[[connect]]')[2]}")
    lines = [f"({k / 100:.2f}) can0 100#0{1 + k % 2}0700" for k in range(31)]
    (folder / "a.log").write_text("\n".join(lines))
    to = "to = {'ecu.speed_measured' = 'Paged.One', 'ecu.speed_bound' = 'Paged.Two'}"
    text = f"[[stimulus]]\ncan_log = 'a.log'\nbus = 'can0'\n{to}\n"
    return simulate(path, scenario(folder, text), stop_time=0.5)


def test_the_pages_of_a_message_of_a_log_have_one_status(tmp_path: Path) -> None:
    status = paged(tmp_path, "ecu.acceleration_bound")["ecu.acceleration_bound"].tolist()
    assert status == [0.0] * status.index(1.0) + [1.0] * (51 - status.index(1.0))
    assert 32 <= status.index(1.0) <= 34  # three cycles after the last frame


def test_a_status_of_a_message_of_a_log_names_a_unit(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"Paged\.status: there is no unit of 'ecuu\.x' \(did you mean"):
        paged(tmp_path, "ecuu.x")


def test_frames_of_a_log_are_received_ones_in_the_log_of_the_run(tmp_path: Path) -> None:
    text = f"{HEAD}{FULL}[[stimulus]]\ncan_log = '{candump(tmp_path, (3.0, 1), (3.0152, 2))}'\nbus = 'can0'\n"
    more = "[[connect]]\nfrom = 'ecu.throttle'\nvia = 'can0.VCU_Request.VCU_ThrottleRequest'\n"
    path = system(tmp_path)
    path.write_text(
        path.read_text().replace('[[connect]]\nfrom = "ecu.throttle"\nto = ["vehicle.throttle"]\n', more)
    )
    with Simulation(path, scenario(tmp_path, text), log_frames=True, stop_time=0.03, to_stop=True) as run:
        run.run()
        run.write_can_log(tmp_path / "out.blf")
    with can.LogReader(tmp_path / "out.blf") as reader:
        found = [(round((m.timestamp - 946684800) * 1e6), m.arbitration_id, m.is_rx) for m in reader]
    assert found == [
        (0, 256, False),
        (0, 328, True),
        (10000, 256, False),
        (15200, 328, True),
        (20000, 256, False),
    ]
    assert all(f.kind == DATA for f in frames_in(tmp_path / "out.blf"))


def test_an_isolated_unit_and_a_log_in_a_file_give_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = candump(tmp_path, *((k / 500, k % 200) for k in range(5000)))
    expected = replay(tmp_path, log, stop_time=10.0)
    isolated = replay(tmp_path, log, stop_time=10.0, isolation="process")
    monkeypatch.setattr(recording, "RowStore", lambda width, **texts: RowStore(width, memory=1000, **texts))
    filed = replay(tmp_path, log, stop_time=10.0)
    for other in (isolated, filed):
        assert all(other[name].tobytes() == expected[name].tobytes() for name in expected.names)
    assert max(heard(expected)) == 195


REFUSED = {
    "bus = 'can0'": ("bus = 'can1'", "stimulus 2.bus: there is no bus 'can1' (did you mean 'can0'?)"),
    "can_log = 'a.log'": ("can_log = 'b.log'", "stimulus 2: there is no file 'b.log'"),
    "#e": ("channel = 'can7'", "stimulus 2.channel: a.log has no channel can7; it has the channels can0 (2 frames)"),
    "#f": ("messages = ['EMD_Stats']", "no message 'EMD_Stats' (did you mean 'EMD_Status'?)"),
    "#g": ("messages = ['VCU_Request']", "no input receives a message of bus can0 that no unit sends, of those in"),
    "#h": ("time_offset = 100", "is within the run, from 0 s to 1 s: its frames are from -95 s to -94.99 s"),
    "#i": ("to = { 'ecu.speed_measurd' = 'EMD_Status.EMD_VehicleSpeed' }", "did you mean 'speed_measured'"),
    "#j": ("to = { 'ecu.speed_measured' = 'EMD_Status.Speed' }", "message 'EMD_Status' has no signal 'Speed'"),
    "#k": ("to = { 'ecu.speed_bound' = 'EMD_Status.EMD_VehicleSpeed' }", "ecu.speed_bound is driven already"),
    "leave_out = ['vehicle']": ("", "stimulus 2: no input receives a message of bus can0 that no unit sends"),
}  # fmt: skip # a key of the scenario, what stands there instead, and what is said


@pytest.mark.parametrize("key", REFUSED)
def test_what_does_not_fit_is_refused_before_the_first_step(tmp_path: Path, key: str) -> None:
    candump(tmp_path, (5.0, 1), (5.01, 2))
    text = f"{HEAD}{FULL}[[stimulus]]\ncan_log = 'a.log'\nbus = 'can0'\n#e\n#f\n#g\n#h\n#i\n#j\n#k\n"
    instead, said = REFUSED[key]
    assert key in text
    stimulus = scenario(tmp_path, text.replace(key, instead))
    if key == "#k":
        text = text.replace(FULL, "")
    with pytest.raises(ConfigError) as caught:
        simulate(system(tmp_path), stimulus)
    assert said in str(caught.value).replace(f"{tmp_path}/", "")


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("(1.0) can0 149#0000000000000000", "of the 1 frames of channel can0 none is one of the messages that would be replayed: EMD_Status (0x148, 8 bytes); 0 frames have an identifier of bench.dbc"),
        ("(1.0) can0 148#0000", "EMD_Status has 2 bytes there, not 8; 1 frames have an identifier of bench.dbc"),
        ("(1.0) can0 00000148#0000000000000000", "none is one of the messages"),
        ("(1.0) can0 148#R", "a.log has no frame with data"),
        ("", "a.log has no frame with data"),
        ("(1.0) a 148#0000000000000000\n(1.0) b 148#0000000000000000", "a.log has several channels, and none is named can0: a (1 frames), b (1 frames)"),
        ("(1.0) can0 148#0000000000000000\n(0.5) can0 100#0000", "a.log: channel can0: at line 2 the time goes back from 1 s to 0.5 s"),
        ("(1.0) can0 148#0000000000000000\n(junk", "a.log: line 2: no line of candump -L"),
    ],
)  # fmt: skip # one line for each
def test_logs_that_do_not_fit_are_refused(tmp_path: Path, lines: str, said: str) -> None:
    (tmp_path / "a.log").write_text(lines)
    with pytest.raises(ConfigError) as caught:
        replay(tmp_path, "a.log")
    assert said in str(caught.value).replace(f"{tmp_path}/", "")


def test_what_is_not_replayed_is_said_with_its_number(tmp_path: Path) -> None:
    log = candump(tmp_path, (0.0, 1), (0.1, 2))
    with (tmp_path / log).open("a") as file:
        file.write("(0.11) can0 148#00\n(0.12) can0 7FF#00\n(0.13) other 7FE#00\n")
    warnings = " ".join(replay(tmp_path, log, keys="channel = 'can0'").manifest["warnings"])
    assert "a.log: 1 frames have 1 identifiers that" in warnings and "does not have: 0x7ff (1)" in warnings
    assert "1 of 3 frames of EMD_Status have fewer than its 8 bytes, 1 at least" in warnings
    assert (
        "ends at 0.13 s of the run's time" not in warnings
    )  # 0.5 s from one frame to the next, of two in 1 s
    assert "a.log ends at 0.13 s of the run's time, 9.87 s before the stop time" not in warnings
    long = " ".join(
        replay(tmp_path, candump(tmp_path, *((k / 100, 1) for k in range(20)))).manifest["warnings"]
    )
    assert "a.log ends at 0.19 s of the run's time, 0.81 s before the stop time: the last values hold" in long


def test_ideal_buses_have_no_frames(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="with ideal buses there are no frames"):
        replay(tmp_path, candump(tmp_path, (0.0, 1)), ideal=True)


def test_the_settings_of_a_run_have_the_log_in_them(tmp_path: Path) -> None:
    first = replay(tmp_path, candump(tmp_path, (0.0, 1)), stop_time=0.01)
    second = replay(tmp_path, candump(tmp_path, (0.0, 2)), stop_time=0.01)
    assert first.manifest["settings"] != second.manifest["settings"]


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("own", ["", "timeout = 3\n"])
def test_the_delay_of_a_bus_acts_on_what_units_send_beside_a_log(
    tmp_path: Path, own: str, engine: Any
) -> None:
    """Frames of the log, whose identifier wins the bus, change nothing for those of the run."""
    path = system(tmp_path, "delay = 0.02\n", DATABASE.replace("256", "400"))
    text = path.read_text().replace('via = "can0.EMD_Status.EMD_VehicleSpeed"\n', "")
    text = text.replace(
        'to = ["vehicle.throttle"]', 'to = ["vehicle.throttle"]\nvia = "can0.VCU_Request.VCU_ThrottleRequest"'
    )
    path.write_text(f"{text}[buses.can0.messages.VCU_Request]\n{own}")
    expected = simulate(path, scenario(tmp_path, REQUEST + FULL), engine=engine)
    log = candump(tmp_path, *((k / 100, 30) for k in range(101)))
    to = "to = { 'ecu.speed_bound' = 'EMD_Status.EMD_VehicleSpeed' }\n"
    text = f"{REQUEST}[[stimulus]]\ncan_log = '{log}'\nbus = 'can0'\ntime_offset = 0.02\n{to}"
    beside = simulate(path, scenario(tmp_path, text), engine=engine)
    bound = beside["ecu.speed_bound"].tolist()
    assert bound[2:] == [30.0] * 99  # the log has its delay as well
    sent, got = beside["ecu.throttle"], beside["vehicle.throttle"]
    assert len(set(sent.tolist())) > 20 and got[:5].tolist() == pytest.approx([0, 0, 0, 1.2, 2])
    assert got[10:].tobytes() == expected["vehicle.throttle"][10:].tobytes()


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("timing", ["instant", "frame"])
@pytest.mark.parametrize("cycle", [2, 3])
def test_a_watch_of_frames_of_a_log_counts_the_cycles_of_the_bus(
    tmp_path: Path, cycle: int, timing: str, engine: Any
) -> None:
    of_system = f"cycle = {cycle}\ntiming = '{timing}'\n{E2E}timeout = 1\non_timeout = 'sna'\n"
    with Simulation(system(tmp_path, of_system), scenario(tmp_path, REQUEST + FULL), log_frames=True) as run:
        run.run()
        run.write_can_log(tmp_path / "drive.blf")
    text = f"{HEAD}{REQUEST}{FULL}[[stimulus]]\ncan_log = 'drive.blf'\nbus = 'can0'\ntime_offset = 0.0\n"
    alone = simulate(tmp_path / "bench.toml", scenario(tmp_path, text), engine=engine)
    before, found = (
        each.manifest["frames"]["can0"]["messages"]["EMD_Status"] for each in (run.results, alone)
    )
    assert found.get("timeouts", 0) == before.get("timeouts", 0) == 0
    assert found["statuses"] == before["statuses"]
    assert heard(alone) == heard(run.results) and max(heard(alone)) > 2  # it moves


def test_what_comes_on_a_change_has_no_cycle_in_a_log_either(tmp_path: Path) -> None:
    log = candump(tmp_path, *((t / 100, 1 + t) for t in (0, 1, 50)))
    of_system = "[buses.can0.messages.EMD_Status]\nsend_type = 'on_change'\n"
    with pytest.raises(ConfigError, match=r"EMD_Status\.timeout: a message that is sent on_change does not"):
        replay(tmp_path, log, of_system=f"{of_system}timeout = 2\n")
    database = DATABASE.replace('BA_ "GenSigSNA"', 'BA_ "GenMsgCycleTime" BO_ 328 0;\nBA_ "GenSigSNA"', 1)
    of_system = f"{E2E}send_type = 'on_change'\n"
    with Simulation(
        system(tmp_path, of_system, database), scenario(tmp_path, REQUEST + FULL), log_frames=True
    ) as run:
        run.run()
        run.write_can_log(tmp_path / "drive.blf")
    text = f"{HEAD}{REQUEST}{FULL}[[stimulus]]\ncan_log = 'drive.blf'\nbus = 'can0'\ntime_offset = 0.0\n"
    alone = simulate(tmp_path / "bench.toml", scenario(tmp_path, text))
    before, found = (
        each.manifest["frames"]["can0"]["messages"]["EMD_Status"] for each in (run.results, alone)
    )
    assert found["statuses"] == before["statuses"] and found["statuses"]["ok"] < 20
    assert heard(alone) == heard(run.results) and max(heard(alone)) > 2  # it moves


def test_a_resolution_of_the_bus_makes_no_log_and_changes_none(tmp_path: Path) -> None:
    log = candump(tmp_path, (0.0, 7), (0.01, 9))
    results = replay(tmp_path, log, of_system="resolution = 4.0\n", stop_time=0.02)
    assert heard(results) == [7, 9, 9]
    assert any(
        "buses.can0.resolution = 4 does not act on frames of a log" in text
        for text in results.manifest["warnings"]
    )
    with Simulation(system(tmp_path, "resolution = 4.0\n"), scenario(tmp_path, FULL), log_frames=True) as run:
        run.run()
        with pytest.raises(
            ConfigError, match=r"bench\.toml: buses\.can0\.resolution = 4: .* no log is written"
        ):
            run.write_can_log(tmp_path / "out.log")
    assert not (tmp_path / "out.log").exists()


@pytest.mark.parametrize("offset", ["9.3e9", "-1e300", "1.7e12"])
def test_an_offset_that_no_log_has_is_refused_with_its_limits(tmp_path: Path, offset: str) -> None:
    log = candump(tmp_path, (0.0, 1))
    with pytest.raises(ConfigError, match=r"stimulus 2\.time_offset = .*from -4\.6e\+09 to 4\.6e\+09 s"):
        replay(tmp_path, log, keys=f"time_offset = {offset}")


def test_the_times_that_are_said_of_a_log_are_those_of_its_channel(tmp_path: Path) -> None:
    log = tmp_path / candump(tmp_path, *((k / 100, 1) for k in range(20)))
    log.write_text(log.read_text() + "(900.000000) other 7FF#00\n")
    found = replay(tmp_path, "a.log", keys="channel = 'can0'").manifest
    assert "a.log ends at 0.19 s of the run's time" in " ".join(found["warnings"])
    assert (found["replays"][0]["first"], found["replays"][0]["last"]) == (0.0, 0.19)


def test_two_channels_of_a_log_count_from_its_first_frame(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text("(5.000000) other 7FF#00\n(5.250000) can0 148#0A00000000000000\n")
    found = replay(tmp_path, "a.log", keys="channel = 'can0'")
    (about,) = found.manifest["replays"]
    assert (about["offset"], about["first"], about["last"]) == (5.0, 0.25, 0.25)
    assert next(k for k, value in enumerate(heard(found)) if value) == 25


@pytest.mark.parametrize(
    ("digits", "said"),
    [(6, ""), (4, ""), (3, "rounded to 0.001 s, and a step takes 0.01 s: about 5 % of its frames are seen")],
)
def test_times_that_are_rounded_to_a_part_of_the_step_are_told(
    tmp_path: Path, digits: int, said: str
) -> None:
    lines = [f"({k / 100:.{digits}f}) can0 148#0100000000000000" for k in range(100)]
    (tmp_path / "a.log").write_text("\n".join(lines))
    manifest = replay(tmp_path, "a.log").manifest
    told = [text for text in manifest["warnings"] if "rounded to" in text]
    assert len(told) == bool(said) and said in "".join(told)
    assert manifest["replays"][0]["resolution"] == pytest.approx(10.0**-digits)


def test_an_asc_log_that_was_cut_off_is_a_warning(tmp_path: Path) -> None:
    text = "Begin Triggerblock\n 0.500000 1 148 Rx d 8 0A 00 00 00 00 00 00 00\n"
    (tmp_path / "a.asc").write_text(text)
    warnings = " ".join(replay(tmp_path, "a.asc").manifest["warnings"])
    assert 'a.asc: the "Begin Triggerblock" in line 1 has no "End TriggerBlock": the log was cut' in warnings
    (tmp_path / "a.asc").write_text(f"{text}End TriggerBlock\n")
    assert "Triggerblock" not in " ".join(replay(tmp_path, "a.asc").manifest["warnings"])
