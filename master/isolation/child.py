"""The process of one unit: python -m evcosim.master.isolation.child, with the file descriptors of the socket,
of the shared memory and of the pipe that ends with the master, and the limits of memory and files in bytes.

It carries out the master's requests until the socket ends. Its limits hold before any code of the FMU runs.
"""

from __future__ import annotations

import contextlib
import ctypes
import fcntl
import json
import os
import pickle
import resource
import signal
import socket
import sys
import tempfile
import threading
from typing import TYPE_CHECKING, Any

from ..machine import slots as S
from . import framing, shared
from .handover import Side
from .shared import Shared
from .texts import is_long, part_of, piece_of

if TYPE_CHECKING:
    from .machine_turns import MachineTurns

_SET_CHILD_SUBREAPER = 36  # linux/prctl.h


def main() -> None:
    """Load one unit, and serve it to the end."""
    connection, memory, life = map(int, sys.argv[1:4])
    for descriptor in (connection, memory, life):
        os.set_inheritable(descriptor, False)  # processes of the FMU do not keep them open
    tempfile.tempdir = os.environ["TMPDIR"]  # where it is full, too: the others are not removed at the end
    _end_with_master(life)
    _adopt()
    _limit(resource.RLIMIT_CORE, 0.0)
    _limit(resource.RLIMIT_AS, float(sys.argv[4]))
    _limit(resource.RLIMIT_FSIZE, float(sys.argv[5]))
    with open(framing.LOADING, "rb") as file:
        arguments = pickle.load(file)  # the master's, and no code of the FMU has run
    os.remove(framing.LOADING)
    Server(socket.socket(fileno=connection), Shared(memory)).serve(arguments)


def _end_with_master(life: int) -> None:
    """End this process and those that it starts, as long as they stay in its group, when the pipe ends.

    On Linux the system does it, whatever the FMU does then and whichever thread of the master started us.
    """
    if sys.platform == "linux":
        fcntl.fcntl(life, fcntl.F_SETOWN, -os.getpgrp())
        fcntl.fcntl(life, fcntl.F_SETSIG, signal.SIGKILL)
        fcntl.fcntl(life, fcntl.F_SETFL, fcntl.fcntl(life, fcntl.F_GETFL) | os.O_ASYNC | os.O_NONBLOCK)
        try:
            if os.read(life, 1) == b"":  # it had ended before
                os._exit(0)
        except BlockingIOError:
            return
    threading.Thread(target=_watch, args=(life,), daemon=True).start()


def _watch(life: int) -> None:
    os.read(life, 1)
    os.killpg(0, signal.SIGKILL)


