"""Vector's binary logs."""

from __future__ import annotations

import struct
import tempfile
import zlib
from pathlib import Path

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.logs.reading import blf
from evcosim.cosim.can.logs.reading.logged import DATA, ERROR, REMOTE
from evcosim.cosim.errors import ConfigError
from support.log_readers import written
from support.logged import check_reads_what_was_written, check_survives, frames_in, refused

HEADER = struct.pack("<4sL8xQ", b"LOGG", 144, 0).ljust(144, b"\0")


def one(kind: int, body: bytes, version: int = 1, time: int = 5, flags: int = 2) -> bytes:
    """Return an object of a frame."""
    head = struct.pack("<LHHQ", flags, 0, 0, time) + (b"" if version == 1 else bytes(8))
    length = 16 + len(head) + len(body)
    return struct.pack("<4sHHLL", b"LOBJ", 16 + len(head), version, length, kind) + head + body


def contained(content: bytes, method: int = 2) -> bytes:
    """Return a container of objects."""
    packed = zlib.compress(content) if method == 2 else content
    body = struct.pack("<H6xL4x", method, len(content)) + packed
    made = struct.pack("<4sHHLL", b"LOBJ", 16, 1, 16 + len(body), 10) + body
    return made + bytes(len(made) % 4)


CLASSIC = struct.pack("<HBBL8s", 3, 1, 4, 0x123, b"abcdefgh")


def test_what_was_written_is_read(tmp_path: Path) -> None:
    check_reads_what_was_written(tmp_path, ".blf")


def test_many_containers_are_read_as_python_can_reads_them(tmp_path: Path) -> None:
    path = tmp_path / "a.blf"
    with can.BLFWriter(path) as log:
        for k in range(9000):  # objects go on from one container to the next
            log.on_message_received(
                can.Message(
                    timestamp=1e9 + k / 1000, arbitration_id=k % 2048, is_extended_id=k % 3 == 0,
                    channel=k % 2,
                    data=k.to_bytes(4, "big") * (8 if k % 5 == 0 else 1), is_fd=k % 5 == 0,
                    is_remote_frame=k % 7 == 6 and k % 5 != 0, is_error_frame=k % 11 == 10,
                )
            )  # fmt: skip # a frame
    with can.BLFReader(path) as reader:
        expected = list(reader)
    found = frames_in(path)
    for ours, theirs in zip(found, expected, strict=True):
        assert ours.channel == str(theirs.channel + 1)
        assert ours.kind == (ERROR if theirs.is_error_frame else REMOTE if theirs.is_remote_frame else DATA)
        if ours.kind == DATA:
            read = ours.frame_id, ours.extended, ours.data
            assert read == (theirs.arbitration_id, theirs.is_extended_id, bytes(theirs.data))
            assert ours.time == pytest.approx((theirs.timestamp - 1e9) * 1e9, abs=200)


def test_objects_of_other_writers(tmp_path: Path) -> None:
    """Headers of version 2, steps of 10 us, containers without compression, objects outside of containers."""
    fd = struct.pack("<BBBBLLLLLLLHBBL", 2, 9, 12, 0, 0x80000077, 0, 0x1000, 0, 0, 0, 0, 0, 1, 0, 0)
    content = one(86, CLASSIC, version=2) + one(1, CLASSIC, flags=1, time=7) + one(101, fd + b"0123456789ab")
    (a, b, c, d, e) = frames_in(
        tmp_path / "a.blf",
        HEADER + contained(content, method=0) + one(65, b"a comment!!") + bytes(3) + one(1, CLASSIC)
        + contained(one(101, fd + b"short")),
    )  # fmt: skip # the parts of a file
    assert a[:5] == (5, "3", 0x123, False, b"abcd") and d[:5] == a[:5]
    assert b.time == 70_000
    assert c[1:5] == ("2", 0x77, True, b"0123456789ab")
    assert e.data == b"short".ljust(12, b"\0")  # as CANoe fills it up


