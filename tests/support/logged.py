"""Logs that evcosim has written, and read again by evcosim; and what it says of damaged ones."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evcosim.cosim.can.logs.reading.blocks import FRAME, Channels
from evcosim.cosim.can.logs.reading.files import logged_frames
from evcosim.cosim.can.logs.reading.lines import Lines
from evcosim.cosim.can.logs.reading.logged import LoggedFrame
from evcosim.cosim.can.logs.writing import START
from evcosim.cosim.errors import ConfigError
from support.log_readers import FRAMES, written

_ABSOLUTE = (".log", ".pcapng")  # times from 1970 on, else from the start of the log
_NAMED = (".log", ".pcapng")  # channels have names, else numbers


def frames_in(path: Path, text: str | bytes | None = None) -> list[LoggedFrame]:
    """Return the frames of a log, written before if a content is given."""
    if text is not None:
        path.write_bytes(text.encode() if isinstance(text, str) else text)
    with logged_frames(path) as frames:
        return list(frames)


def check_reads_what_was_written(folder: Path, suffix: str) -> None:
    """Raise AssertionError unless time, channel, identifier and bytes of each frame are what was sent."""
    found = frames_in(written(folder, suffix))
    begin = round(START.timestamp()) * 10**9 if suffix in _ABSOLUTE else 0
    for read, frame in zip(found, FRAMES, strict=True):
        channel = frame.bus if suffix in _NAMED else str(frame.channel + 1)
        assert read[:5] == (
            begin + round(frame.time * 1e9), channel, frame.message.frame_id, frame.message.extended,
            frame.data,
        )  # fmt: skip # the fields of a frame


def check_same_one_by_one(reader: Any, path: Path, text: str) -> None:
    """Raise AssertionError unless a text is read as it is line by line, or refused in the same words."""
    path.write_bytes(text.encode())

    def found() -> list[LoggedFrame] | str:
        try:
            return frames_in(path)
        except ConfigError as error:
            return str(error)

    def unusual(lines: Lines, channels: Channels) -> tuple[Any, Any]:
        return np.zeros(len(lines), dtype=FRAME), np.zeros(len(lines), dtype=np.bool_)

    in_bulk = found()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(reader, "_usual", unusual)
        assert in_bulk == found(), text


def refused(path: Path, content: str | bytes) -> str:
    """Return what is said of a damaged log."""
    with pytest.raises(ConfigError) as caught:
        frames_in(path, content)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    return said.removeprefix(f"{path}: ")


def check_survives(folder: Path, suffix: str, good: bytes, rounds: int = 150) -> None:
    """Raise AssertionError where a damaged log is neither read nor refused with its name."""
    draw, path = random.Random(suffix), folder / f"damaged{suffix}"
    for _ in range(rounds):
        content = bytearray(good)
        for _ in range(draw.choice((1, 1, 3, 20))):
            content[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
        if draw.random() < 0.2:
            del content[draw.randrange(len(content)) :]
        try:
            frames_in(path, bytes(content))
        except ConfigError as error:
            assert str(error).startswith(f"{path}: ")
