"""What a log has of the messages that are wanted."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.can.logs.recording import CHANNEL, TIME, VARIANT, Span, chosen_channel, recorded
from evcosim.cosim.errors import ConfigError

LOG = (
    "(1.0) a 123#AABB\n(1.5) b 123#01\n(1.6) a 124#\n(1.25) b 123#0203\n(2.0) a 00000123#0102\n"
    "(0.5) a 123#R\n(2.5) a 123#CCDDEE\n"
)


def recording(folder: Path, text: str = LOG):
    (folder / "x.log").write_text(text)
    return recorded(folder / "x.log", {(0x123, False): 2}, lambda key, data: None if data[0] == 0xCC else 5)


def test_frames_are_kept_with_time_channel_and_payload_and_all_are_counted(tmp_path: Path) -> None:
    found = recording(tmp_path)
    rows = [row for part in found.rows() for row in part.tolist()]
    assert [(row[TIME], row[CHANNEL], row[VARIANT]) for row in rows] == [(10**9, 0, 5), (1_250_000_000, 1, 5)]
    assert rows[0][3] == 0xBBAA and rows[0][4:] == [0] * 7
    assert found.spans == {
        "a": Span(10**9, 2_500_000_000, 10**8),
        "b": Span(1_250_000_000, 1_500_000_000, 10**7),
    }
    assert (found.first, found.others) == (10**9, 1)
    seen = found.seen["a"][0x123, False]
    assert (seen.frames, seen.short) == (2, 0)  # one is kept by nobody, and seen
    short = found.seen["b"][0x123, False]
    assert (short.frames, short.short, short.least) == (2, 1, 1)
    assert found.backward == {"b": "at line 4 the time goes back from 1.5 s to 1.25 s"}
    assert found.count("a") == 4


def test_a_channel_is_the_wanted_one_the_only_one_or_that_of_the_bus(tmp_path: Path) -> None:
    found = recording(tmp_path)
    assert chosen_channel(found, None, "b", "here") == "b"
    assert chosen_channel(found, "a", "b", "here") == "a"
    with pytest.raises(ConfigError, match=r"here: .*has several channels, and none is named c: a \(4 fr"):
        chosen_channel(found, None, "c", "here")
    with pytest.raises(ConfigError, match=r"here\.channel: .*has no channel 1; it has the channels a"):
        chosen_channel(found, 1, "b", "here")
    assert chosen_channel(recording(tmp_path, "(1.0) z 001#\n"), None, "b", "here") == "z"
    with pytest.raises(ConfigError, match="has no frame with data"):
        chosen_channel(recording(tmp_path, ""), None, "b", "here")
