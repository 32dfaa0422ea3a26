"""The process of one unit: python -m evcosim.master.isolation.child SOCKET MEMORY, two file descriptors.

It does what the master asks for until the socket ends. Its limits hold before any code of the FMU runs.
"""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import pickle
import signal
import socket
import sys
from typing import Any

from . import wire

_FILE = 256 << 20  # bytes of a file that it writes
_MEMORY = 8 << 30  # bytes of address space
_PR_SET_PDEATHSIG = 1


def main() -> None:
    """Serve one unit."""
    _limit()
    connection = socket.socket(fileno=int(sys.argv[1]))
    _Server(connection, int(sys.argv[2])).serve()


def _limit() -> None:
    if sys.platform == "linux":
        # ends us with the master, whatever ends it and whatever we do then
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGKILL))
    import resource

    for kind, most in (
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_FSIZE, _FILE),
        (resource.RLIMIT_AS, _MEMORY),
    ):
        _, hard = resource.getrlimit(kind)
        limit = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (limit, limit))


class _Server:
    """The unit, and what is asked of it."""

    def __init__(self, connection: socket.socket, descriptor: int) -> None:
        self.connection, self.descriptor = connection, descriptor
        self.unit: Any = None

    def serve(self) -> None:
        """Answer until the master has gone."""
        try:
            while True:
                request = wire.receive(self.connection)
                if request[:1] == wire.CALL:
                    self._answer(*pickle.loads(request[1:]))
                else:
                    self._turn(*wire.TURN.unpack(request))
        except (EOFError, OSError):
            os._exit(0)

    def _turn(self, what: bytes, time: float, step_size: float, count: int) -> None:
        unit = self.unit
        try:
            if what == wire.STEP:
                unit.set_inputs()
                unit.start_step(time, step_size, count)
                unit.finish_step()
                unit.get_outputs()
            elif what == wire.FEEDTHROUGH:
                unit.set_inputs()
                unit.get_feedthrough()
            else:
                unit.get_outputs()
        except Exception as error:  # whatever it is, the master raises it
            wire.send(self.connection, self._failure(error))
        else:
            wire.send(self.connection, wire.DONE)

    def _answer(self, name: str, arguments: tuple[Any, ...]) -> None:
        try:
            value = getattr(self, f"do_{name}", None) or getattr(self.unit, name)
            answer = json.dumps({"value": value(*arguments), "warnings": self._warnings()}).encode()
        except Exception as error:  # as above
            answer = self._failure(error)
        wire.send(self.connection, answer)

    def _warnings(self) -> int:
        return 0 if self.unit is None else int(self.unit.warnings)

    def _failure(self, error: Exception) -> bytes:
        kind = type(error).__name__
        said = str(error) if kind in ("FmuError", "UnitError", "ConfigError") else f"{kind}: {error}"
        return json.dumps({"error": said[: wire.LONGEST // 8], "kind": kind}).encode()

    def do_load(self, path: str, name: str, interface: Any) -> None:
        """Read and instantiate the FMU."""
        from pathlib import Path

        from ..fmi.fmu import read_fmu
        from ..loading import load_unit

        self.unit = load_unit(read_fmu(Path(path)), name, interface)

    def do_bind(self, plan: Any, size: int) -> None:
        """Bind the unit to the shared memory."""
        import numpy as np

        self.memory = np.frombuffer(mmap.mmap(self.descriptor, 8 * max(1, size)), dtype=np.float64)
        self.unit.bind(self.memory, plan)


if __name__ == "__main__":
    main()
