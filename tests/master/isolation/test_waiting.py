"""While the master waits for a unit, Ctrl-C breaks the wait off."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from evcosim.master.isolation.waiting import WAITING, waits
from support.pairs import pair


def test_ctrl_c_does_not_wait_for_a_unit_that_hangs(tmp_path: Path) -> None:
    path = pair(tmp_path, 54)
    path.write_text(path.read_text().replace("step_timeout = 1.0", "step_timeout = 60.0"))
    start = "import sys; from evcosim.master.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", start, "run", str(path), "-o", str(tmp_path / "out"), "--no-plot"]
    command += ["--engine", "python"]  # the other one may have to be compiled first
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    rows = tmp_path / "out" / "results.rows"
    while not rows.exists() and running.poll() is None:  # written when it has hung at t = 0.5 s for a second
        time.sleep(0.05)
    begin = time.monotonic()
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=50)
    assert time.monotonic() - begin < 50.0  # the unit hangs for longer
    assert running.returncode == 130, said
    assert "interrupted at t = 0.5 s" in said
    assert len((tmp_path / "out" / "results.csv").read_text().splitlines()) == 51


def test_the_mark_is_set_in_the_block_alone() -> None:
    assert not waits()
    with WAITING:
        assert waits()
    assert not waits()
    with pytest.raises(KeyboardInterrupt), WAITING:
        raise KeyboardInterrupt
    assert not waits()
