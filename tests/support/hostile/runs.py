"""Running the system with a hostile FMU, and what the run leaves of the master's process."""

from __future__ import annotations

import contextlib
import dataclasses
import fcntl
import gc
import hashlib
import locale
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.results.results import Results
from evcosim.master.simulation import simulate
from support.hostile import units
from support.hostile.case import WHOLE, Case

_ENDING = 30.0  # s
_MARK = "EVCOSIM_TEST_MARK"
SYSTEM = """
name = "hostile"
[experiment]
stop_time = 0.1
[units.bad]
fmu = "bad.fmu"
start = {{ u = 1.0 }}
step_timeout = {timeout}
load_timeout = {loading}
{entry}
[units.good]
fmu = "good.fmu"
isolation = "none"
[[connect]]
from = "bad.y"
to = ["good.u"]
"""


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What came of a run: `rows` as in `Case`; `said` is its error, or its warnings; `left` what it should
    not have left behind or changed, a few words each."""

    rows: int | None
    said: str
    error: type[Exception] | None
    seconds: float
    left: tuple[str, ...]
    results: Results | None = None


def write_system(folder: Path, case: Case, fmi: int) -> Path:
    """The system file, and the FMUs beside it."""
    units.write(folder / "bad.fmu", case, fmi)
    units.write(folder / "good.fmu", Case("good", "", "", WHOLE), 2)
    path = folder / "system.toml"
    settings = {"entry": case.entry, "timeout": case.timeout, "loading": case.loading_timeout}
    path.write_text(SYSTEM.format(**settings))
    return path


def run(folder: Path, case: Case, fmi: int) -> Outcome:
    """Run a case in this process, its unit in one of its own."""
    path = write_system(folder, case, fmi)
    begin = time.monotonic()
    with watched(folder) as left:
        results, rows, error = None, WHOLE, None
        try:
            results = simulate(path, trust=True)
            said = "\n".join(results.manifest["warnings"])
        except ConfigError as refusal:
            rows, said, error = None, str(refusal), type(refusal)
        except RunError as failure:
            results, said, error = failure.results, str(failure), type(failure)
            rows = len(results) if results else 0
    return Outcome(rows, said, error, time.monotonic() - begin, tuple(left), results)


def run_command(folder: Path, case: Case, fmi: int, engine: str) -> subprocess.CompletedProcess[str]:
    """Run a case with the installed command by an engine; its results are in `out`."""
    path = write_system(folder, case, fmi)
    command = [str(Path(sys.executable).with_name("evcosim")), "run", str(path), "--no-plot", "--trust"]
    command += ["--engine", engine, "--output", str(folder / "out")]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


@contextlib.contextmanager
def watched(folder: Path) -> Iterator[list[str]]:
    """A list that is filled at the end with what differs in this process, and what was left elsewhere."""
    temporary = folder / "temporary"
    temporary.mkdir()
    mark = uuid.uuid4().hex
    before, tempfile.tempdir = tempfile.tempdir, str(temporary)
    os.environ[_MARK] = mark
    gc.freeze()  # so that collecting at the end looks at what the run made, and is quick
    state, left = _state(folder), []
    try:
        yield left
    finally:
        tempfile.tempdir = before
        del os.environ[_MARK]
        gc.collect()  # what an error's traceback held open
        gc.unfreeze()
        after = _state(folder)
        left += [f"{name}: {state[name]} -> {after[name]}" for name in state if state[name] != after[name]]
        left += [f"temporary {name}" for name in sorted(os.listdir(temporary))]
        for process, command in _lasting(mark, folder):
            left.append(f"process {command}")
            os.kill(process, signal.SIGKILL)


def _lasting(mark: str, folder: Path) -> list[tuple[int, str]]:
    """The processes of a run that are there after a moment: the system takes one to end a killed one."""
    until = time.monotonic() + _ENDING
    while (found := _of_the_run(mark, folder)) and time.monotonic() < until:
        time.sleep(0.02)
    return found


def _state(folder: Path) -> dict[str, Any]:
    watched = (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD, signal.SIGALRM, signal.SIGIO)
    return {
        "working folder": os.getcwd(),
        "open files": len(os.listdir("/proc/self/fd")),
        "threads": threading.active_count(),
        "signals": [signal.getsignal(each) for each in watched],
        "rounding": (0.1 + 0.2, 1.0 / 3.0),
        "small numbers": sys.float_info.min / 2.0,
        "locale": locale.setlocale(locale.LC_ALL),
        "flags of stdout": fcntl.fcntl(1, fcntl.F_GETFL),
        "files": {path.name: path.stat().st_size for path in folder.glob("*.*")},
        "FMU": hashlib.sha256((folder / "bad.fmu").read_bytes()).hexdigest(),
    }


def _of_the_run(mark: str, folder: Path) -> list[tuple[int, str]]:
    """The processes that have the mark in their environment, or work in the folder: number and command line.

    The mark is seen in those that were started; the folder in those that were forked, too.
    """
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            here = os.readlink(process / "cwd").startswith(f"{folder}/")
            if here or mark.encode() in (process / "environ").read_bytes():
                line = (process / "cmdline").read_bytes().replace(b"\0", b" ")
                found.append((int(process.name), line.decode("utf-8", "replace")))
    return found
