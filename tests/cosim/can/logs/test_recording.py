"""What a log has of the messages that are wanted."""

from __future__ import annotations

import collections
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.logs.reading import blocks
from evcosim.cosim.can.logs.reading.blocks import blocks_of
from evcosim.cosim.can.logs.reading.logged import DATA, REMOTE, LoggedFrame
from evcosim.cosim.can.logs.recording import (
    CHANNEL,
    PAYLOAD,
    TIME,
    VARIANT,
    Span,
    _Tally,
    chosen_channel,
    recorded,
)
from evcosim.cosim.can.logs.variants import Variant, Variants
from evcosim.cosim.errors import ConfigError

LOG = (
    "(1.0) a 123#AABB\n(1.5) b 123#01\n(1.6) a 124#\n(1.25) b 123#0203\n(2.0) a 00000123#0102\n"
    "(0.5) a 123#R\n(2.5) a 123#CCDDEE\n"
)


PAGE = {"multiplexer": "P", "multiplexer_ranges": ((0, 0xCB), (0xCD, 255))}
SIGNALS = {"P": Signal("P", 0, 8), "S": Signal("S", 8, 8, **PAGE)}
MESSAGE = Message("f", "M", 0x123, False, 2, signals=SIGNALS)


def recording(folder: Path, text: str = LOG):
    (folder / "x.log").write_text(text)
    return recorded(folder / "x.log", Variants([(MESSAGE, ["S"])]))


def test_frames_are_kept_with_time_channel_and_payload_and_all_are_counted(tmp_path: Path) -> None:
    found = recording(tmp_path)
    rows = [row for part in found.rows() for row in part.tolist()]
    assert [(row[TIME], row[CHANNEL], row[VARIANT]) for row in rows] == [(10**9, 0, 0), (1_250_000_000, 1, 0)]
    assert rows[0][PAYLOAD:] == [0xBBAA] and found.variants == (Variant("M", ("S",), {"P": 0xAA}),)
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


MORE = [
    Message("f", "A", 0x10, False, 8, signals={"X": Signal("X", 0, 8)}),
    Message("f", "B", 0x11, True, 3, signals={"Y": Signal("Y", 0, 8)}),
]
FRAMES = st.lists(
    st.builds(
        LoggedFrame,
        st.integers(0, 40).map(lambda time: time * 10**8),
        st.sampled_from(["a", "b"]),
        st.sampled_from([0x10, 0x11, 0x12]),
        st.booleans(),
        st.binary(min_size=1, max_size=12),
        st.integers(1, 99),
        st.sampled_from([DATA, DATA, DATA, REMOTE]),
        st.sampled_from([1, 1000]),
    ),
    max_size=25,
)


@given(FRAMES, st.integers(1, 30))
def test_a_recording_in_blocks_is_that_of_single_frames(frames: list[LoggedFrame], stretch: int) -> None:
    variants = Variants([(message, list(message.signals)) for message in MORE])
    tally = _Tally(variants, max, "line")
    rows = []
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(blocks, "STRETCH", stretch)
        for block in blocks_of(frames):
            rows += tally.taken(block, PAYLOAD + 1).tolist()
    good = [f for f in frames if f.kind == DATA]
    assert tally.others == len(frames) - len(good)
    names = list(dict.fromkeys(f.channel for f in good))
    assert list(tally.seen) == list(tally.spans) == names
    wanted = {(0x10, False): (0, 8), (0x11, True): (1, 3)}
    kept = [f for f in good if len(f.data) >= wanted.get((f.frame_id, f.extended), (0, 99))[1]]
    assert [row[:PAYLOAD] for row in rows] == [
        [f.time, names.index(f.channel), wanted[f.frame_id, f.extended][0]] for f in kept
    ]
    assert [row[PAYLOAD].to_bytes(8, "little", signed=True) for row in rows] == [
        f.data[:8].ljust(8, b"\0") for f in kept
    ]
    for name in names:
        own = [f for f in good if f.channel == name]
        times = [f.time for f in own]
        assert tally.spans[name] == Span(min(times), max(times), max(f.resolution for f in own))
        back = [f.place for f, before in zip(own[1:], times, strict=False) if f.time < before]
        assert (name in tally.backward) == bool(back)
        assert not back or tally.backward[name].startswith(f"at line {back[0]} the time goes back from ")
        counts = collections.Counter((f.frame_id, f.extended) for f in own)
        assert {key: seen.frames for key, seen in tally.seen[name].items()} == dict(counts)
        short = [f for f in own if len(f.data) < wanted.get((f.frame_id, f.extended), (0, 0))[1]]
        assert sum(seen.short for seen in tally.seen[name].values()) == len(short)