def _adopt() -> None:
    """Adopt processes whose own parent, a process of ours, has ended, so that the master finds them."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def _limit(kind: int, most: float) -> None:
    _, hard = resource.getrlimit(kind)
    if most != float("inf"):
        limit = int(most) if hard == resource.RLIM_INFINITY else min(int(most), hard)
        resource.setrlimit(kind, (limit, limit))


class Server:
    """The unit, and the requests to it: a turn, a method of the unit, or one of the methods do_... here."""

    def __init__(self, connection: socket.socket, memory: Shared) -> None:
        self.connection, self.memory, self.slots = connection, memory, memory.slots
        mine, theirs = (S.ANSWER, S.CHILD_SLEEPS), (S.REQUEST, S.MASTER_SLEEPS)
        self.side = Side(connection, memory.slots, mine, theirs, memory.slots[S.SPIN])
        self.unit: Any = None
        self.texts: Any = None
        self.machine: MachineTurns | None = None

    def serve(self, loading: tuple[Any, ...]) -> None:
        """Load the unit, then answer until the master has gone."""
        side, number = self.side, 1.0
        try:
            self._answer(number, "load", loading)
            while True:
                if self.machine is not None:
                    number = self._turns(self.machine, number)
                number += 1.0
                looks = self.machine is None  # machine code has looked
                frame = b"" if looks and side.comes(number) else side.sleep_until(number, sys.maxsize)
                if self.slots[S.KIND] == S.CALL:
                    self._answer(number, *pickle.loads(frame or side.frame(sys.maxsize)))
                elif self.machine is None or self.slots[S.KIND] == S.OUTPUTS:
                    self._turn(number)
                else:
                    number -= 1.0  # machine code does it
        except EOFError:
            os._exit(0)
        except OSError:
            os._exit(framing.LOST)

    def _turns(self, machine: MachineTurns, number: float) -> float:
        """Do the turns after request `number` in machine code while they come; return the last number."""
        while True:
            failure = b""
            try:
                number, answered = machine.do(number)
            except Exception as error:  # as below
                number, answered, failure = machine.number, False, _failure(error)
            if answered:
                return number
            self._post(number, failure)

    def _turn(self, number: float) -> None:
        unit, slots = self.unit, self.slots
        kind = slots[S.KIND]
        failure = b""
        try:
            if kind != S.OUTPUTS:
                unit.set_inputs()
                if kind == S.STEP_SHOWN:
                    unit.get_feedthrough()
                unit.start_step(shared.fmu_steps(slots))
                unit.finish_step()
            unit.get_outputs()
        except Exception as error:  # whatever it is, the master raises it
            failure = _failure(error)
        self._post(number, failure)

    def _answer(self, number: float, name: str, arguments: tuple[Any, ...]) -> None:
        try:
            value = getattr(self, f"do_{name}", None) or getattr(self.unit, name)
            answer = json.dumps({"value": value(*arguments)}).encode()
        except Exception as error:  # as above
            answer = _failure(error)
        self._post(number, answer)

    def _post(self, number: float, frame: bytes) -> None:
        """Hand the turn over: the request is done, with a frame where there is an answer or an error."""
        slots = self.slots
        if self.unit is not None:
            slots[S.WARNINGS] = self.unit.warnings
            if self.unit.asked_end is not None:
                slots[S.ASKS_END], slots[S.ASKED_END] = 1.0, self.unit.asked_end
        slots[S.FRAME] = 1.0 if frame else 0.0
        self.side.post(number)
        if frame:
            framing.send(self.connection, frame)

    def do_load(self, fmu: Any, name: str, interface: Any, tolerance: Any) -> None:
        """Instantiate the FMU."""
        from ..fmi.loading import load_unit
        from ..fmi.log import UnitLog

        UnitLog.listener = self.memory.hear
        self.unit = load_unit(fmu, name, interface, tolerance)

    def do_learn_text(self, text: str) -> float:
        """Return the number of a text of the master's."""
        return float(self.texts.number(text))

    def do_texts_since(self, count: int) -> list[str]:
        """Return texts that the master does not know, in order; none where the first is in pieces."""
        return part_of(self.texts.since(count))

    def do_piece_of_text(self, number: int, start: int) -> str:
        """Return a piece of a text, from a character on; "" behind its end, and where there is no text."""
        return piece_of(self.texts.text(number), start) if number < len(self.texts) else ""

    def do_get(self, name: str) -> Any:
        """Return the value of a variable; of a text that is longer than an answer its number, in a list."""
        value = self.unit.get(name)
        return [self.texts.number(value)] if is_long(value) else value

    def do_quicken(self, code: bytes) -> bool:
        """Do the turns from now on in machine code; False: this unit, or this system, does not allow it."""
        from ..machine.rows import direct
        from .machine_turns import MachineTurns

        instance = direct(self.unit)
        if instance is not None:
            with contextlib.suppress(OSError):
                self.machine = MachineTurns(code, instance, self.memory, self.connection.fileno())
        return self.machine is not None

    def do_bind(self, plan: Any) -> None:
        """Bind the unit to the shared memory."""
        self.texts = plan.texts
        self.unit.bind(self.memory.values, plan)


def _failure(error: Exception) -> bytes:
    kind = type(error).__name__
    said = (
        str(error)
        if kind in ("FmuError", "UnitError", "ConfigError", "ShortageError")
        else f"{kind}: {error}"
    )
    return json.dumps({"error": said[: framing.LONGEST // 8], "kind": kind}).encode()


if __name__ == "__main__":
    main()
