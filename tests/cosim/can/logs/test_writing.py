"""The frame log: other tools read back what the receivers saw, and the same run gives the same bytes."""

from __future__ import annotations

import os
import re
import time
import zlib
from collections.abc import Iterator
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import can
import cantools
import pytest

from evcosim.cosim.can.channel import MessageChannel, SignalRoute
from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.can.logs.frames import BusLog
from evcosim.cosim.can.logs.writing import START, write_can_log
from evcosim.cosim.can.send_steps import send_steps
from evcosim.cosim.can.transmissions import RawLog
from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.units.measure import Affine
from support.databases import EV

STEP = 0.01
CLOCK = Clock.counted(0.0, STEP, 0)
NAMES = ("EMD_Status", "VCU_Request", "BMS_Status", "MCU_Status")
SUFFIXES = (".log", ".asc", ".blf", ".mf4")  # those that python-can reads


class Run:
    """`steps` steps of traffic: each signal of each message from a slot of its own to one of its own."""

    def __init__(self, steps: int, names: tuple[str, ...] = NAMES, skip: tuple[str, ...] = ()) -> None:
        self.memory = memoryview(bytearray(8 * 200)).cast("d")
        self.channels: list[MessageChannel] = []
        self.seen: dict[tuple[str, int], dict[str, float]] = {}
        slot = 0
        for name in names:
            message, routes = load_dbc(EV).messages[name], []
            for signal in message.signals.values():
                if signal.name not in skip:
                    routes.append(SignalRoute(signal, slot, Affine(), ((100 + slot, Affine()),)))
                    slot += 1
            self.channels.append(MessageChannel(message, routes, log_raw=True))
        for k in range(steps):
            for i in range(slot):
                self.memory[i] = (37.3 * k + 91.7 * i) % 253.0 - 20.0
            for channel in self.channels:
                self.send(channel, k)

    def send(self, channel: MessageChannel, k: int) -> None:
        every, first = send_steps(channel.message, STEP)
        if k >= first and (k - first) % every == 0:
            channel.transmit(self.memory, k)
            received = {r.signal.name: self.memory[r.sinks[0][0]] for r in channel.routes}
            self.seen[channel.message.name, k] = received

    def log(self) -> list[BusLog]:
        return [BusLog("can0", [channel.log for channel in self.channels])]


def read(path: Path) -> list[can.Message]:
    """Return the frames, with the time since the log's start; python-can has doubles from 1970 on."""
    with can.LogReader(path) as reader:
        found = list(reader)
    for frame in found if path.suffix != ".asc" else []:
        frame.timestamp -= START.timestamp()
    return found


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_log_decodes_to_what_the_receivers_saw(tmp_path: Path, suffix: str) -> None:
    run, database = Run(40), cantools.database.load_file(EV)
    path = tmp_path / f"frames{suffix}"
    assert write_can_log(path, run.log(), CLOCK) == len(run.seen)
    found = {}
    for frame in read(path):
        message = database.get_message_by_frame_id(frame.arbitration_id)
        k = round(frame.timestamp / STEP)
        assert frame.timestamp == pytest.approx(k * STEP, abs=2e-7)
        assert (frame.dlc, frame.is_extended_id, frame.is_fd) == (message.length, False, False)
        found[message.name, k] = message.decode(frame.data, decode_choices=False)
    assert found == run.seen


def test_a_message_with_a_start_delay_is_logged_when_it_was_sampled(tmp_path: Path) -> None:
    run = Run(5, ("MCU_Status",))  # start delay 5 ms: first sent at 10 ms
    write_can_log(tmp_path / "frames.log", run.log(), Clock.counted(2.0, STEP, 0))
    assert [m.timestamp for m in read(tmp_path / "frames.log")] == pytest.approx([2.01, 2.02, 2.03, 2.04])


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_times_count_from_the_run_s_start_not_from_the_first_frame(tmp_path: Path, suffix: str) -> None:
    write_can_log(tmp_path / f"frames{suffix}", Run(3, ("MCU_Status",)).log(), Clock.counted(5.0, STEP, 0))
    assert [m.timestamp for m in read(tmp_path / f"frames{suffix}")] == pytest.approx([5.01, 5.02], abs=2e-7)


def test_blf_times_are_whole_nanoseconds(tmp_path: Path) -> None:
    path = tmp_path / "frames.blf"
    write_can_log(path, Run(220, ("EMD_Status",)).log(), CLOCK)
    data = path.read_bytes()
    body = zlib.decompress(data[144 + 32 :])  # behind the file's header and that of its one container
    stamps = [int.from_bytes(body[at + 24 : at + 32], "little") for at in range(0, len(body), 48)]
    assert stamps == [k * 10_000_000 for k in range(220)]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_clock_of_a_log_starts_when_it_is_told(tmp_path: Path, suffix: str) -> None:
    path, start = (
        tmp_path / f"frames{suffix}",
        datetime(2026, 5, 4, 14, 30, 0, 250_000, timezone(timedelta(hours=2))),
    )
    write_can_log(path, Run(3, ("EMD_Status",)).log(), CLOCK, start)
    if suffix == ".asc":
        assert "date Mon May 04 12:30:00.250 2026\n" in path.read_text()
        return
    with can.LogReader(path) as reader:
        assert next(iter(reader)).timestamp == pytest.approx(start.timestamp(), abs=1e-6)


def test_a_start_without_a_time_zone_and_times_before_the_start_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"2026-05-04T00:00:00 needs a time zone"):
        write_can_log(tmp_path / "a.log", Run(1).log(), CLOCK, datetime(2026, 5, 4))
    with pytest.raises(ConfigError, match=r"begins at -1\.0 s"):
        write_can_log(tmp_path / "a.log", Run(1).log(), Clock.counted(-1.0, STEP, 0))
    assert not os.listdir(tmp_path)


