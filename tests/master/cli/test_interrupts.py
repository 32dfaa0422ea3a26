"""Signals to a real process, and the progress bar on a real terminal."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time

import pytest

from evcosim.cosim.results.results import Results
from evcosim.master.cli import interrupts
from support import signals

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to one process, no pty")


def read_until(descriptor, text, seconds=300.0):
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
    out = run.communicate(timeout=60)[0]
    shown = read_until(terminal, b"run.json")
    assert (run.returncode, out) == (130, "")
    assert b"interrupted at t = " in shown
    assert b"Traceback" not in shown
    results = Results.read(tmp_path / "out")
    assert results.manifest["status"] == "interrupted"
    assert 0 < len(results) < 136_900
    assert results.manifest["steps"] == len(results) - 1
    assert not (tmp_path / "out" / "report.html").exists()  # nobody waits for it


@pytest.fixture
def await_stuck(tmp_path, monkeypatch):
    """Wait until the unit of a run, which is started after this, does not come back from its step."""
    monkeypatch.setenv("EVCOSIM_TEST_STUCK", str(tmp_path / "stuck"))

    def wait(run):
        while not (tmp_path / "stuck").exists():
            assert run.poll() is None
            time.sleep(0.02)

    return wait


def test_second_ctrl_c_ends_a_unit_that_is_stuck(process, system, await_stuck):
    run = process("run", system({"cart": "Stuck"}), "-o", "out")
    await_stuck(run)
    run.send_signal(signal.SIGINT)
    time.sleep(0.3)
    assert run.poll() is None  # it waits for the end of the step
    run.send_signal(signal.SIGINT)
    assert "Traceback" not in run.communicate(timeout=60)[1]
    assert run.returncode == 130


def test_no_bar_in_a_pipe(process):
    run = process("run", "scooter", "--engine", "python", "--stop-time", "2", "--no-plot", "-o", "out")
    out, err = run.communicate(timeout=60)
    assert (run.returncode, err) == (0, "")
    assert "times real time" in out


MOMENTS = random.Random(7)
ORDERS = [("SIGINT", MOMENTS.random()) for _ in range(10)] + [
    (name, MOMENTS.random()) for name in ("SIGTERM", "SIGHUP", "SIGKILL") for _ in range(2)
]


@pytest.mark.skipif(sys.platform != "linux", reason="children are found in /proc")
@pytest.mark.parametrize(("name", "share"), ORDERS)
def test_a_signal_at_any_moment_ends_the_command_cleanly(name, share, tmp_path):
    """`tests/support/signals.py` does it hundreds of times, with an empty cache and figures too."""
    command = [*signals.COMMAND, "--no-plot", "--quiet"]
    end = signals.ended(signal.Signals[name], 1.5 * share, tmp_path, command)
    assert end is None or end.problems == []


@pytest.mark.parametrize("name", ["SIGHUP", "SIGINT", "SIGTERM", "SIGUSR1"])
def test_a_signal_that_is_ignored_at_the_start_stays_ignored(name, process, tmp_path):
    """As with nohup, and in a shell's background jobs."""
    number = signal.Signals[name]
    before = signal.signal(number, signal.SIG_IGN)
    try:
        run = process("run", "scooter", "--engine", "python", "-o", "out", "--no-plot")
    finally:
        signal.signal(number, before)
    while not (tmp_path / "out" / "run.json").exists():
        assert run.poll() is None
        time.sleep(0.01)
    run.send_signal(number)
    run.communicate(timeout=60)
    assert run.returncode == 0


def test_sigterm_is_said_and_is_the_exit_code(process, tmp_path):
    run = process("run", "scooter", "--scenario", "udds", "-o", "out", "--no-plot")
    while not (tmp_path / "out" / "run.json").exists():
        time.sleep(0.02)
    run.send_signal(signal.SIGTERM)
    err = run.communicate(timeout=60)[1]
    assert run.returncode == 128 + signal.SIGTERM
    assert err.startswith("evcosim: ended by SIGTERM")
    results = Results.read(tmp_path / "out")
    assert results.manifest["status"] == "interrupted"
    assert results.manifest["steps"] >= len(results) - 1