def test_a_log_that_is_cut_off_is_refused_with_the_place(tmp_path: Path) -> None:
    good = written(tmp_path, ".blf").read_bytes()
    assert refused(tmp_path / "a.blf", good[:-50]) == (
        f"byte {len(good) - 50}: the BLF log is cut off: the file has {len(good) - 50} of the {len(good)} "
        "bytes that its header tells"
    )
    unknown = good[:16] + bytes(8) + good[24:]  # a logger that lost its power tells no length
    assert "bytes are left of an object of" in refused(tmp_path / "a.blf", unknown[:-50])
    part = one(1, CLASSIC)
    assert "the last object has" in refused(tmp_path / "a.blf", HEADER + contained(part + part[:20]))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "byte 0: the file does not begin as a BLF log does, with LOGG"),
        (b"LOGG", "byte 0: the file does not begin as a BLF log does, with LOGG"),
        (HEADER + bytes(40), "byte 144: there is no object of a BLF log: the file is damaged"),
        (HEADER + contained(one(1, CLASSIC), 3), "byte 144: a container is compressed by method 3, not"),
        (HEADER + contained(one(1, CLASSIC[:5])), "byte 144: a frame (object 1) is damaged: "),
        (HEADER + contained(one(1, CLASSIC) + b"junk and more junk"), "byte 144: no object at byte 48 of"),
        (HEADER + contained(one(1, CLASSIC, time=2**63)), "byte 144: a frame (object 1) is damaged: a time"),
    ],
)  # fmt: skip # one line for each
def test_damaged_logs_say_where(tmp_path: Path, content: bytes, said: str) -> None:
    assert refused(tmp_path / "a.blf", content).startswith(said)


def test_a_container_that_unpacks_to_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(blf, "_LARGEST", 1000)
    said = refused(tmp_path / "a.blf", HEADER + contained(bytes(5000)))
    assert said == "byte 144: a container unpacks to more than 1000 bytes"


def test_damaged_compressed_bytes_are_refused(tmp_path: Path) -> None:
    good = bytearray(HEADER + contained(one(1, CLASSIC) * 20))
    good[-8] ^= 255
    assert "byte 144: a container cannot be unpacked: " in refused(tmp_path / "a.blf", bytes(good))


def test_flipped_bits_are_read_or_refused(tmp_path: Path) -> None:
    check_survives(tmp_path, ".blf", written(tmp_path, ".blf").read_bytes())
    check_survives(tmp_path, ".blf", HEADER + contained(one(1, CLASSIC) * 20, method=0))


def test_the_unit_of_times_is_that_of_the_flags(tmp_path: Path) -> None:
    content = HEADER + one(1, CLASSIC, flags=1) + one(1, CLASSIC, flags=2)
    assert [(f.time, f.resolution) for f in frames_in(tmp_path / "a.blf", content)] == [
        (50_000, 10_000),
        (5, 1),
    ]


OBJECTS = st.builds(
    lambda kind, frame, time, flags, version, count: [
        (kind, frame, version, time + i, flags) for i in range(count)
    ],
    st.sampled_from([1, 86, 1, 2, 100, 65]),
    st.builds(
        lambda channel, flags, count, key, data: struct.pack("<HBBL8s", channel, flags, count, key, data),
        st.integers(1, 3),
        st.sampled_from([0, 1, 0x80]),
        st.sampled_from([0, 3, 8, 9, 64, 200]),
        st.sampled_from([0x123, 0x9ABCDEF0, 0x7FFFFFFF]),
        st.binary(min_size=8, max_size=8),
    ),
    st.sampled_from([0, 5, 10**15, 2**62 - 9, 2**63]),
    st.sampled_from([0, 1, 2]),
    st.sampled_from([1, 2, 3]),
    st.integers(1, 9),
)


@given(st.lists(OBJECTS, max_size=5), st.booleans())
def test_objects_in_bulk_are_those_one_by_one(groups, in_container: bool) -> None:
    content = b"".join(one(*each) for group in groups for each in group)
    content = HEADER + (contained(content) if in_container else content)
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patched:
        path = Path(folder) / "a.blf"
        path.write_bytes(content)

        def found():
            try:
                return frames_in(path)
            except ConfigError as error:
                return str(error)

        in_bulk = found()
        patched.setattr(blf, "_FEW", 10**9)
        assert in_bulk == found()
