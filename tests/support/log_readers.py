"""CAN logs in the programs that read them: the frames of a log as each of them shows it."""

from __future__ import annotations

import dataclasses
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import can

from evcosim.cosim.can.database import Message
from evcosim.cosim.can.logs.frames import Frame
from evcosim.cosim.can.logs.writing import FORMATS, START
from support.needs import give_up, need_module

BUSES = ("can0", "can1")


def _message(frame_id: int, extended: bool = False, length: int = 8, fd: bool = False) -> Message:
    return Message("f", f"M{frame_id:X}", frame_id, extended, length, fd=fd)


FRAMES = [
    Frame(0.0, 0, "can0", _message(0x123), bytes(range(8))),
    Frame(0.01, 0, "can0", _message(0x7FF, length=3), b"\x01\x02\xff"),
    Frame(0.010_123, 1, "can1", _message(0x1ABCDEF0, True), bytes(range(8, 16)), sent=False),
    Frame(0.02, 0, "can0", _message(0x20, length=12, fd=True), bytes(range(12))),
    Frame(12.34, 1, "can1", _message(0x21, True, 64, True), bytes(range(64)), switch=True),
    Frame(12.35, 1, "can1", _message(0, length=0), b""),
]


@dataclasses.dataclass(frozen=True)
class Read:
    """A frame as a program shows it, with what that program shows; times in whole microseconds."""

    time: int
    frame_id: int
    data: bytes
    extended: bool | None = None
    fd: bool | None = None
    switch: bool | None = None
    channel: int | str | None = None
    sent: bool | None = None

    def matches(self, frame: Frame) -> bool:
        expected = {
            "time": round(frame.time * 1e6),
            "frame_id": frame.message.frame_id,
            "data": frame.data,
            "extended": frame.message.extended,
            "fd": frame.fd,
            "switch": frame.switch,
            "sent": frame.sent,
        }
        shown = {k: v for k, v in dataclasses.asdict(self).items() if v is not None and k != "channel"}
        if self.channel is not None and self.channel not in (frame.bus, frame.channel + 1):
            return False
        return all(expected[key] == value for key, value in shown.items())


def python_can(path: Path) -> list[Read]:
    begin = 0.0 if path.suffix == ".asc" else START.timestamp()
    first = 1 if path.suffix in (".asc", ".blf") else 0  # python-can counts from 0 there
    found = []
    with can.LogReader(path) as reader:
        for m in reader:
            channel = m.channel if isinstance(m.channel, str) else int(m.channel or 0) + first
            sent = None if path.suffix == ".log" else not m.is_rx
            time = round((m.timestamp - begin) * 1e6)
            kind = m.is_extended_id, m.is_fd, m.bitrate_switch
            found.append(Read(time, m.arbitration_id, bytes(m.data), *kind, channel, sent))
    return found


def asammdf(path: Path) -> list[Read]:
    with need_module("asammdf").MDF(path) as mdf:
        frames = mdf.get("CAN_DataFrame")
        assert mdf.header.start_time == START
        rows = zip(frames.timestamps.tolist(), frames.samples, strict=True)
        found = []
        for time, row in rows:
            fields = {name.split(".")[1]: row[name] for name in frames.samples.dtype.names}
            data = bytes(fields["DataBytes"][: fields["DataLength"]])
            found.append(
                Read(
                    round(time * 1e6), int(fields["ID"]), data, bool(fields["IDE"]), bool(fields["EDL"]),
                    bool(fields["BRS"]), int(fields["BusChannel"]), bool(fields["Dir"]),
                )
            )  # fmt: skip # fields of a frame
        return found


def _tool(name: str, *arguments: str) -> str:
    if shutil.which(name) is None:
        give_up(f"{name} is not on this machine: apt-get install tshark can-utils")
    return subprocess.run([name, *arguments], capture_output=True, text=True, check=True).stdout


def tshark(path: Path) -> list[Read]:
    fields = ("frame.time_epoch", "can.id", "can.flags.xtd", "can.len", "frame.interface_name", "data.data")
    options = [part for field in fields for part in ("-e", field)]
    lines = _tool("tshark", "-r", str(path), "-T", "fields", *options).splitlines()
    begin, found = START.timestamp(), []
    for line in lines:
        moment, frame_id, extended, length, interface, data = (line.split("\t") + [""] * 6)[:6]
        payload = bytes.fromhex(data.replace(":", ""))
        assert int(length) == len(payload)
        found.append(
            Read(
                round((float(moment) - begin) * 1e6), int(frame_id), payload, extended in ("1", "True"),
                channel=interface if path.suffix == ".pcapng" else None,
            )
        )  # fmt: skip # fields of a frame
    return found


_CLASSIC_LINE = re.compile(r"\s*([\d.]+)\s+(\d)\s+([0-9A-F]+)(x?)\s+[RT]x\s+d \d((?: [0-9A-F]{2})*)")
_FD_LINE = re.compile(
    r"\s*([\d.]+) CANFD\s+(\d) [RT]x\s+([0-9A-F]+)(x?)\s+(\d) \d [0-9a-f]\s+(\d+)((?: [0-9A-F]{2})+)"
)


def log2asc(path: Path) -> list[Read]:
    found = []
    for line in _tool("log2asc", "-I", str(path), *BUSES).splitlines():
        if row := _CLASSIC_LINE.match(line):
            time, frame_id, data = _microseconds(row[1]), int(row[3], 16), bytes.fromhex(row[5])
            found.append(Read(time, frame_id, data, bool(row[4]), False, channel=int(row[2])))
        elif row := _FD_LINE.match(line):
            time, frame_id = _microseconds(row[1]), int(row[3], 16)
            data = bytes.fromhex(row[7])[: int(row[6])]  # the line goes on with other numbers
            found.append(Read(time, frame_id, data, bool(row[4]), True, row[5] == "1", int(row[2])))
    return found


def asc2log(path: Path) -> list[Read]:
    """Read with times from the first frame on: the date of the file needs a locale that few machines have."""
    found: list[Read] = []
    begin = None
    for line in _tool("asc2log", "-I", str(path)).splitlines():
        row = re.match(r"\(([\d.]+)\) can(\d) ([0-9A-F]+)#(#[0-9A-F])?([0-9A-F]*) ([TR])", line)
        assert row is not None, line
        time, data = _microseconds(row[1]), bytes.fromhex(row[5])
        begin = time if begin is None else begin
        kind = len(row[3]) == 8, row[4] is not None, None if row[4] is None else row[4] == "#1"
        found.append(Read(time - begin, int(row[3], 16), data, *kind, int(row[2]) + 1, row[6] == "T"))
    return found


def _microseconds(text: str) -> int:
    whole, _, rest = text.partition(".")
    return int(whole) * 1_000_000 + int(rest)


def written(folder: Path, suffix: str) -> Path:
    path = folder / f"frames{suffix}"
    with open(path, "wb+") as file, FORMATS[suffix](file, BUSES, START) as write:
        for frame in FRAMES:
            write(frame)
    return path


def check(folder: Path, suffix: str, reader: Callable[[Path], list[Read]]) -> None:
    """Raise AssertionError unless a program reads what was sent."""
    found = reader(written(folder, suffix))
    assert len(found) == len(FRAMES)
    for read, frame in zip(found, FRAMES, strict=True):
        assert read.matches(frame), (read, frame)
