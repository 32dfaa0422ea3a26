"""Commands, their workers and isolated units in processes forked from one which has imported what they need.

Each has its own arguments, folder, environment, output and exit code, and finds nothing left by those before.
Only the imports are done once: a second of each command, and nine tenths of the start of a unit. Tests of the
start itself, of signals, and of what an FMU may do to its process start them afresh.
"""

from __future__ import annotations

import functools
import multiprocessing
import os
import re
import runpy
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from multiprocessing import forkserver, reduction
from multiprocessing.context import ForkServerContext
from pathlib import Path
from typing import IO, Any

import pytest

from evcosim.master.isolation import child

_OF_A_SHELL = re.compile(r"""[|&;<>()$`\\"*?\[\]{}~]""")


def run(line: str, folder: Path, environment: Mapping[str, str]) -> subprocess.CompletedProcess[str]:
    """Run a line of a shell in a folder; return its exit code, stdout and stderr.

    A shell runs it unless it is `evcosim`, or `python` and a script, with arguments and no more: quotes and a
    comment at most.
    """
    if not re.match(r"evcosim |python \w+\.py\b", line) or _OF_A_SHELL.search(
        re.sub("'[^']*'", "", line.split(" #")[0])
    ):
        return subprocess.run(line, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
    arguments = shlex.split(line, comments=True)
    with tempfile.TemporaryDirectory() as kept:
        out, err = Path(kept, "out"), Path(kept, "err")
        given = (arguments, folder, dict(environment), out, err)
        process = context().Process(target=_carry_out, args=given)
        process.start()
        process.join()
        assert process.exitcode is not None
        return subprocess.CompletedProcess(arguments, process.exitcode, out.read_text(), err.read_text())


@functools.cache
def context() -> ForkServerContext:
    """Return what forks processes, from a process that is started by the first call."""
    made = multiprocessing.get_context("forkserver")
    made.set_forkserver_preload(["support.warmed", __name__])
    with pytest.MonkeyPatch.context() as set_for_it:
        set_for_it.setenv("PYTHONPATH", str(Path(__file__).parents[1]))  # where it finds the module
        set_for_it.setenv("OPENBLAS_NUM_THREADS", "1")
        forkserver.ensure_running()
    return made


_POPEN = subprocess.Popen


def popen(command: Any, **options: Any) -> Any:
    """Be subprocess.Popen, but fork what it starts where that is the process of an isolated unit."""
    if isinstance(command, list) and command[1:4] == ["-P", "-m", child.__name__]:
        return Unit(command[4:], options["stdout"], options["pass_fds"], options["cwd"], options["env"])
    return _POPEN(command, **options)


class Unit:
    """The process of an isolated unit: what the master uses of a Popen."""

    def __init__(
        self, arguments: list[str], output: IO[bytes], given: Sequence[int], folder: Path, env: Any
    ) -> None:
        descriptors = [Descriptor(each) for each in (output.fileno(), *given)]
        passed = (descriptors, arguments[len(given) :], folder, dict(env))
        self._process = context().Process(target=_serve, args=passed, daemon=True)
        self._process.start()
        assert self._process.pid is not None
        self.pid = self._process.pid
        while self.poll() is None and os.getpgid(self.pid) != self.pid:  # it cannot be killed as a group yet
            time.sleep(0.001)

    def poll(self) -> int | None:
        """Return the exit code, negative for a signal; None while it runs."""
        return self._process.exitcode

    def wait(self, timeout: float | None = None) -> int:
        """Return the exit code once it has ended. Raises TimeoutExpired."""
        self._process.join(timeout)
        if (code := self.poll()) is None:
            raise subprocess.TimeoutExpired("the process of a unit", timeout or 0.0)
        return code


class Descriptor:
    """A file descriptor, which a forked process gets under a number of its own."""

    def __init__(self, number: int) -> None:
        self.number = number

    def __reduce__(self) -> Any:
        return _taken, (reduction.DupFd(self.number),)


def _taken(handle: Any) -> Any:
    return handle.detach()


def _serve(given: list[int], limits: list[str], folder: Path, environment: dict[str, str]) -> None:
    """Be the process of an isolated unit; the first descriptor is that of its output."""
    os.setsid()
    output, *others = given
    with open(os.devnull, "rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    for descriptor in (1, 2):
        os.dup2(output, descriptor)
    os.close(output)
    _take_over(["", *map(str, others), *limits], folder, environment)
    child.main()


def _take_over(arguments: list[str], folder: Path, environment: dict[str, str]) -> None:
    sys.argv = arguments
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    tempfile.tempdir = None  # is found in this environment


def _carry_out(arguments: list[str], folder: Path, environment: dict[str, str], out: Path, err: Path) -> None:
    """Be the process of a command, from its first line to its exit code."""
    for path, descriptor in ((out, 1), (err, 2)):
        with path.open("wb") as file:
            os.dup2(file.fileno(), descriptor)
    program, *given = arguments
    _take_over(given if program == "python" else arguments, folder, environment)
    forking = multiprocessing.get_context("fork")
    multiprocessing.get_context = lambda method=None: forking  # type: ignore # this process's workers: `run_all`
    if program == "python":
        sys.path.insert(0, str(folder))
        runpy.run_path(str(folder / given[0]), run_name="__main__")
        return
    from evcosim.master.cli import main

    sys.exit(main())
