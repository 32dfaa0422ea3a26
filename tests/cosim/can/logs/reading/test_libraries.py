"""Logs that python-can reads: TRC and CSV."""

from __future__ import annotations

from pathlib import Path

import can
import pytest

from support.logged import check_survives, frames_in, refused

FRAMES = [
    can.Message(timestamp=1.25, arbitration_id=0x123, is_extended_id=False, data=b"ab", channel=1),
    can.Message(timestamp=2.5, arbitration_id=0x1ABCDEF0, is_extended_id=True, data=bytes(8), channel=1),
]


def written(folder: Path, suffix: str) -> Path:
    path = folder / f"frames{suffix}"
    with can.Logger(path) as log:
        for frame in FRAMES:
            log.on_message_received(frame)
    return path


@pytest.mark.parametrize("suffix", [".trc", ".csv"])
def test_what_python_can_wrote_is_read(tmp_path: Path, suffix: str) -> None:
    found = frames_in(written(tmp_path, suffix))
    assert [f.time - found[0].time for f in found] == [0, 1_250_000_000]
    assert [(f.frame_id, f.extended, f.data) for f in found] == [
        (m.arbitration_id, m.is_extended_id, bytes(m.data)) for m in FRAMES
    ]
    assert len({f.channel for f in found}) == 1


@pytest.mark.parametrize("suffix", [".trc", ".csv"])
def test_damaged_logs_are_read_or_refused(tmp_path: Path, suffix: str) -> None:
    check_survives(tmp_path, suffix, written(tmp_path, suffix).read_bytes())


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (
            "1.0,0x123,0,0,0",
            "after 0 frames: python-can cannot read it as a CSV file of python-can: ValueError",
        ),
        ("nan,0x123,0,0,0,1,YQ==", "frame 1: time nan s, id 0x123, 1 bytes"),
        ("1e300,0x123,0,0,0,1,YQ==", "frame 1: time 1e+300 s"),
    ],
)
def test_what_is_no_frame_is_refused(tmp_path: Path, line: str, said: str) -> None:
    head = "timestamp,arbitration_id,extended,remote,error,dlc,data\n"
    assert refused(tmp_path / "a.csv", head + line + "\n").startswith(said)


@pytest.mark.parametrize(
    ("name", "text", "resolution"),
    [
        ("a.trc", "     1)     1841 0001 8 00 00 00 00 00 00 00 00\n", 10**6),
        ("b.trc", ";$FILEVERSION=1.1\n;$STARTTIME=0\n     1)     1059.9  Rx         0300  1  00\n", 10**5),
        ("a.csv", "timestamp,arbitration_id,extended,remote,error,dlc,data\n1.25,0x1,0,0,0,1,YQ==\n", 10**7),
        ("b.csv", "head\n1700000000.1234567,0x1,0,0,0,1,YQ==\n", 238),
        ("c.csv", "head\n3,0x1,0,0,0,1,YQ==\n", 10**9),
    ],
)
def test_the_digits_of_times_are_known_and_what_a_double_leaves_of_them(
    tmp_path: Path, name: str, text: str, resolution: int
) -> None:
    assert [f.resolution for f in frames_in(tmp_path / name, text)] == [resolution]
