"""Logs of Vector's tools in the programs that read them."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.log_readers import asc2log, check, python_can, tshark


@pytest.mark.parametrize("reader", [python_can, asc2log])
def test_what_was_sent_is_read_from_asc(tmp_path: Path, reader) -> None:
    check(tmp_path, ".asc", reader)


@pytest.mark.parametrize("reader", [python_can, tshark])
def test_what_was_sent_is_read_from_blf(tmp_path: Path, reader) -> None:
    check(tmp_path, ".blf", reader)
