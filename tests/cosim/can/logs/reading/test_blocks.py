"""Frames as columns."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.logs.reading import blocks
from evcosim.cosim.can.logs.reading.blocks import Channels, blocks_of
from evcosim.cosim.can.logs.reading.logged import DATA, ERROR, REMOTE, LoggedFrame

FRAMES = st.builds(
    LoggedFrame,
    st.integers(-(2**62), 2**62),
    st.sampled_from(["can0", "1", "vcan"]),
    st.integers(0, 0x1FFFFFFF),
    st.booleans(),
    st.binary(max_size=64),
    st.integers(1, 2**40),
    st.sampled_from([DATA, REMOTE, ERROR]),
    st.integers(1, 10**9),
)


@given(st.lists(FRAMES, max_size=20))
def test_frames_are_the_same_as_columns(frames: list[LoggedFrame]) -> None:
    stretch, blocks.STRETCH = blocks.STRETCH, 7
    try:
        found = list(blocks_of(frames))
    finally:
        blocks.STRETCH = stretch
    assert [frame for block in found for frame in block.frames()] == frames
    assert len(found) == -(-len(frames) // 7)


def test_names_keep_their_places() -> None:
    channels = Channels()
    assert [channels.place(name) for name in ("b", "a", "b")] == [0, 1, 0]
    assert channels.names == ["b", "a"]
