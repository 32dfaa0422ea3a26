"""Tasks on all cores: order, failures, processes that die, Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from evcosim.cosim.can.database import Message, Signal
from evcosim.cosim.can.logs.kept import recorded_once
from evcosim.cosim.can.logs.variants import Variants
from evcosim.master.studies.parallel import Task, TaskError, cores, run_all
from support import tasks
from support.c_fmu import mixed_fmu


def test_results_stand_in_the_order_of_the_tasks():
    """The first ends last."""
    seen = []
    work = [Task(f"{x} squared", tasks.square, (x,), {"after": 0.3 if x == 0 else 0.0}) for x in range(6)]
    outcomes = run_all(work, workers=2, progress=lambda *args: seen.append(args))
    assert [o.result() for o in outcomes] == [0, 1, 4, 9, 16, 25]
    assert [o.name for o in outcomes] == [t.name for t in work]
    assert [(done, total) for done, total, _ in seen] == [(i, 6) for i in range(1, 7)]
    assert seen[0][2] != "0 squared"
    assert sorted(name for _, _, name in seen) == sorted(t.name for t in work)
    assert outcomes[0].seconds > 0.3


def test_what_a_task_makes_possible_is_done_after_all_others():
    """Its outcome stands behind theirs, and it may make further ones possible."""
    said = []

    def then(place, outcome):
        return [Task(f"{outcome.name}+", pow, (outcome.value, 2))] if len(outcome.name) < 3 else []

    tasks = [Task(str(n), abs, (-n,)) for n in (2, 3)]
    outcomes = run_all(tasks, 1, lambda *each: said.append(each), then)
    assert [(o.name, o.value) for o in outcomes] == [
        ("2", 2), ("3", 3), ("2+", 4), ("3+", 9), ("2++", 16), ("3++", 81),
    ]  # fmt: skip # pairs
    assert said == [(1, 3, "2"), (2, 4, "3"), (3, 5, "2+"), (4, 6, "3+"), (5, 6, "2++"), (6, 6, "3++")]
    assert {o.name: o.value for o in run_all(tasks, 2, None, then)} == {o.name: o.value for o in outcomes}


def test_workers_are_other_processes_and_leave_no_files():
    outcomes = [o.result() for o in run_all([Task("where", tasks.where)] * 3, workers=1)]
    (worker,) = {process for process, _ in outcomes}  # one worker does them all
    assert worker != os.getpid()
    assert not any(Path(folder).parent.exists() for _, folder in outcomes)


def test_a_task_that_raises_stops_no_other():
    work = [Task("bad", tasks.refuse, ("mass: -1 kg",)), Task("exits", tasks.leave, (3,))]
    bad, exits, good = run_all([*work, Task("good", tasks.square, (3,))], workers=1)
    assert good.result() == 9
    assert (bad.failure.kind, bad.failure.reason) == ("ConfigError", "mass: -1 kg")
    assert "in refuse" in bad.failure.trace
    assert exits.failure.kind == "SystemExit"
    with pytest.raises(TaskError, match=r"^bad: mass: -1 kg$"):
        bad.result()


@pytest.mark.skipif(sys.platform == "win32", reason="no signals")
def test_a_process_that_dies_is_a_failure_of_its_task_alone():
    work = [
        Task("crashes", tasks.die, (signal.SIGSEGV,)),
        Task("good", tasks.square, (3,)),
        Task("vanishes", tasks.vanish),
        Task("good again", tasks.square, (4,)),
    ]
    outcomes = run_all(work, workers=1)
    assert [o.value for o in outcomes] == [None, 9, None, 16]
    assert outcomes[0].failure.reason == "its process died: SIGSEGV"
    assert outcomes[2].failure.reason == "its process died: exit code 3"
    assert outcomes[2].failure.kind == "ProcessDied"


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere faulthandler alone speaks")
@pytest.mark.parametrize("enabled", [True, False])
def test_a_worker_reports_the_unit_of_a_crash_if_its_caller_does(tmp_path, enabled):
    bad = mixed_fmu(tmp_path / "bad.fmu", 2, behavior=50)  # SIGSEGV in a step
    system = tmp_path / "one.toml"
    system.write_text(f'name = "one"\n[experiment]\nstop_time = 1.0\n[units.unit]\nfmu = "{bad}"\n')
    (tmp_path / "script.py").write_text(f"""
