"""A crash in this process: the command line shows where and in which unit; a library shows nothing."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from evcosim.master.fmi.crash import CrashReport
from support.c_fmu import mixed_fmu

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere faulthandler alone speaks")

SYSTEM = """
name = "three"
[experiment]
stop_time = 1.0
algorithm = "{algorithm}"
[units.rider]
fmu = "Rider"
[units.good]
fmu = "{good}"
[units.bad]
fmu = "{bad}"
start = {{ u = 1.0 }}
[[connect]]
from = "bad.y"
to = ["rider.speed", "good.u"]
"""


def three(folder: Path, behavior: int, algorithm: str = "gauss_seidel", fmi: int = 2) -> Path:
    good, bad = mixed_fmu(folder / "good.fmu", fmi), mixed_fmu(folder / "bad.fmu", fmi, behavior)
    path = folder / "three.toml"
    path.write_text(SYSTEM.format(good=good, bad=bad, algorithm=algorithm))
    return path


def run(path: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [
        sys.executable,
        "-m",
        "evcosim",
        "run",
        str(path),
        "--isolation",
        "none",
        "--no-plot",
        *options,
    ]
    return subprocess.run([*command, "-o", str(path.parent / "out")], capture_output=True, text=True)


def test_a_unit_that_python_calls_for_the_kernel_does_not_move_what_the_kernel_follows() -> None:
    report = CrashReport()
    notes = [report.add(name, name, f"{name}.fmu", in_python=True) for name in "ab"]
    table = np.array([report.row("a"), report.row("b")], dtype=np.int64)
    place = np.array([1], dtype=np.int64)
    report.follow(table.ctypes.data, place.ctypes.data)
    notes[0]()
    assert report.last() == "b (b.fmu)"
    report.rest()
    notes[0]()
    assert report.last() == "a (a.fmu)"


@LINUX
@pytest.mark.parametrize(
    ("engine", "algorithm", "behavior", "ends_by"),
    [
        ("compiled", "gauss_seidel", 50, "SIGSEGV"),
        ("python", "gauss_seidel", 50, "SIGSEGV"),
        ("compiled", "jacobi", 51, "SIGABRT"),
        ("python", "jacobi", 51, "SIGABRT"),
        ("compiled", "gauss_seidel", 55, "SIGSEGV"),
    ],
)
def test_a_crash_in_a_step_names_the_unit(
    tmp_path: Path, engine: str, algorithm: str, behavior: int, ends_by: str
) -> None:
    """A run that lasted under a second has written no rows; its run.json says that it is not done."""
    ended = run(three(tmp_path, behavior, algorithm), "--engine", engine)
    assert ended.returncode == -signal.Signals[ends_by]
    stack, _, lines = ended.stderr.partition("evcosim: this process crashed; ")
    assert "Fatal Python error" in stack and "engine.py" in stack and "in _run" in stack
    first, second, *advice = lines.splitlines()
    assert first == "the unit called last was bad (bad.fmu)"
    assert second.startswith("evcosim: units in this process: ")
    assert all(unit in second for unit in ("rider (Rider", "good (good.fmu)", "bad (bad.fmu)"))
    assert "--isolation process" in advice[0]
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["run.json"]
    assert json.loads((tmp_path / "out" / "run.json").read_text(encoding="utf-8"))["status"] == "running"


@LINUX
@pytest.mark.parametrize("engine", ["compiled", "python"])
def test_a_crash_at_the_load_names_the_unit(tmp_path: Path, engine: str) -> None:
    ended = run(three(tmp_path, 60), "--engine", engine)
    assert ended.returncode == -signal.SIGSEGV
    assert "the unit called last was bad (bad.fmu)" in ended.stderr


@LINUX
def test_a_signal_that_someone_sends_ends_the_process_too(tmp_path: Path) -> None:
    """No instruction is at fault then that would be repeated when the handler returns."""
    code = (
        "import os, signal, sys\n"
        "from evcosim.master.fmi import crash\n"
        "crash.enable()\n"
        "from evcosim.master.simulation import Simulation\n"
        "with Simulation(sys.argv[1], isolation='none') as s:\n"
        "    s.run()\n"
        "    os.kill(os.getpid(), signal.SIGSEGV)\n"
    )
    command = [sys.executable, "-c", code, str(three(tmp_path, 0))]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == -signal.SIGSEGV
    assert "evcosim: units in this process: " in ended.stderr


def test_a_program_that_uses_evcosim_is_left_as_it_is(tmp_path: Path) -> None:
    code = (
        "import faulthandler, sys\n"
        "from evcosim import simulate\n"
        "try:\n"
        "    simulate(sys.argv[1], isolation='none')\n"
        "finally:\n"
        "    print('never')\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code, str(three(tmp_path, 50))], capture_output=True, text=True
    )
    assert ended.returncode == -signal.SIGSEGV
    assert (ended.stdout, ended.stderr) == ("", "")


def test_a_run_that_ends_well_says_nothing(tmp_path: Path) -> None:
    ended = run(three(tmp_path, 0), "--quiet")
    assert ended.returncode == 0
    assert "crash" not in ended.stderr and "Fatal" not in ended.stderr
