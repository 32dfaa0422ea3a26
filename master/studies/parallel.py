"""Independent tasks on all cores, in processes of their own, since FMUs cannot be shared and may crash.

outcomes = run_all([Task("mass 180", simulate, ("scooter",), {"parameters": {"vehicle.mass": 180.0}})])

Worker processes are started afresh (`spawn`), so that a task sees no state of the caller. They take the tasks
in order, one at a time; the outcomes stand in the order of the tasks, whichever ended first. A task that
raises, or whose process dies, is an outcome with a failure and stops no other one. Ctrl-C ends all workers at
once: they ignore the signal themselves, and the caller kills them. What a worker prints goes to stderr.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import multiprocessing
import os
import pickle
import signal
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Generic, SupportsIndex, TypeVar

from ...cosim import leftovers
from ...cosim.can.logs import kept
from ...cosim.errors import ConfigError, RunError, short
from ...cosim.visible import visible_stream
from ..fmi import crash
from .packing import hiding_no_file, packed

T = TypeVar("T")

_ENDING = 5.0  # s that a process which has closed its pipe may take to end

TaskProgress = Callable[[int, int, str], None]
"""Called with the number of tasks done, the number of all tasks, and the name of the one that just ended."""


@dataclasses.dataclass(frozen=True)
class Task(Generic[T]):
    """A call of a module's function with picklable arguments; errors name it by `name`."""

    name: str
    function: Callable[..., T]
    arguments: tuple[Any, ...] = ()
    keywords: Mapping[str, Any] = dataclasses.field(default_factory=dict)

    def __call__(self) -> T:
        return self.function(*self.arguments, **self.keywords)


@dataclasses.dataclass(frozen=True)
class Failure:
    """The reason why a task has no result: class (`ProcessDied`: none was raised) and message of the
    exception. `trace` is the traceback in the worker."""

    kind: str
    reason: str
    trace: str = ""


class TaskError(RunError):
    """A task failed. The message names the task and the reason; `failure` has the traceback in the worker."""

    def __init__(self, name: str, failure: Failure) -> None:
        super().__init__(f"{name}: {failure.reason}")
        self.failure = failure


@dataclasses.dataclass(frozen=True)
class Outcome(Generic[T]):
    """The result of a task, or else its failure; `seconds` [s] is the time that it took."""

    name: str
    value: T | None
    failure: Failure | None
    seconds: float

    def result(self) -> T:
        """Return the value that the task returned. Raises TaskError with the task's name if it failed."""
        if self.failure is not None:
            raise TaskError(self.name, self.failure)
        return self.value  # type: ignore[return-value] # T may be None itself; without a failure it is a T


