"""Signals at random moments of a command, and what it leaves: a campaign with a table.

    .venv/bin/python tests/support/signals.py                     # 200 Ctrl-C, 20 SIGTERM, SIGHUP and SIGKILL
    .venv/bin/python tests/support/signals.py --count SIGINT=24   # fewer

The moments are spread over the whole command, from the first line of evcosim on: imports, reading,
extraction, loop, writing, figure. Every tenth command begins with an empty cache, and so compiles and builds.
Each end is judged: exit code 128 + signal (SIGKILL: its own), no traceback, nothing but the folder left, no
process alive within two seconds, results that read where the run had begun. A machine that is busy makes the
seconds longer.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import os
import random
import re
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from evcosim import ConfigError, Results

COMMAND = [sys.executable, "-m", "evcosim", "run", "scooter", "--scenario", "ece15", "-o", "out"]
LONG = [*COMMAND[:6], "udds", "-o", "out"]  # of which a killed run has rows that were saved
COUNTS = {"SIGINT": 200, "SIGTERM": 20, "SIGHUP": 20, "SIGKILL": 20}
_MARK = "EVCOSIM_CAMPAIGN"
_GONE, _LAST = 30.0, 1.0  # s: for children to end; for Python to end when the command has done all


@dataclasses.dataclass
class End:
    """The end of a command: the moment of the signal and the time to the end [s], and what was wrong.

    Moments count from the first line of evcosim on: before, Python itself is starting.
    """

    moment: float
    seconds: float
    rows: int
    problems: list[str]


def alive(mark: str) -> list[int]:
    """Return the processes that live and have a mark in their environment, as all children have."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            if f"{_MARK}={mark}".encode() not in (entry / "environ").read_bytes():
                continue
            if (entry / "stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX":
                found.append(int(entry.name))
        except OSError:  # it has ended, or is not ours
            continue
    return found


@contextlib.contextmanager
def not_ignored(number: signal.Signals) -> Iterator[None]:
    """Let a process that is started within not ignore the signal, as a shell's background jobs do."""
    before = signal.getsignal(number)
    ignored = number != signal.SIGKILL and before == signal.SIG_IGN
    if ignored:
        signal.signal(number, signal.SIG_DFL)
    try:
        yield
    finally:
        if ignored:
            signal.signal(number, signal.SIG_IGN)


def await_first_line(process: subprocess.Popen[str]) -> None:
    """Wait until evcosim has the signals of its process in hand, which is what it does first, or its end."""
    bit = 1 << (signal.SIGTERM - 1)  # Python itself catches SIGINT alone
    while process.poll() is None:
        with contextlib.suppress(OSError):  # it ends just now
            status = Path(f"/proc/{process.pid}/status").read_text()
            if int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) & bit:
                return
        time.sleep(0.001)


def await_rows(run: subprocess.Popen[str], folder: Path) -> None:
    """Wait until rows of a run are on the disk, in the folder of its results."""
    rows = folder / "results.rows"
    # the file is made a moment before its first line and the rows are written
    while not (rows.exists() and rows.read_bytes().partition(b"\n")[2]):
        assert run.poll() is None
        time.sleep(0.02)


def ended(
    number: signal.Signals, moment: float, folder: Path, command: list[str] = COMMAND, cold: bool = False
) -> End | None:
    """Start the command in an empty folder, send the signal at a moment [s], and judge the end.

    None where it had ended by itself. `cold`: with an empty cache.
    """
    mark = secrets.token_hex(8)
    scratch = folder / "tmp"
    scratch.mkdir(parents=True)
    environment = os.environ | {"TMPDIR": str(scratch), _MARK: mark}
    if cold:
        environment["EVCOSIM_CACHE"] = str(folder / "cache")
    with not_ignored(number):
        process = subprocess.Popen(
            command, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
    await_first_line(process)
    time.sleep(moment)
    if process.poll() is not None:
        process.communicate()
        return None
    begin = time.monotonic()
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    seconds = time.monotonic() - begin
    while alive(mark) and time.monotonic() - begin - seconds < _GONE:
        time.sleep(0.02)
    problems = [f"process {each} lives" for each in alive(mark)]
    code = -9 if number == signal.SIGKILL else 128 + number
    if process.returncode == 0 and seconds < _LAST:
        return None  # it had done all when the signal came
    if process.returncode != code:
        problems.append(f"exit code {process.returncode}: {err.strip()[-200:]!r}")
    if "Traceback" in out + err or "unexpected error" in err:
        problems.append("a traceback")
    if number != signal.SIGKILL and list(scratch.iterdir()):
        problems.append(f"temporary files: {sorted(path.name for path in scratch.iterdir())}")
    return End(moment, seconds, _rows(folder / "out", process.returncode, problems), problems)


def _rows(out: Path, code: int, problems: list[str]) -> int:
    """Return the number of rows that read; note what is wrong with the folder."""
    if drafts := list(out.glob(".evcosim-*")) if code != -9 else []:
        problems.append(f"{len(drafts)} half-written files")
    if not (out / "run.json").exists():
        return 0
    try:
        results = Results.read(out)
    except ConfigError as error:
        if (out / "results.rows").exists() or (out / "results.csv").exists():
            problems.append(f"does not read: {error}")
        elif code != -9:  # that one had less than a second
            problems.append("no results where the run had begun")
        return 0
    allowed = ("killed", "done") if code == -9 else ("interrupted", "done")
    if results.manifest.get("status") not in allowed:
        problems.append(f"status {results.manifest.get('status')!r}")
    return len(results)


def length(folder: Path, cold: bool) -> float:
    """Return how long the whole command takes [s]."""
    environment = os.environ | ({"EVCOSIM_CACHE": str(folder / "cache")} if cold else {})
    folder.mkdir()
    begin = time.monotonic()
    subprocess.run(COMMAND, cwd=folder, env=environment, capture_output=True, check=True)
    return time.monotonic() - begin


def main() -> int:
    """Run the campaign, print a line for each signal and each problem, and return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", action="append", metavar="SIGNAL=N", help="how many of a signal")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    counts = dict(each.split("=") for each in arguments.count) if arguments.count else COUNTS
    moments = random.Random(arguments.seed)
    bad = 0
    with tempfile.TemporaryDirectory(prefix="evcosim-signals-") as scratch:
        place = Path(scratch)
        spans = {cold: length(place / f"length-{cold}", cold) for cold in (False, True)}
        print(f"the command takes {spans[False]:.2f} s, with an empty cache {spans[True]:.2f} s")
        print("signal    ended as it should  longest, s  with rows")
        for name, count in counts.items():
            ends: list[End] = []
            while len(ends) < int(count):
                cold = len(ends) % 10 == 9
                folder = place / f"{name}-{len(ends)}"
                command = LONG if name == "SIGKILL" else COMMAND
                moment = moments.uniform(0.0, spans[cold])
                end = ended(signal.Signals[name], moment, folder, command, cold)
                shutil.rmtree(folder)
                ends += [end] if end is not None else []
            good = sum(not end.problems for end in ends)
            bad += len(ends) - good
            longest = max(end.seconds for end in ends)
            print(f"{name:8}  {good:5} of {len(ends):<9}  {longest:10.2f}  {sum(e.rows > 0 for e in ends):9}")
            for end in ends:
                for problem in end.problems:
                    print(f"    at {end.moment:.3f} s: {problem}")
            sys.stdout.flush()
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
