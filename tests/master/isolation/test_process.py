"""However a unit's process ends, the run says how; and nothing of it is left behind."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from evcosim.cosim.errors import RunError
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.isolation import shared
from evcosim.master.isolation.process import Process, ProcessLimits
from evcosim.master.simulation import Simulation, simulate
from support.c_fmu import mixed_fmu
from support.pairs import pair

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


def runs(process: int) -> bool:
    """Return True for a process that is there and no zombie."""
    try:
        return ") Z " not in Path(f"/proc/{process}/stat").read_text()
    except FileNotFoundError:
        return False


def test_children_end_with_a_master_that_is_killed(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys\n"
        "from evcosim.master.simulation import Simulation\n"
        "s = Simulation(sys.argv[1]); s.step(10)\n"
        "print(s.units['a']._process._process.pid, flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    path = str(pair(tmp_path, 0))
    ended = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=False)
    assert ended.returncode == -9
    process = int(ended.stdout)
    for _ in range(1000):
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
    for _ in range(1000):
        if not runs(process):
            break
        time.sleep(0.05)
    assert not runs(process)


def test_what_a_unit_prints_stays_out_of_ours(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    simulate(pair(tmp_path, 62))
    assert "banner" not in "".join(capfd.readouterr())


def test_nothing_is_left_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    (tmp_path / "one").mkdir()
    with pytest.raises(RunError):
        simulate(pair(tmp_path / "one", 50))
    assert os.listdir(folder) == []


@pytest.fixture
def process(tmp_path: Path):
    """A process with a unit of FMI 2.0, ended at the end of the test."""
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2, 62))
    memory = shared.create(2 * len(fmu.interface.variables))
    started = Process((fmu, "a", fmu.interface, None), memory, ProcessLimits())
    os.close(memory)
    yield started
    started.close()


def test_a_process_is_alive_until_it_is_killed(process: Process) -> None:
    process.check_alive()
    process.kill()
    with pytest.raises(EOFError):
        process.check_alive()
    assert process.ending() == "was killed by SIGKILL (Killed)"
    process.kill()  # which may be done twice


def test_its_output_is_kept_to_its_last_2000_characters(process: Process) -> None:
    for _ in range(1000):
        if process.printed():
            break
        time.sleep(0.05)
    assert process.printed() == "*** a banner of the tool ***"
    process._output.write(b"x" * 5000 + b"end")
    assert process.printed() == "x" * 1997 + "end"


def test_close_removes_its_folder_and_sockets(process: Process) -> None:
    folder = process._folder
    assert folder.is_dir()
    process.close()
    assert not folder.exists()
    assert process.connection.fileno() == -1
    with pytest.raises(EOFError):
        process.check_alive()