def cores() -> int:
    """Return the number of processors that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # Windows and macOS have none
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def run_all(
    tasks: Sequence[Task[T]],
    workers: int | None = None,
    progress: TaskProgress | None = None,
    then: Callable[[int, Outcome[T]], Sequence[Task[T]]] | None = None,
) -> list[Outcome[T]]:
    """Run all tasks in `workers` processes (default: one for each core) and return their outcomes in order.

    `then` is called with the place of each task and its outcome as it ends, and returns the tasks that have
    become possible: they are done after all others, and have the next places.

    A script that calls this needs `if __name__ == "__main__":` around its own calls, since every worker
    imports it; the functions of a notebook stand in a file beside it. Before any task is started it raises
    TypeError for one that cannot be pickled or imported and for `workers` that are no whole number,
    ConfigError for fewer than one.
    """
    if workers is not None and not isinstance(workers, SupportsIndex):
        raise TypeError(f"workers = {short(workers)}: a whole number is needed, or None")
    if workers is not None and workers < 1:
        raise ConfigError(f"workers = {short(workers)}: at least one is needed")
    queue = [(task.name, packed(task, task.name)) for task in tasks]
    outcomes: dict[int, Outcome[T]] = {}
    if not tasks:
        return []
    with _Pool(workers or cores()) as pool:
        for i, outcome in pool.work(queue):
            outcomes[i] = outcome
            if then is not None:
                queue += [(task.name, packed(task, task.name)) for task in then(i, outcome)]
            if progress is not None:
                progress(len(outcomes), len(queue), outcome.name)
    return [outcomes[i] for i in range(len(queue))]


@dataclasses.dataclass
class _Worker:
    """A process, this end of its pipe, and the place of its present task (-1: none) with its begin."""

    process: BaseProcess
    pipe: Connection
    task: int = -1
    begin: float = 0.0


class _Pool:
    """The worker processes, `size` at most; leaving the `with` block kills all of them."""

    def __init__(self, size: int) -> None:
        self.size, self.submitted = size, 0
        self.workers: list[_Worker] = []
        self.context = multiprocessing.get_context("spawn")

    def __enter__(self) -> _Pool:
        # FMUs are extracted below this folder, which is removed here: a killed worker cannot do it
        self.folder = leftovers.temporary_folder()
        kept.hand_over(self.folder)
        return self

    def __exit__(self, *error: object) -> None:
        for worker in self.workers:
            worker.process.kill()
        for worker in self.workers:
            _forget(worker)
        leftovers.remove_folder(self.folder)

    def work(self, queue: Sequence[tuple[str, bytes]]) -> Iterator[tuple[int, Outcome[Any]]]:
        """Yield each task's place and outcome as it ends.

        `queue` has names and tasks, and may grow when one is yielded.
        """
        self._submit_all(queue)
        while busy := {w.pipe: w for w in self.workers if w.task >= 0}:
            for pipe in wait(list(busy)):
                worker = busy[pipe]  # type: ignore[index] # `busy` has pipes alone
                i, (value, failure) = worker.task, _received(worker)
                outcome: Outcome[Any] = Outcome(
                    queue[i][0], value, failure, seconds=time.perf_counter() - worker.begin
                )
                worker.task = -1
                if not worker.process.is_alive():
                    self.workers.remove(worker)
                    _forget(worker)
                self._submit_all(queue)  # the caller may take long
                yield i, outcome
                self._submit_all(queue)

    def _start_worker(self) -> _Worker:
        ours, theirs = self.context.Pipe()
        sent = (theirs, str(self.folder), crash.report() is not None)
        process = self.context.Process(target=_serve, args=sent, daemon=True)
        with _without_ctrl_c(), hiding_no_file():
            process.start()
        theirs.close()  # so that the end of the process is the end of the pipe
        self.workers.append(_Worker(process, ours))
        assert process.pid is not None  # it was started
        leftovers.add_child(process.pid, functools.partial(_kill, process.pid))
        return self.workers[-1]

    def _submit_all(self, queue: Sequence[tuple[str, bytes]]) -> None:
        """Give the tasks that wait to workers that do nothing, and to new ones."""
        while self.submitted < len(queue):
            idle = next((worker for worker in self.workers if worker.task < 0), None)
            if idle is None and len(self.workers) >= self.size:
                return
            worker = idle or self._start_worker()
            worker.task, worker.begin = self.submitted, time.perf_counter()
            self.submitted += 1
            with contextlib.suppress(OSError):  # it died while it was idle: its outcome reports that
                worker.pipe.send_bytes(queue[worker.task][1])


def _kill(process: int) -> None:
    os.kill(process, signal.SIGTERM if os.name == "nt" else signal.SIGKILL)  # Windows has no SIGKILL


def _forget(worker: _Worker) -> None:
    """Wait for the end of a worker that is killed or has ended, and release what belongs to it."""
    worker.process.join()
    worker.pipe.close()
    if worker.process.pid is not None:
        leftovers.forget_child(worker.process.pid)


def _received(worker: _Worker) -> tuple[Any, Failure | None]:
    """Return result and failure that a worker sends; a failure `ProcessDied` if it ended instead."""
    try:
        received: tuple[Any, Failure | None] = pickle.loads(worker.pipe.recv_bytes())
        return received
    except (EOFError, OSError):
        worker.process.join(_ENDING)
        worker.process.kill()  # one that closed its pipe and goes on is of no use
        worker.process.join()
        return None, Failure("ProcessDied", f"its process died: {_ending(worker.process.exitcode)}")


def _ending(code: int | None) -> str:
    if code is not None and code < 0:
        with contextlib.suppress(ValueError):  # a signal that Python has no name for
            return signal.Signals(-code).name
    return f"exit code {code}"


@contextlib.contextmanager
def _without_ctrl_c() -> Iterator[None]:
    """Block Ctrl-C, SIGTERM and SIGHUP within: a process started here never sees them, this one later."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows: a worker ignores it from `_serve` on
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


# ---- in the worker


def _serve(pipe: Connection, folder: str, reports_crash: bool) -> None:
    """Do the tasks that come through the pipe until it is closed; `folder` is for temporary files.

    It `reports_crash`, as its caller does, on stderr: the stack and the unit that was called last.
    """
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # which a whole group of processes may get
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    sys.stdout = sys.stderr = visible_stream(sys.stderr)
    if reports_crash:
        crash.enable()
    os.dup2(2, 1)  # for native code too: the caller's stdout may be read by a machine
    tempfile.tempdir = folder
    kept.share(Path(folder))
    threading.Thread(target=_end_with_caller, daemon=True).start()
    with contextlib.suppress(EOFError, OSError):  # the caller has gone
        while True:
            pipe.send_bytes(_done(pipe.recv_bytes()))


def _end_with_caller() -> None:
    """End this process when the caller has died: a killed caller cannot, and a task may take minutes."""
    caller = multiprocessing.parent_process()
    if caller is not None:
        wait([caller.sentinel])
        os._exit(1)


def _done(packed: bytes) -> bytes:
    """Do a pickled task; return its result and failure, pickled."""
    try:
        task: Task[Any] = pickle.loads(packed)
        return pickle.dumps((task(), None))
    except BaseException as error:  # SystemExit too: only the caller ends a worker
        reason = str(error) or type(error).__name__
        return pickle.dumps((None, Failure(type(error).__name__, reason, traceback.format_exc())))
