"""A run that is killed: nothing that was computed a second ago is lost, and no process stays."""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from pathlib import Path

import pytest

from evcosim.cosim.results.results import Results
from support.answers import refused
from support.signals import await_rows

linux = pytest.mark.skipif(sys.platform != "linux", reason="SIGKILL, and /proc that shows the children")


def children(pid: int) -> list[int]:
    """The processes that a process has started and that live."""
    found = []
    for thread in Path(f"/proc/{pid}/task").iterdir():
        found += [int(child) for child in (thread / "children").read_text().split()]
    return found


def killed(run, folder: Path) -> list[int]:
    """Kill a run as soon as rows are on the disk; return the processes that it had."""
    await_rows(run, folder)
    mine = children(run.pid)
    run.send_signal(signal.SIGKILL)
    run.wait()
    return mine


@linux
def test_a_killed_run_is_recovered(process, evcosim, tmp_path):
    out = tmp_path / "out"
    killed(process("run", "scooter", "--scenario", "udds", "-o", "out", "--no-plot"), out)
    kept = Results.read(out)
    assert (kept.manifest["status"], json.loads((out / "run.json").read_text())["status"]) == (
        "killed",
        "running",
    )
    assert len(kept) > 100
    assert evcosim("compare", "out", "out").code == 0
    assert evcosim("run", "scooter", "-o", "out", "--stop-time", "0.1", "--no-plot").code == 0
    recovered = Results.read(out)
    assert recovered.manifest["status"] == "killed"  # what was killed is kept, the other run is beside it
    assert (
        evcosim("results", "recover", "out").out
        == "out: no run was killed here and no row is cut off, there is nothing to recover\n"
    )
    assert recovered.data.tobytes() == kept.data.tobytes()
    assert len(Results.read(tmp_path / "out-stop_time=0.1")) == 11


@linux
def test_a_unit_that_is_stuck_holds_no_row_back_and_is_ended(process, system, evcosim, tmp_path):
    run = process("run", system({"cart": "Stuck"}), "--isolation", "process", "-o", "out")
    units = killed(run, tmp_path / "out")
    assert units
    end = time.monotonic() + 30.0
    while any(Path(f"/proc/{unit}/stat").exists() and not gone(unit) for unit in units):
        assert time.monotonic() < end
        time.sleep(0.02)
    assert evcosim("results", "recover", "out").out.startswith(
        "out: results.csv has 10 rows, up to t = 0.09 s"
    )
    assert Results.read(tmp_path / "out").column("cart.way").tolist() == [float(k) for k in range(10)]


def gone(pid: int) -> bool:
    """True for a process that has ended, though nobody has waited for it."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] in "ZX"
    except OSError:
        return True


@linux
def test_the_second_run_into_a_folder_is_refused_while_the_first_lives(process, evcosim, tmp_path):
    run = process("run", "scooter", "--scenario", "udds", "-o", "out", "--no-plot")
    while not (tmp_path / "out" / "run.json").exists():
        assert run.poll() is None
        time.sleep(0.02)
    refused(
        evcosim("run", "scooter", "-o", "out"), f"the run 'scooter udds', process {run.pid}", "--output names"
    )
    refused(evcosim("results", "recover", "out"), f"process {run.pid}")
    os.kill(run.pid, signal.SIGKILL)


def test_there_is_nothing_to_recover(evcosim, tmp_path):
    refused(evcosim("results", "recover", "none"), "none: there is no such folder")
    (tmp_path / "out").mkdir()
    assert evcosim("results", "recover", "out").out.startswith("out: no run was killed here")
    assert evcosim("results", "--help").code == 0
