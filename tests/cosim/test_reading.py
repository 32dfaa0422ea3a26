"""Files are read; what has no end, or is none, is refused at once."""

from __future__ import annotations

import os
import resource
from pathlib import Path

import pytest

from evcosim.cosim import reading
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.visible import visible
from support.forked import forked
from support.needs import need_linux


def test_a_file_is_read_whole(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"\0text\r\n" * 1000)
    assert reading.content(path) == b"\0text\r\n" * 1000


def test_a_small_file_takes_little_memory(tmp_path: Path) -> None:
    need_linux()
    path = tmp_path / "file"
    path.write_bytes(b"text")

    def within() -> bytes:
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + 10_000_000, resource.RLIM_INFINITY))
        return reading.content(path)

    assert forked(within).value == b"text"


def test_what_is_no_file_is_refused_naming_it(tmp_path: Path) -> None:
    refused = {tmp_path: "it is a folder", tmp_path / "none": "No such file", Path("a\0b"): "it has a NUL"}
    if os.name == "posix":
        os.mkfifo(tmp_path / "pipe")  # of which nobody writes the other end
        refused |= {tmp_path / "pipe": "a pipe or a device", Path("/dev/zero"): "a pipe or a device"}
    for path, why in refused.items():
        with pytest.raises(ConfigError) as caught:
            reading.content(path, "the table ")
        assert str(caught.value).startswith(f"{visible(str(path))}: the table cannot be read: ")
        assert why in str(caught.value)


def test_a_file_that_is_too_large_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "LARGEST", 10)
    path = tmp_path / "file"
    path.write_bytes(b"0123456789")
    assert reading.content(path) == b"0123456789"
    path.write_bytes(b"0123456789x")
    with pytest.raises(ConfigError, match=r"file: has 11 bytes; at most 10 are read"):
        reading.content(path)


@pytest.mark.parametrize("name", ["", "none", "a\0b", "a" * 5000, "a/" * 3000, "loop"])
def test_a_name_that_no_file_has_is_no_file(tmp_path: Path, name: str) -> None:
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "file").touch()
    assert not reading.is_file(tmp_path / name)
    assert reading.is_file(tmp_path / "file")
