"""Logs of candump -L in the programs that read them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from support.log_readers import check, log2asc, python_can, tshark, written


@pytest.mark.parametrize("reader", [python_can, tshark, log2asc])
def test_what_was_sent_is_read(tmp_path: Path, reader) -> None:
    check(tmp_path, ".log", reader)


def test_cantools_decodes_a_candump_log(tmp_path: Path) -> None:
    database = tmp_path / "one.dbc"
    signal = ' SG_ S : 8|16@1+ (0.5,0) [0|0] "V" A'
    database.write_text(f'VERSION ""\nNS_ :\nBS_:\nBU_: A\nBO_ 291 M: 8 A\n{signal}\n')
    log = written(tmp_path, ".log").read_text()
    command = [sys.executable, "-m", "cantools", "decode", "--single-line", str(database)]
    answer = subprocess.run(command, input=log, capture_output=True, text=True, check=True).stdout
    first = answer.splitlines()[0]
    assert first.startswith("(946684800.000000)") and f"S: {0x0201 * 0.5} V" in first
