"""The settings of a framed message."""

from __future__ import annotations

import pytest

from evcosim.cosim.can.bus_settings import BusSettings
from evcosim.cosim.can.database import Message
from evcosim.cosim.can.framing import Framing, check_jitter, checksum_sources, framing_of
from evcosim.cosim.can.message_settings import MessageSettings
from evcosim.cosim.errors import ConfigError

MESSAGE = Message("test.dbc", "M", 1)


def test_a_framing_without_settings_is_equal_to_another():
    assert Framing() == Framing()


@pytest.mark.parametrize(("timing", "framed"), [("instant", False), ("frame", True)])
def test_frames_that_take_time_are_made(timing, framed):
    assert (framing_of(MESSAGE, BusSettings(timing=timing)) is not None) == framed


def test_jitter_of_a_message_is_shorter_than_its_cycle():
    check_jitter(MESSAGE, BusSettings(jitter=0.009), 0.01, "s.toml")
    own = {"M": MessageSettings(jitter=0.0)}
    check_jitter(MESSAGE, BusSettings(jitter=0.02, messages=own), 0.01, "s.toml")
    with pytest.raises(
        ConfigError, match=r"^s.toml: message 'M': jitter = 0.01 s is not less than its cycle"
    ):
        check_jitter(MESSAGE, BusSettings(jitter=0.01), 0.01, "s.toml")


def test_values_that_are_not_quantized_make_no_frames():
    own = {"M": MessageSettings(timeout=3)}
    assert framing_of(MESSAGE, BusSettings(messages=own)) is not None
    assert framing_of(MESSAGE, BusSettings(messages=own, resolution="ideal")) is None
    with pytest.raises(ConfigError, match=r'^s.toml: with resolution = "ideal".*timing = "frame" needs'):
        framing_of(MESSAGE, BusSettings(timing="frame", resolution="ideal"), (), "s.toml")


def test_files_of_checksums_are_read_or_said(tmp_path, monkeypatch):
    own = {"M": MessageSettings(checksum="mine:f"), "N": MessageSettings(checksum="math:hypot")}
    buses = [BusSettings(messages=own)]
    assert checksum_sources(buses, str(tmp_path)) == []
    (tmp_path / "mine.py").write_bytes(b"def f(): pass\n")
    assert checksum_sources(buses, str(tmp_path)) == [b"def f(): pass\n"]

    def refused(path):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(type(tmp_path), "read_bytes", refused)
    with pytest.raises(ConfigError, match=r"mine\.py: it has a checksum, and cannot be read: Permission"):
        checksum_sources(buses, str(tmp_path))
