"""A unit in a process of its own, seen from the master."""

from __future__ import annotations

import contextlib
import json
import mmap
import os
import pickle
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
from typing import IO, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ...cosim.errors import ConfigError
from ...cosim.interface import UnitInterface
from ...cosim.plan import UnitPlan
from ..fmi.fmu import Fmu, FmuError, check_runnable
from ..unit import UnitError, Value, floats
from . import wire
from .waiting import waiting

_ENDING = 2.0
_SAID = 2000  # characters of its output that are shown


class IsolatedUnit:
    """See `unit.Unit`; `timeout` [s] is what an answer to a call in the run may take, `loading` to the first.

    Raises FmuError when the FMU cannot be run here, UnitError when its process ends or does not answer.
    """

    def __init__(self, fmu: Fmu, name: str, interface: UnitInterface, timeout: float, loading: float) -> None:
        check_runnable(fmu)
        self.name, self.fmu, self.interface = name, fmu, interface
        self.warnings = 0
        self._timeout = timeout
        self._process: subprocess.Popen[bytes] | None = None
        self._asked = "loading"
        self._fresh = self._pending = False
        self._folder = tempfile.mkdtemp(prefix="evcosim-")
        self._output: IO[bytes] = tempfile.TemporaryFile(prefix="evcosim-")  # noqa: SIM115 - closed by `free`
        self._shared = tempfile.TemporaryFile(prefix="evcosim-")  # noqa: SIM115 - closed by `free`
        self._connection, theirs = socket.socketpair()
        try:
            with theirs:
                self._process = self._start(theirs)
            self._call("load", str(fmu.path.resolve()), name, interface, timeout=loading)
        except BaseException:
            self.free()
            raise

    def _start(self, theirs: socket.socket) -> subprocess.Popen[bytes]:
        descriptors = theirs.fileno(), self._shared.fileno()
        return subprocess.Popen(
            [sys.executable, "-m", "evcosim.master.isolation.child", *map(str, descriptors)],
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.STDOUT,
            pass_fds=descriptors,
            cwd=self._folder,
            start_new_session=True,  # Ctrl-C is the master's alone; what it starts ends with it
            env=os.environ | {"TMPDIR": self._folder, "OPENBLAS_NUM_THREADS": "1"},
        )

    # ---- calls

    def _call(self, name: str, *arguments: Any, timeout: float | None = None) -> Any:
        """Ask for something that happens once or seldom."""
        self._asked = name + (f" of {arguments[0]}" if name in ("get", "set") else "")
        try:
            wire.send(self._connection, wire.CALL + pickle.dumps((name, arguments)))
        except OSError as error:
            self._ended(error)
        answer = self._answer(timeout)
        self.warnings = int(answer.get("warnings", self.warnings))
        return answer.get("value")

    def _answer(self, timeout: float | None = None) -> dict[str, Any]:
        self._connection.settimeout(self._timeout if timeout is None else timeout)
        self._pending = True
        try:
            with waiting():
                content = wire.receive(self._connection)
            self._pending = False
            if content == wire.DONE:
                return {}
            answer = json.loads(content)
        except (OSError, EOFError, ValueError) as error:
            self._ended(error, timeout)
        if not isinstance(answer, dict):
            raise UnitError(f"unit '{self.name}': its process answers {answer!r}")
        if "error" in answer:
            of_the_file = answer.get("kind") in ("FmuError", "ConfigError")
            raise (FmuError if of_the_file else UnitError)(answer["error"])
        return answer

    def _turn(self, what: bytes, time: float = 0.0, step_size: float = 0.0, count: int = 0) -> None:
        try:
            wire.send(self._connection, wire.TURN.pack(what, time, step_size, count))
        except OSError as error:
            self._ended(error)

    def _ended(self, error: Exception, timeout: float | None = None) -> NoReturn:
        """Raise UnitError that says how the process ended, or that it did not answer and was ended."""
        limit = self._timeout if timeout is None else timeout
        if isinstance(error, TimeoutError):
            setting = "step_timeout" if timeout is None else "load_timeout"
            how = f"did not answer for {limit:g} s ({setting}) and was ended"
        else:
            how = _ending(self._wait())
        self._kill()
        said = self._said()
        raise UnitError(
            f"unit '{self.name}': its process {how}, asked for {self._asked}" + (f"\n{said}" if said else "")
        ) from error

    def _wait(self) -> int | None:
        assert self._process is not None
        try:
            return self._process.wait(_ENDING)
        except subprocess.TimeoutExpired:
            return None

    def _said(self) -> str:
        """The end of what it printed."""
        size = self._output.seek(0, os.SEEK_END)
        self._output.seek(max(0, size - 4 * _SAID))
        return self._output.read().decode("utf-8", "replace").strip()[-_SAID:]

    # ---- see `unit.Unit`

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        """See `unit.Unit`."""
        theirs, size = wire.private(plan)
        self._shared.truncate(8 * max(1, size))
        ours = floats(np.frombuffer(mmap.mmap(self._shared.fileno(), 8 * max(1, size)), dtype=np.float64))
        view = floats(memory)
        pairs = list(zip(plan.blocks, theirs.blocks, strict=True))
        self._inputs = [
            (ours, slice(t.slot, t.slot + len(b.variables)), view[b.slot : b.slot + len(b.variables)])
            for b, t in pairs
            if b.kind == "input"
        ]
        self._outputs = [
            (view, slice(place, place + len(b.variables)), ours[own : own + len(b.variables)])
            for b, t in pairs
            if b.kind != "input"
            for place, own in [(wire.shown(b), wire.shown(t))]
        ]
        self._through = [
            (view, slice(first, first + b.feedthrough), ours[t.latest : t.latest + b.feedthrough])
            for b, t in pairs
            if b.feedthrough
            for first in (b.slot, b.latest)
        ]
        self._call("bind", theirs, size)

    def enter_initialization(self, start_time: float, stop_time: float | None) -> None:
        """See `unit.Unit`."""
        self._call("enter_initialization", start_time, stop_time)

    def exit_initialization(self) -> None:
        """See `unit.Unit`."""
        self._call("exit_initialization")

    def get(self, name: str) -> Value:
        """See `unit.Unit`."""
        value = self._call("get", name)
        if not isinstance(value, bool | int | float | str):
            raise UnitError(f"unit '{self.name}': its process answers {value!r} for {name}")
        return value

    def set(self, name: str, value: Value) -> None:
        """See `unit.Unit`."""
        self._call("set", name, value)

    def set_inputs(self) -> None:
        """See `unit.Unit`; the unit takes them with the next request."""
        for target, place, values in self._inputs:
            target[place] = values

    def get_feedthrough(self) -> None:
        """See `unit.Unit`."""
        if self._through:
            self._asked = "its outputs"
            self._turn(wire.FEEDTHROUGH)
            self._answer()
            for target, place, values in self._through:
                target[place] = values

    def start_step(self, time: float, step_size: float, count: int) -> None:
        """See `unit.Unit`: the process steps while the caller goes on."""
        self._asked = "a step"
        self._turn(wire.STEP, time, step_size, count)

    def finish_step(self) -> None:
        """See `unit.Unit`."""
        self._answer()
        self._fresh = True

    def get_outputs(self) -> None:
        """See `unit.Unit`; after a step they are there already."""
        if not self._fresh:
            self._asked = "its outputs"
            self._turn(wire.OUTPUTS)
            self._answer()
        self._fresh = False
        for target, place, values in self._outputs:
            target[place] = values

    def terminate(self) -> None:
        """See `unit.Unit`."""
        self._call("terminate")

    def free(self) -> None:
        """See `unit.Unit`. A unit that does not let go is ended."""
        if self._process is not None:
            if self._process.poll() is None and not self._pending:  # one that still works hears nothing
                with contextlib.suppress(UnitError, ConfigError):  # what fails now changes no result
                    self._call("free", timeout=_ENDING)
            self._kill()
            self._process = None
        self._connection.close()
        self._output.close()
        self._shared.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _kill(self) -> None:
        assert self._process is not None
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()


def _ending(code: int | None) -> str:
    if code is None:
        return "closed its connection"
    if code < 0:
        with contextlib.suppress(ValueError):  # a signal that Python has no name for
            return f"was killed by {signal.Signals(-code).name} ({signal.strsignal(-code)})"
    if code == 0:
        return "ended by itself with exit code 0: the FMU called exit()"
    return f"ended by itself with exit code {code}"
