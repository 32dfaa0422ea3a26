"""Logs of ASAM MDF 4 with its bus logging, by asammdf: frames go there in blocks, not one by one."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime
from typing import Any, BinaryIO

import numpy as np

from ...errors import ConfigError
from ..timing.lengths import fd_code
from .frames import Frame

NEEDS_LIBRARY = (
    "MF4 logs need the library asammdf: install evcosim with its extra, pip install 'evcosim[mf4]'"
)
"""The error where it is not installed."""
_BLOCK = 50_000  # frames that are kept before they go to asammdf
_BUS, _CAN = 2, 2  # the source of a channel group: a bus, CAN
_NAME = "CAN_DataFrame"
_TYPE = np.dtype(
    [
        (f"{_NAME}.BusChannel", "<u1"),
        (f"{_NAME}.ID", "<u4"),
        (f"{_NAME}.IDE", "<u1"),
        (f"{_NAME}.DLC", "<u1"),
        (f"{_NAME}.DataLength", "<u1"),
        (f"{_NAME}.DataBytes", "(64,)u1"),
        (f"{_NAME}.Dir", "<u1"),
        (f"{_NAME}.EDL", "<u1"),
        (f"{_NAME}.BRS", "<u1"),
        (f"{_NAME}.ESI", "<u1"),
    ]
)


@contextlib.contextmanager
def writing(file: BinaryIO, buses: Sequence[str], start: datetime) -> Iterator[Callable[[Frame], None]]:
    """Give a function that writes a frame. Raises ConfigError where asammdf is not installed."""
    with contextlib.closing(_opened(start)) as mdf:
        waiting: list[Frame] = []
        _append(mdf, [], first=True)

        def write(frame: Frame) -> None:
            if frame.error:
                return  # the group of frames with data has no place for one without
            waiting.append(frame)
            if len(waiting) == _BLOCK:
                _append(mdf, waiting)
                waiting.clear()

        yield write
        if waiting:
            _append(mdf, waiting)
        _say_who(mdf, start)
        packed = io.BytesIO()
        mdf.save(packed, compression=1, add_history_block=False)
        file.write(packed.getbuffer())


def check_library() -> Any:
    """Return the class of MDF files. Raises ConfigError where asammdf is not installed."""
    try:
        from asammdf import MDF
    except ImportError as error:
        raise ConfigError(NEEDS_LIBRARY) from error
    return MDF


def _opened(start: datetime) -> Any:
    mdf = check_library()(version="4.10")
    mdf.header.start_time = start
    return mdf


def _append(mdf: Any, frames: Sequence[Frame], first: bool = False) -> None:
    samples, times = _samples(frames), np.array([frame.time for frame in frames], dtype="<f8")
    if not first:
        mdf.extend(0, [(times, None), (samples, None)])
        return
    from asammdf import Signal
    from asammdf.blocks.source_utils import Source

    source = Source(name="CAN", path="CAN", comment="", source_type=_BUS, bus_type=_CAN)
    mdf.append(Signal(name=_NAME, samples=samples, timestamps=times, source=source), acq_source=source)


def _samples(frames: Sequence[Frame]) -> np.ndarray[Any, Any]:
    """Return the fields of n frames, shape (n,)."""
    rows = np.zeros(len(frames), dtype=_TYPE)
    fields: dict[str, list[int]] = {
        "BusChannel": [frame.channel + 1 for frame in frames],
        "ID": [frame.message.frame_id for frame in frames],
        "IDE": [frame.message.extended for frame in frames],
        "DLC": [fd_code(len(frame.data)) for frame in frames],
        "DataLength": [len(frame.data) for frame in frames],
        "Dir": [frame.sent for frame in frames],
        "EDL": [frame.fd for frame in frames],
        "BRS": [frame.switch for frame in frames],
    }
    for name, values in fields.items():
        rows[f"{_NAME}.{name}"] = values
    data = b"".join(frame.data.ljust(64, b"\0") for frame in frames)
    rows[f"{_NAME}.DataBytes"] = np.frombuffer(data, dtype=np.uint8).reshape(-1, 64)
    return rows


def _say_who(mdf: Any, start: datetime) -> None:
    """Add the entry of the file's history, with the log's start, where asammdf writes the moment of today."""
    from asammdf.blocks.v4_blocks import FileHistory

    entry = FileHistory()
    entry.comment = "<FHcomment><TX>CAN frames of a run</TX><tool_id>evcosim</tool_id></FHcomment>"
    entry.time_stamp = start
    mdf.file_history.append(entry)
