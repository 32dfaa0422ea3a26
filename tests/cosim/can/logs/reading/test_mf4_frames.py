"""The frames that asammdf finds in a log, in a process of its own."""

from __future__ import annotations

import io
from pathlib import Path

import can
import numpy as np
import pytest

from evcosim.cosim.can.logs.reading.logged import DATA, ERROR, REMOTE, LoggedFrame
from evcosim.cosim.can.logs.reading.mf4_frames import RECORD, frames_of, records_of
from support.needs import need_module


def test_groups_of_frames_are_one_stream_in_stretches(tmp_path: Path) -> None:
    need_module("asammdf")
    path = tmp_path / "a.mf4"
    with can.MF4Writer(path) as log:
        for k in range(20):
            log.on_message_received(
                can.Message(
                    timestamp=k / 100, arbitration_id=k, data=bytes([k]), channel=2,
                    is_extended_id=k % 2 == 0,
                    is_remote_frame=k == 7, is_error_frame=k == 9,
                )
            )  # fmt: skip # a frame
    found = list(frames_of(path, stretch=3))
    assert [f.kind for f in found] == [REMOTE if k == 7 else ERROR if k == 9 else DATA for k in range(20)]
    assert [f.data[0] for f in found if f.kind == DATA] == [k for k in range(20) if k not in (7, 9)]
    assert [f.extended for f in found if f.kind == DATA] == [k % 2 == 0 for k in range(20) if k not in (7, 9)]


def test_records_end_with_one_that_says_so() -> None:
    out = io.BytesIO()
    records_of(iter([LoggedFrame(-5, "3", 0x123, True, b"abc", 7, REMOTE)]), out)
    (row, last) = np.frombuffer(out.getvalue(), dtype=RECORD)
    fields = [
        int(row[name]) for name in ("time", "place", "id", "channel", "extended", "kind", "length", "end")
    ]
    assert fields == [-5, 7, 0x123, 3, 1, REMOTE, 3, 0]
    assert row["data"].tobytes() == b"abc".ljust(64, b"\0") and last["end"] == 1


@pytest.mark.parametrize(("unit", "resolution"), [(1e-5, 10_000), (1e-9, 1), (1e-10, 1)])
def test_times_that_count_units_are_as_exact_as_these(tmp_path: Path, unit: float, resolution: int) -> None:
    need_module("asammdf")
    from asammdf import MDF, Signal
    from asammdf.blocks.v4_blocks import ChannelConversion

    path = tmp_path / "a.mf4"
    fields = [("ID", "<u4"), ("DataLength", "u1"), ("DataBytes", "(1,)u1")]
    samples = np.array([(0x123, 1, [7])], [(f"CAN_DataFrame.{name}", kind) for name, kind in fields])
    with MDF(version="4.10") as mdf:
        mdf.append(Signal(name="CAN_DataFrame", samples=samples, timestamps=np.array([25], dtype="<u8")))
        times = mdf.groups[0].channels[mdf.masters_db[0]]
        times.conversion = ChannelConversion(conversion_type=1, a=unit, b=0.0)
        mdf.save(path)
    (frame,) = frames_of(path)
    assert (frame.time, frame.resolution, frame.data) == (round(25e9 * unit), resolution, b"\x07")
