"""The frames that asammdf finds in a log, in a process of its own."""

from __future__ import annotations

import io
from pathlib import Path

import can
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.logs.reading.blocks import FRAME, Block
from evcosim.cosim.can.logs.reading.logged import DATA, ERROR, REMOTE
from evcosim.cosim.can.logs.reading.mf4_frames import END, frames_of, merged, records_of
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
    found = [f for rows in frames_of(path, stretch=3) for f in Block(rows, ["", "", "2", "3"]).frames()]
    assert {f.channel for f in found if f.kind != REMOTE} == {"2"}
    assert [f.kind for f in found] == [REMOTE if k == 7 else ERROR if k == 9 else DATA for k in range(20)]
    assert [f.data[0] for f in found if f.kind == DATA] == [k for k in range(20) if k not in (7, 9)]
    assert [f.extended for f in found if f.kind == DATA] == [k % 2 == 0 for k in range(20) if k not in (7, 9)]


def test_records_end_with_one_that_says_so() -> None:
    out, rows = io.BytesIO(), np.zeros(3, dtype=FRAME)
    rows["time"] = 5, 6, 7
    records_of([rows[:2], rows[2:]], out)
    found = np.frombuffer(out.getvalue(), dtype=FRAME)
    assert found["time"].tolist() == [5, 6, 7, 0] and found["kind"].tolist() == [0, 0, 0, END]


Streams = st.lists(st.lists(st.lists(st.integers(0, 30), max_size=4), max_size=4), max_size=4)


@given(Streams, st.booleans())
def test_streams_are_merged_by_time_and_each_keeps_its_order(streams, ordered: bool) -> None:
    made = []
    for number, parts in enumerate(streams):
        times = [time for part in parts for time in part]
        times = sorted(times) if ordered else times
        rows = np.zeros(len(times), dtype=FRAME)
        rows["time"], rows["channel"], rows["place"] = times, number, np.arange(len(times))
        ends = np.cumsum([len(part) for part in parts]).tolist()
        made.append(iter(np.split(rows, ends[:-1])))
    found = [row for part in merged(made) for row in part]
    for number, parts in enumerate(streams):
        places = [int(row["place"]) for row in found if row["channel"] == number]
        assert places == list(range(sum(map(len, parts))))
    if ordered:
        times = [int(row["time"]) for row in found]
        assert times == sorted(times)


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
    ((row,),) = frames_of(path)
    (frame,) = Block(np.array([row]), ["", "1"]).frames()
    assert (frame.time, frame.resolution, frame.data) == (round(25e9 * unit), resolution, b"\x07")