def test_signals_without_a_connection_are_sent_with_their_start_value(tmp_path: Path) -> None:
    signals = [Signal("S", 0, 8), Signal("T", 8, 8, start_raw=77), Signal("U", 23, 16, little_endian=False)]
    message = Message("f", "M", 0x7F, length=4, signals={s.name: s for s in signals})
    channel = MessageChannel(message, [SignalRoute(signals[0], 0, Affine(), ())], log_raw=True)
    channel.transmit([18.0], 0)
    write_can_log(tmp_path / "frames.log", [BusLog("can0", [channel.log])], CLOCK)
    assert (tmp_path / "frames.log").read_text() == "(946684800.000000) can0 07F#124D0000\n"


def test_floats_and_wide_integers(tmp_path: Path) -> None:
    signals = [Signal("F", 0, 32, is_float=True), Signal("W", 32, 64), Signal("D", 96, 64, is_float=True)]
    message = Message("f", "M", 0x1ABCDEF0, True, 20, signals={s.name: s for s in signals}, fd=True)
    routes = [SignalRoute(s, i, Affine(), ()) for i, s in enumerate(signals)]
    channel = MessageChannel(message, routes, log_raw=True)
    channel.transmit([0.1, 2.0**63 + 2048, 0.1], 0)
    expected = "CDCCCC3D" + (2**63 + 2048).to_bytes(8, "little").hex().upper() + "9A9999999999B93F"
    for suffix in SUFFIXES:
        write_can_log(tmp_path / f"frames{suffix}", [BusLog("can0", [channel.log])], CLOCK)
        (frame,) = read(tmp_path / f"frames{suffix}")
        assert (frame.arbitration_id, frame.is_extended_id, frame.is_fd) == (0x1ABCDEF0, True, True)
        assert frame.data.hex().upper() == expected  # 20 bytes are a length of CAN FD


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_same_run_gives_the_same_bytes_on_another_day_elsewhere(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    write_can_log(first, Run(20).log(), CLOCK)
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    if hasattr(time, "tzset"):
        time.tzset()
    monkeypatch.setattr(time, "time", lambda: 2e9)
    write_can_log(second, Run(20).log(), CLOCK)
    monkeypatch.undo()
    if hasattr(time, "tzset"):
        time.tzset()
    assert first.read_bytes() == second.read_bytes()


def test_asc_has_the_fixed_date_and_nothing_of_today(tmp_path: Path) -> None:
    write_can_log(tmp_path / "frames.asc", Run(2).log(), CLOCK)
    lines = (tmp_path / "frames.asc").read_text().splitlines()
    assert lines[0] == "date Sat Jan 01 00:00:00.000 2000"
    assert lines[3:6] == [
        "// channel 1: can0",
        "Begin Triggerblock Sat Jan 01 00:00:00.000 2000",
        " 0.000000 Start of measurement",
    ]
    assert lines[-1] == "End TriggerBlock"
    assert len(re.findall(r"19\d\d|20\d\d", "\n".join(lines))) == 2


def test_candump_lines_are_those_that_tshark_reads(tmp_path: Path) -> None:
    """can-utils' `candump -L`: time, interface, id#data, and no direction after it."""
    write_can_log(tmp_path / "frames.log", Run(10).log(), CLOCK)
    for line in (tmp_path / "frames.log").read_text().splitlines():
        assert re.fullmatch(r"\(\d+\.\d{6}\) can0 [0-9A-F]{3}#([0-9A-F]{2}){0,8}", line)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_two_buses_keep_apart(tmp_path: Path, suffix: str) -> None:
    drive, body = Run(2, ("VCU_Request",)), Run(2, ("BMS_Status",))
    path = tmp_path / f"frames{suffix}"
    write_can_log(
        path, [BusLog("drive", drive.log()[0].messages), BusLog("body", body.log()[0].messages)], CLOCK
    )
    channels = {m.arbitration_id: m.channel for m in read(path)}
    assert channels == {
        ".log": {0x100: "drive", 0x200: "body"},
        ".mf4": {0x100: 1, 0x200: 2},  # as the file numbers them
    }.get(suffix, {0x100: 0, 0x200: 1})


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_run_without_a_frame_gives_an_empty_log(tmp_path: Path, suffix: str) -> None:
    assert write_can_log(tmp_path / f"frames{suffix}", Run(0).log(), CLOCK) == 0
    assert read(tmp_path / f"frames{suffix}") == []


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_breaks_off_leaves_the_earlier_log(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"frames{suffix}"
    write_can_log(path, Run(3).log(), CLOCK)
    before, logs = path.read_bytes(), Run(5).log()
    broken = [BusLog("can0", [*logs[0].messages, Interrupted(logs[0].messages[0])])]  # type: ignore[list-item]
    with pytest.raises(KeyboardInterrupt):
        write_can_log(path, broken, CLOCK)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
    assert path.read_bytes() == before


class Interrupted:
    """A log that is read up to its second transmission."""

    def __init__(self, log: RawLog) -> None:
        self.message, self._log = log.message, log

    def stretches(self) -> Iterator[tuple[Any, Any]]:
        for steps, raws in self._log.stretches():
            yield steps[:1], {name: raw[:1] for name, raw in raws.items()}
            raise KeyboardInterrupt


def test_other_formats_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigError,
        match=r"frames\.trc: CAN logs are written as \.log, \.asc, \.blf, \.mf4, \.pcapng, not as '\.trc'",
    ):
        write_can_log(tmp_path / "frames.trc", Run(1).log(), CLOCK)
    assert not os.listdir(tmp_path)
