"""Logs of ASAM MDF 4 in the programs that read them."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from evcosim.cosim.can.logs import mf4
from evcosim.cosim.errors import ConfigError
from support.log_readers import asammdf, check, python_can, written


@pytest.mark.parametrize("reader", [python_can, asammdf])
def test_what_was_sent_is_read(tmp_path: Path, reader) -> None:
    check(tmp_path, ".mf4", reader)


def test_frames_go_there_in_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mf4, "_BLOCK", 2)
    check(tmp_path, ".mf4", asammdf)


def test_without_the_library_the_error_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    with pytest.raises(ConfigError, match=r"pip install 'evcosim\[mf4\]'"):
        written(tmp_path, ".mf4")
