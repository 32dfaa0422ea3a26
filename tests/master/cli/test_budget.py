"""`evcosim budget`: the scooter's metric, wrong arguments and Ctrl-C."""

from __future__ import annotations

import os
import signal
import sys
import time

import pytest

from support.small_disk import small_disk

pytestmark = pytest.mark.usefixtures("warm_workers")


def test_the_scooter_names_its_metric(evcosim):
    data = evcosim(
        "budget", "scooter", "--stop-time", "1", "--engine", "python", "--strict", "--json", "-o", "out"
    ).json
    assert (data["metric"], data["limit"], data["unit"]) == ("highest speed over the bound", 1.5, "km/h")
    assert not any(point["broken"] for each in data["series"] for point in each["points"])


def test_a_full_disk_hides_no_number(evcosim, tmp_path):
    """It may have taken an hour: what was found is printed, and the files that are there are named."""
    with small_disk(tmp_path / "disk", 3):
        answer = evcosim("budget", "scooter", "--stop-time", "1", "--workers", "1", "-o", "disk/out")
    assert answer.code == 1
    assert "holds up to" in answer.out
    assert "in disk/out" not in answer.out
    first, second = answer.err.splitlines()
    full = "cannot be written: No space left on device: make room on the disk"
    assert first == f"evcosim: disk/out/budget.png: {full}"
    assert second == "in disk/out: budget.md, budget.json"


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["scoter"], "unknown system 'scoter' (did you mean 'scooter'?)"),
        (["scooter", "-s", "fig88"], "'fig88' (did you mean 'fig8'?)"),
        (["scooter", "--set", "ecu.gian=1"], "--set ecu.gian=1:"),
        (["scooter", "--set", "vehicle.mass"], "--set vehicle.mass:"),
        (["scooter", "--stop-time", "-1"], "--stop-time -1.0 s is not after start_time"),
        (["scooter", "--workers", "0"], "--workers"),
        (["scooter", "--seeds", "0"], "'--seeds': Input should be greater than or equal to 1"),
        (["scooter", "--seeds", "-1"], "'--seeds': Input should be greater than or equal to 1"),
        (["scooter", "--seeds", "1001"], "seeds = 1001: it is a whole number from 0 to 1000"),
        (["scooter", "-o", "file/out"], "output folder file/out: cannot be written"),
        ([], "SYSTEM"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_wrong_arguments(evcosim, tmp_path, arguments, text):
    (tmp_path / "file").write_text("")
    answer = evcosim("budget", *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert text in answer.err


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a group of processes")
def test_ctrl_c_ends_all_processes(process, tmp_path):
    run = process("budget", "scooter", "--scenario", "udds", "-o", "out", start_new_session=True)
    while not (tmp_path / "out").is_dir():
        assert run.poll() is None
        time.sleep(0.02)
    time.sleep(1.5)  # into the first runs
    os.killpg(run.pid, signal.SIGINT)
    out, err = run.communicate(timeout=60)
    assert (run.returncode, out, err) == (130, "", "evcosim: interrupted\n")
    assert list((tmp_path / "out").iterdir()) == []
    end = time.monotonic() + 60.0  # multiprocessing's own helper ends once the pipe to it is closed
    with pytest.raises(ProcessLookupError):
        while time.monotonic() < end:
            os.killpg(run.pid, 0)
            time.sleep(0.05)
    assert [path for path in tmp_path.glob("evcosim-*") if path.is_dir()] == []
