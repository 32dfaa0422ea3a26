"""The process of an isolated unit as the master holds it: its start, its output, its end."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import os
import pickle
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from ...cosim import leftovers
from . import framing

_ENDING = 2.0  # s
_SAID = 2000  # characters of its output that are shown
_LOOK = 0.25  # s between two looks at a process that does not answer


@dataclasses.dataclass(frozen=True)
class ProcessLimits:
    """The limits of a process.

    `memory` [bytes] of address space and `file` [bytes] of each file that it writes, both may be infinite;
    `loading` [s] for an answer up to the first step, `step` [s] for one after it.
    """

    memory: float = 8e9
    file: float = 256e6
    loading: float = 60.0
    step: float = 30.0


class Process:
    """A child that was started, and loads the FMU of `loading` (arguments of `child.Server.do_load`) at once.

    `connection` is its socket; a call of it raises TimeoutError when a quarter of a second has passed. Raises
    OSError where the system has no room, file or process for it.
    """

    def __init__(self, loading: tuple[Any, ...], memory: int, limits: ProcessLimits) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        with contextlib.ExitStack() as held, contextlib.ExitStack() as given:
            held.callback(self.kill)
            self._folder = held.enter_context(leftovers.temporary())
            self._output = held.enter_context(tempfile.TemporaryFile(prefix="evcosim-"))
            self.connection, theirs = socket.socketpair()
            held.enter_context(self.connection)
            given.enter_context(theirs)
            end, life = os.pipe()
            held.enter_context(os.fdopen(life, "wb", 0))
            given.enter_context(os.fdopen(end, "rb", 0))
            self.connection.settimeout(_LOOK)
            (self._folder / framing.LOADING).write_bytes(pickle.dumps(loading))
            self._start((theirs.fileno(), memory, end), limits)
            self._held = held.pop_all()

    def _start(self, descriptors: tuple[int, ...], limits: ProcessLimits) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "evcosim.master.isolation.child"]
            + [str(each) for each in (*descriptors, limits.memory, limits.file)],
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.STDOUT,
            pass_fds=descriptors,
            cwd=self._folder,
            start_new_session=True,  # Ctrl-C is the master's alone; its own processes end with it
            env=os.environ | {"TMPDIR": str(self._folder), "OPENBLAS_NUM_THREADS": "1"},
        )
        leftovers.add_child(self._process.pid, functools.partial(_kill, self._process.pid))

    @property
    def number(self) -> int:
        """The number of the process. Raises ProcessLookupError when it has been closed."""
        if self._process is None:
            raise ProcessLookupError("the process ended")
        return self._process.pid

    def check_alive(self) -> None:
        """Raise EOFError when it has ended, though something that it started may hold its socket open."""
        if self._process is None or self._process.poll() is not None:
            raise EOFError("the process ended")

    def ending(self) -> str:
        """Wait for its end, and return how it ended, in words that follow "its process"."""
        assert self._process is not None
        try:
            code = self._process.wait(_ENDING)
        except subprocess.TimeoutExpired:
            return "closed its connection and was ended"
        if code == framing.LOST:
            return "lost its connection to the master: the FMU closed or replaced files that are not its own"
        if code < 0:
            with contextlib.suppress(ValueError):  # a signal that Python has no name for
                return f"was killed by {signal.Signals(-code).name} ({signal.strsignal(-code)})"
        if code == 0:
            return "ended by itself with exit code 0: the FMU called exit()"
        return f"ended by itself with exit code {code}"

    def printed(self) -> str:
        """Return the end of its output, at most 2000 characters."""
        size = self._output.seek(0, os.SEEK_END)
        self._output.seek(max(0, size - 4 * _SAID))
        return self._output.read().decode("utf-8", "replace").strip()[-_SAID:]

    def kill(self) -> None:
        """End it and the processes that it started, while it lives also those that left its process group."""
        if self._process is not None:
            _kill(self._process.pid, self._process.poll() is None)
            self._process.wait()
            leftovers.forget_child(self._process.pid)

    def close(self) -> None:
        """Kill it and release all that belongs to it."""
        self.kill()
        self._process = None
        self._held.close()


def _kill(process: int, alive: bool = True) -> None:
    """Kill the group of a process, and while it is alive also what it started and left the group."""
    if alive:
        _end_descendants(process)
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process, signal.SIGKILL)


def _end_descendants(process: int) -> None:
    """Kill the processes that a process started, and theirs; none where there is no /proc that shows them."""
    with contextlib.suppress(OSError):
        for thread in Path(f"/proc/{process}/task").iterdir():
            for child in map(int, (thread / "children").read_text().split()):
                _end_descendants(child)
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.kill(child, signal.SIGKILL)
