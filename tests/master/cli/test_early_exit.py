"""An FMU that ends the process of evcosim: an error, and the rows are kept."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from evcosim.cosim.results.results import Results
from evcosim.master.cli import early_exit
from support.c_fmu import mixed_fmu
from support.needs import need_linux

SYSTEM = """
name = "bench"
[experiment]
stop_time = 2.0
[units.bad]
fmu = "mixed.fmu"
"""


@pytest.mark.parametrize("behavior", [52, 53])
@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_an_fmu_that_exits_is_an_error_and_its_rows_are_kept(process, tmp_path, behavior, engine):
    need_linux()
    mixed_fmu(tmp_path / "mixed.fmu", 2, behavior)
    (tmp_path / "bench.toml").write_text(SYSTEM)
    run = process("run", "bench.toml", "--isolation", "none", "--engine", engine, "-o", "out", "--no-plot")
    err = run.communicate(timeout=60)[1]
    assert run.returncode == 1
    assert err.startswith(
        "evcosim: unit bad (mixed.fmu) ended the process of evcosim: it called exit(); run again"
    )
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "results.csv",
        "results.texts.csv",
        "run.json",
    }
    results = Results.read(tmp_path / "out")
    assert results.manifest["status"] == "failed"
    assert results.manifest["error"] in err
    assert 50 <= len(results) <= 51
    assert json.loads((tmp_path / "out" / "run.json").read_text())["steps"] == len(results)


@pytest.mark.parametrize(
    "call", ["os._exit(0)", "ctypes.CDLL(None).exit(0)", "ctypes.CDLL(None).quick_exit(3)"]
)
def test_every_exit_is_caught_but_that_at_the_end(call):
    need_linux()
    code = (
        "import ctypes, os, sys; from evcosim.master.cli import early_exit, interrupts\n"
        f"interrupts.install(); early_exit.install(); end = lambda: {call}\n"
        "early_exit.leave() if len(sys.argv) > 1 else None\n"
        "end()"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert run.stderr.startswith("evcosim: an FMU ended the process of evcosim")
    run = subprocess.run([sys.executable, "-c", code, "left"], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (3 if "3" in call else 0, "")


def test_a_library_that_gives_up_without_memory_is_no_fmu():
    need_linux()
    code = (
        "import ctypes, resource; from evcosim.master.cli import early_exit; early_exit.install()\n"
        "used = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize()\n"
        "resource.setrlimit(resource.RLIMIT_AS, (used + 50_000_000,) * 2); ctypes.CDLL(None).exit(0)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert run.stderr.startswith(
        "evcosim: a library ended the process of evcosim, as some do without memory: no memory is left: "
    )


def test_a_copy_of_the_process_may_exit():
    need_linux()
    code = (
        "import os; from evcosim.master.cli import early_exit; early_exit.install()\n"
        "if not (child := os.fork()): os._exit(7)\n"
        "print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)\n"
        "early_exit.leave()"
    )
    command = [sys.executable, "-W", "ignore", "-c", code]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (0, "7\n", "")


def test_no_unit_is_known_without_a_report():
    assert early_exit.last_unit() == ""
