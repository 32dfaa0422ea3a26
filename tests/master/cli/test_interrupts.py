"""Ctrl-C on a real process, and the progress bar on a real terminal."""

from __future__ import annotations

import os
import signal
import sys
import time

import pytest

from evcosim.cosim.results.results import Results

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to one process, no pty")


def read_until(descriptor, text, seconds=60.0):
    """What a terminal shows up to `text`."""
    shown, end = b"", time.monotonic() + seconds
    while text not in shown and time.monotonic() < end:
        shown += os.read(descriptor, 4096)
    assert text in shown
    return shown


def test_ctrl_c_keeps_what_was_recorded(process, tmp_path):
    terminal, inner = os.openpty()
    run = process("run", "scooter", "--scenario", "udds", "-o", "out", "--no-plot", stderr=inner)
    os.close(inner)
    assert b"scooter udds" in read_until(terminal, b"%")  # the bar: it steps
    run.send_signal(signal.SIGINT)
    out = run.communicate(timeout=30)[0]
    shown = read_until(terminal, b"run.json")
    assert (run.returncode, out) == (130, "")
    assert b"interrupted at t = " in shown
    assert b"Traceback" not in shown
    results = Results.read(tmp_path / "out")
    assert results.manifest["status"] == "interrupted"
    assert 0 < len(results) < 136_900
    assert results.manifest["steps"] == len(results) - 1


def test_second_ctrl_c_ends_a_unit_that_is_stuck(process, system, tmp_path):
    run = process("run", system({"cart": "Stuck"}), "-o", "out")
    while not (tmp_path / "out").is_dir():
        assert run.poll() is None
        time.sleep(0.02)
    time.sleep(0.3)
    run.send_signal(signal.SIGINT)
    time.sleep(0.3)
    assert run.poll() is None  # it waits for the end of the step
    run.send_signal(signal.SIGINT)
    assert "Traceback" not in run.communicate(timeout=10)[1]
    assert run.returncode == 130


def test_no_bar_in_a_pipe(process):
    run = process("run", "scooter", "--stop-time", "2", "--no-plot", "-o", "out")
    out, err = run.communicate(timeout=60)
    assert (run.returncode, err) == (0, "")
    assert "times real time" in out