def test_a_step_that_never_ends_loses_no_row(process, system, await_stuck, tmp_path):
    """One signal is enough: the rows are saved as they are after a time."""
    run = process("run", system({"cart": "Stuck"}), "--isolation", "none", "-o", "out")
    await_stuck(run)
    run.send_signal(signal.SIGINT)
    err = run.communicate(timeout=60)[1]
    assert run.returncode == 130
    assert err.startswith(
        "evcosim: interrupted; 10 rows are in out/results.rows, and evcosim results recover"
    )
    results = Results.read(tmp_path / "out")
    assert (results.manifest["status"], results.column("cart.way").tolist()) == (
        "interrupted",
        [float(k) for k in range(10)],
    )


def test_the_words_and_the_codes_of_signals():
    assert interrupts.exit_code(KeyboardInterrupt()) == 130
    assert interrupts.exit_code(interrupts.Interrupted(signal.SIGTERM)) == 143
    assert interrupts.words(signal.SIGINT) == "interrupted"
    assert interrupts.words(signal.SIGHUP) == "ended by SIGHUP"


def after(code: str) -> subprocess.CompletedProcess[str]:
    """The end of a process that does `code` with signal, os and interrupts at hand."""
    code = f"import os, signal, time\nfrom evcosim.master.cli import interrupts\n{code}"
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)


NAMES = ["SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGXCPU", "SIGALRM", "SIGVTALRM", "SIGPROF", "SIGIO", "SIGPWR"]


@pytest.mark.parametrize("name", [name for name in NAMES if hasattr(signal, name)])
def test_any_signal_that_would_end_the_process_ends_it_cleanly(name):
    """Its default would, without a word."""
    run = after(f"interrupts.install(); os.kill(os.getpid(), signal.{name}); time.sleep(10)")
    assert (run.returncode, run.stderr) == (128 + signal.Signals[name], f"evcosim: ended by {name}\n")


@pytest.mark.parametrize("name", ["SIGUSR1", "SIGQUIT"])
def test_the_signal_of_a_batch_system_loses_no_row(name, process, tmp_path):
    run = process("run", "scooter", "--scenario", "udds", "-o", "out", "--no-plot")
    signals.await_rows(run, tmp_path / "out")
    run.send_signal(signal.Signals[name])
    err = run.communicate(timeout=60)[1]
    assert run.returncode == 128 + signal.Signals[name]
    assert err.startswith(f"evcosim: ended by {name}")
    results = Results.read(tmp_path / "out")
    assert (results.manifest["status"], len(results) > 0) == ("interrupted", True)


def test_the_limit_of_processor_time_announces_itself():
    """The system kills a process at once where both limits are the same, as `ulimit -t` sets them."""
    run = after(
        "import resource; resource.setrlimit(resource.RLIMIT_CPU, (2, 2)); interrupts.install()\n"
        "while True: pass"
    )
    said = "evcosim: ended by SIGXCPU (the limit of processor time is 2 s: `ulimit -t`)\n"
    assert (run.returncode, run.stderr) == (128 + signal.SIGXCPU, said)


@pytest.mark.skipif(sys.platform != "linux", reason="machine code's handlers are found in /proc")
@pytest.mark.parametrize(
    ("handler", "said"),
    [
        ("import faulthandler; faulthandler.register(signal.SIGUSR1)", "most recent call first"),
        ("import sys; signal.signal(signal.SIGUSR1, lambda *_: print('mine', file=sys.stderr))", "mine"),
    ],
)
def test_a_signal_that_somebody_else_handles_stays_theirs(handler, said):
    run = after(f"{handler}\ninterrupts.install(); os.kill(os.getpid(), signal.SIGUSR1); time.sleep(0.1)")
    assert run.returncode == 0
    assert said in run.stderr
    assert "evcosim" not in run.stderr


def test_where_no_thread_can_be_started_a_signal_still_ends_the_command():
    code = (
        "import os, signal, threading, time\n"
        'def none(thread): raise RuntimeError("can\'t start new thread")\n'
        "threading.Thread.start = none\n"
        "from evcosim.master.cli import interrupts\n"
        "interrupts.install(); os.kill(os.getpid(), signal.SIGTERM); time.sleep(10)\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=60
    )
    assert (run.returncode, run.stderr) == (143, "evcosim: ended by SIGTERM\n")
