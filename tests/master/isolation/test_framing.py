"""Frames between two processes: each comes out as it was put in, and nothing longer than it may be."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.master.isolation import framing


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    """Both ends of a connection."""
    one, other = socket.socketpair()
    with one, other:
        yield one, other


@given(st.lists(st.binary(max_size=300), max_size=20))
def test_frames_come_out_as_they_were_put_in(contents: list[bytes]) -> None:
    one, other = socket.socketpair()
    with one, other:
        for content in contents:
            framing.send(one, content)
        assert [framing.receive(other) for _ in contents] == contents


def test_a_frame_longer_than_the_buffers_of_the_system(ends: tuple[socket.socket, socket.socket]) -> None:
    content = bytes(range(256)) * 4096
    assert len(content) == framing.LONGEST
    sending = threading.Thread(target=framing.send, args=(ends[0], content))
    sending.start()
    assert framing.receive(ends[1]) == content
    sending.join()


def test_a_bell_is_a_frame_of_no_bytes(ends: tuple[socket.socket, socket.socket]) -> None:
    ends[0].sendall(framing.BELL)
    assert framing.receive(ends[1]) == b""


def test_a_frame_that_is_too_long_is_not_read(ends: tuple[socket.socket, socket.socket]) -> None:
    framing.send(ends[0], b"x" * 11)
    with pytest.raises(EOFError, match="11 bytes are no frame"):
        framing.receive(ends[1], most=10)


@pytest.mark.parametrize("sent", [b"", b"\x05", b"\x05\0\0\0abc"])
def test_a_connection_that_ends_within_a_frame(
    ends: tuple[socket.socket, socket.socket], sent: bytes
) -> None:
    ends[0].sendall(sent)
    ends[0].close()
    with pytest.raises(EOFError):
        framing.receive(ends[1])


class Tired(Exception):
    """The end of someone's patience."""


def test_impatience_ends_the_wait(ends: tuple[socket.socket, socket.socket]) -> None:
    looks = []

    def impatience() -> None:
        looks.append(1)
        if len(looks) == 3:
            raise Tired

    for end in ends:
        end.settimeout(0.01)
    with pytest.raises(Tired):
        framing.receive(ends[1], impatience=impatience)
    looks.clear()
    with pytest.raises(Tired):  # nobody receives, so that the buffers are full in the end
        framing.send(ends[0], bytes(10_000_000), impatience)