from evcosim import Task, run_all, simulate
from evcosim.master.fmi import crash

if __name__ == "__main__":
    if {enabled}:
        crash.enable()
    task = Task("run", simulate, ({str(system)!r},), {{"isolation": "none"}})
    (outcome,) = run_all([task])
    print(outcome.failure.reason)
""")
    done = subprocess.run([sys.executable, tmp_path / "script.py"], capture_output=True, text=True)
    assert (done.stdout, done.returncode) == ("its process died: SIGSEGV\n", 0)
    if enabled:
        assert "Fatal Python error" in done.stderr
        assert "the unit called last was unit (bad.fmu)" in done.stderr
    else:
        assert done.stderr == ""


def test_what_cannot_be_sent():
    with pytest.raises(TypeError, match="task 'local' cannot be sent to a process"):
        run_all([Task("local", lambda: 1)])
    (outcome,) = run_all([Task("back", tasks.unsendable)])
    assert outcome.value is None
    assert "lambda" in outcome.failure.reason


def test_no_tasks_and_no_workers():
    assert run_all([]) == []
    assert cores() >= 1
    with pytest.raises(ValueError, match="workers = 0"):
        run_all([Task("t", tasks.square, (1,))], workers=0)
    for wrong in ("2", 2.0):
        with pytest.raises(TypeError, match=rf"workers = {wrong!r}: a whole number is needed"):
            run_all([Task("t", tasks.square, (1,))], workers=wrong)


def test_workers_keep_the_stdout_of_the_caller_clean(capfd):
    run_all([Task("says", tasks.say, ("hello",))])
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("hello") == 2


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_workers_end_with_a_caller_that_is_killed(tmp_path):
    mark = tmp_path / "mark"
    text = f"""
from evcosim import Task, run_all
from support import tasks

if __name__ == "__main__":
    run_all([Task("long", tasks.stay, ({str(mark)!r},))])
"""
    (tmp_path / "script.py").write_text(text)
    folder = Path(tasks.__file__).parents[1]
    surroundings = os.environ | {"PYTHONPATH": str(folder), "TMPDIR": str(tmp_path)}
    caller = subprocess.Popen([sys.executable, tmp_path / "script.py"], env=surroundings)
    while not (mark.exists() and mark.read_text()):
        assert caller.poll() is None
        time.sleep(0.02)
    caller.kill()
    caller.wait()
    wait_for_the_end_of(int(mark.read_text()))


def wait_for_the_end_of(process, seconds=60.0):
    """Until there is no such process, or it is one that nobody has asked how it ended."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            os.kill(process, 0)
        except ProcessLookupError:
            return
        status = Path(f"/proc/{process}/stat")
        if status.exists() and status.read_text().rpartition(")")[2].split()[0] == "Z":
            return
        time.sleep(0.02)
    raise AssertionError(f"process {process} goes on")


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to one process")
def test_ctrl_c_ends_all_workers_at_once(tmp_path):
    marks = [tmp_path / "a", tmp_path / "b"]
    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        run_all([Task(m.name, tasks.interrupt_parent, (str(m),)) for m in marks] * 2, workers=1)
    assert time.perf_counter() - begin < 20.0
    assert not marks[1].exists()
    with pytest.raises(ProcessLookupError):
        os.kill(int(marks[0].read_text()), 0)


def test_workers_take_a_log_that_the_caller_has_read(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text("(1.0) can0 123#AABB\n(1.5) can0 123#CCDD\n")
    message = Message("f", "M", 0x123, False, 2, signals={"A": Signal("A", 0, 8)})
    arguments = tmp_path / "a.log", Variants([(message, ["A"])])
    recorded_once(*arguments)
    outcomes = run_all([Task(str(k), tasks.frames_that_were_read_before, arguments) for k in range(2)], 2)
    assert [outcome.result() for outcome in outcomes] == [2, 2]
