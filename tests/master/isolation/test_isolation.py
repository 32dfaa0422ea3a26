"""Isolated units give the same results, and whatever one does to its process, the run ends with a reason."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.system.system import Algorithm
from evcosim.master.isolation import decision, handover
from evcosim.master.simulation import Simulation, simulate
from support.c_fmu import mixed_fmu

SYSTEM = """
name = "pair"
[experiment]
stop_time = 1.0
algorithm = "{algorithm}"
[units.rider]
fmu = "Rider"
[units.a]
fmu = "{fmu}"
start = {{ u = 1.0 }}
step_timeout = 1.0
[[connect]]
from = "a.y"
to = ["rider.speed"]
"""


def pair(folder: Path, behavior: int, fmi: int = 2, algorithm: str = "gauss_seidel") -> Path:
    fmu = mixed_fmu(folder / "mixed.fmu", fmi, behavior)
    (folder / "pair.toml").write_text(SYSTEM.format(fmu=fmu, algorithm=algorithm))
    return folder / "pair.toml"


def runs(process: int) -> bool:
    """Whether a process is there that is no zombie."""
    try:
        return ") Z " not in Path(f"/proc/{process}/stat").read_text()
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("system", ["scooter", "lane_keeping", "braking", "multi_drive"])
@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_isolated_units_give_the_same_results(system: str, algorithm: Algorithm) -> None:
    here = simulate(system, stop_time=0.5, algorithm=algorithm)
    apart = simulate(system, stop_time=0.5, algorithm=algorithm, isolation="process")
    assert np.array_equal(here.data, apart.data)
    assert {unit["isolation"] for unit in apart.manifest["units"].values()} == {"process"}


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_what_we_did_not_build_is_isolated(tmp_path: Path, fmi: int) -> None:
    path = pair(tmp_path, 0, fmi)
    results = simulate(path)
    found = {name: unit["isolation"] for name, unit in results.manifest["units"].items()}
    assert found == {"rider": "none", "a": "process"}
    assert np.array_equal(results.data, simulate(path, isolation="none").data)


ENDINGS = [
    (50, r"was killed by SIGSEGV \(Segmentation fault\), asked for a step"),
    (51, r"was killed by SIGABRT \(Aborted\), asked for a step"),
    (52, r"ended by itself with exit code 0: the FMU called exit\(\), asked for a step"),
    (53, "ended by itself with exit code 3, asked for a step"),
    (54, r"did not answer for 1 s \(step_timeout\) and was ended, asked for a step"),
    (55, "was killed by SIGSEGV"),
    (56, "was killed by SIGABRT"),
    (57, "was killed by SIGXFSZ|did not answer for 1 s"),
    (58, "was killed by SIGABRT"),
]


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(("behavior", "how"), ENDINGS)
def test_however_a_unit_ends_the_rows_are_kept(tmp_path: Path, fmi: int, behavior: int, how: str) -> None:
    begin = time.monotonic()
    with pytest.raises(RunError, match=rf"at t = 0.5 s \(step 50\): unit 'a': its process ({how})") as caught:
        simulate(pair(tmp_path, behavior, fmi))
    assert len(caught.value.results) == 50
    assert time.monotonic() - begin < 20.0


def test_a_unit_that_ends_before_the_first_step(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"unit 'a': its process was killed by SIGSEGV .*, asked for load"):
        simulate(pair(tmp_path, 60))


def test_a_unit_that_cannot_terminate_loses_nothing(tmp_path: Path) -> None:
    with Simulation(pair(tmp_path, 61)) as simulation:
        simulation.run()
        results = simulation.results
        with pytest.raises(RunError, match=r"did not answer for 1 s .*asked for terminate"):
            simulation.close()
    assert len(results) == 101


def test_what_a_unit_prints_stays_out_of_ours(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    simulate(pair(tmp_path, 62))
    assert "banner" not in "".join(capfd.readouterr())


def test_children_end_with_a_master_that_is_killed(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys\n"
        "from evcosim.master.simulation import Simulation\n"
        "s = Simulation(sys.argv[1]); s.step(10)\n"
        "print(s._units['a']._process._process.pid, flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    path = str(pair(tmp_path, 0))
    ended = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=False)
    assert ended.returncode == -9
    process = int(ended.stdout)
    for _ in range(100):
        if not runs(process):
            break
        time.sleep(0.05)
    assert not runs(process)


def test_a_child_lives_on_when_the_thread_that_started_it_ends(tmp_path: Path) -> None:
    with ThreadPoolExecutor(1) as pool:
        simulation = pool.submit(Simulation, pair(tmp_path, 0)).result()
    with simulation:
        simulation.run()
        assert simulation.finished


@pytest.mark.parametrize("kill", [True, False])
def test_what_a_unit_starts_ends_with_the_master(tmp_path: Path, kill: bool) -> None:
    code = (
        "import os, signal, sys\n"
        "from evcosim.master.simulation import Simulation\n"
        "s = Simulation(sys.argv[1]); s.run()\n"
        f"os.kill(os.getpid(), signal.SIGKILL) if {kill} else s.close()\n"
    )
    noted = tmp_path / "process"
    command = [sys.executable, "-c", code, str(pair(tmp_path, 65))]
    subprocess.run(command, env=os.environ | {"EVCOSIM_TEST_CHILD": str(noted)}, check=False)
    process = int(noted.read_text())
    for _ in range(100):
        if not runs(process):
            break
        time.sleep(0.05)
    assert not runs(process)


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_the_last_messages_of_a_unit_that_crashes_reach_the_error(tmp_path: Path, fmi: int) -> None:
    with pytest.raises(RunError, match=r"SIGSEGV .*\n.*its last messages:\n\[Error\] out of coffee"):
        simulate(pair(tmp_path, 64, fmi))


def test_warnings_are_counted_as_in_the_master(tmp_path: Path) -> None:
    path = pair(tmp_path, 11)
    apart, here = (simulate(path, isolation=isolation) for isolation in ("process", "none"))
    assert apart.manifest["warnings"] == here.manifest["warnings"] != []


def test_units_step_at_the_same_time_under_jacobi(tmp_path: Path) -> None:
    fmu = mixed_fmu(tmp_path / "mixed.fmu", 2, 63)
    units = "".join(f'[units.{name}]\nfmu = "{fmu}"\n' for name in "ab")
    path = tmp_path / "two.toml"
    path.write_text(f'name = "two"\n[experiment]\nstop_time = 0.2\nalgorithm = "jacobi"\n{units}')
    with Simulation(path) as simulation:
        simulation.run()
        assert 20 * 0.05 < simulation.loop_seconds < 1.5 * 20 * 0.05


def test_units_give_the_same_where_both_sides_only_sleep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = pair(tmp_path, 0)
    looking = simulate(path)
    monkeypatch.setattr(handover, "SPIN", 0.0)
    assert np.array_equal(simulate(path).data, looking.data)


def test_no_processes_where_the_system_has_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = pair(tmp_path, 0)
    monkeypatch.setattr(decision, "available", lambda: False)
    with pytest.raises(ConfigError, match=r"unit 'a': evcosim did not build mixed.fmu, .*--isolation none"):
        simulate(path)
    assert simulate(path, isolation="none").manifest["units"]["a"]["isolation"] == "none"


def test_ctrl_c_does_not_wait_for_a_unit_that_hangs(tmp_path: Path) -> None:
    path = pair(tmp_path, 54)
    path.write_text(path.read_text().replace("step_timeout = 1.0", "step_timeout = 60.0"))
    start = "import sys; from evcosim.master.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", start, "run", str(path), "-o", str(tmp_path / "out"), "--no-plot"]
    command += ["--engine", "python"]  # the other one may have to be compiled first
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    time.sleep(4.0)  # it has started, and hangs at t = 0.5 s
    begin = time.monotonic()
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=20)
    assert time.monotonic() - begin < 3.0
    assert running.returncode == 130, said
    assert "interrupted at t = 0.5 s" in said
    assert len((tmp_path / "out" / "results.csv").read_text().splitlines()) == 51


def test_nothing_is_left_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    (tmp_path / "one").mkdir()
    with pytest.raises(RunError):
        simulate(pair(tmp_path / "one", 50))
    assert os.listdir(folder) == []
