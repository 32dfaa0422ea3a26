"""Captures of SocketCAN frames in tshark."""

from __future__ import annotations

from pathlib import Path

from support.log_readers import check, tshark


def test_what_was_sent_is_read(tmp_path: Path) -> None:
    check(tmp_path, ".pcapng", tshark)
