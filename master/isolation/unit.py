"""A unit in a process of its own, seen from the master."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import pickle
import time
from collections.abc import Mapping
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ...cosim.errors import ConfigError, ShortageError
from ...cosim.interface import UnitInterface, Value
from ...cosim.plan.unit_plan import FmuSteps, UnitPlan
from ...cosim.shortage import of_temporary_files
from ...cosim.visible import on_one_line
from ..fmi.fmu import Fmu, FmuError, check_runnable
from ..fmi.log import UnitLog
from ..machine import slots as S
from ..machine import tables as L
from ..machine.hands import LOOK_TIME, POSSIBLE, Hand, Span
from ..unit import NO_VALUES, UnitError, floats
from . import framing, handover, shared
from .process import Process, ProcessLimits
from .texts import TextExchange, as_c_text
from .waiting import WAITING

_FREEING = 2.0  # s
_OF_ONE_VARIABLE = ("get", "set")


class IsolatedUnit:
    """A `unit.Unit` in a process of its own, which loads while the caller goes on; `bind` waits for it.

    Raises FmuError when the FMU cannot be run here, UnitError when its process ends or does not answer,
    ShortageError when this machine has no room, file or process for it.
    """

    apart = True

    def __init__(
        self,
        fmu: Fmu,
        name: str,
        interface: UnitInterface,
        limits: ProcessLimits,
        tolerance: float | None = None,
    ) -> None:
        check_runnable(fmu)
        self.name, self.fmu, self.interface = name, fmu, interface
        self._limits = limits
        self._asked, self._time, self._key = "loading", limits.loading, "load_timeout"
        self._loaded = self._freed = False
        self._own = np.zeros(L.TURN_SIZE)
        self._turn = floats(self._own)
        self._turn[L.REQUESTS] = self._turn[L.PENDING] = 1.0
        self.hand: Hand | None = None
        self._deadline = 0.0
        there = dataclasses.replace(fmu, path=fmu.path.resolve())  # its working folder is another one
        try:
            self._begin((there, name, interface, tolerance))
        except OSError as error:
            said = of_temporary_files(error)
            raise ShortageError(f"unit '{name}': its process cannot be started: {said}") from error
        self._side = handover.Side(
            self._process.connection,
            self._slots,
            (S.REQUEST, S.MASTER_SLEEPS),
            (S.ANSWER, S.CHILD_SLEEPS),
            self._slots[S.SPIN],
        )

    def _begin(self, loading: tuple[Fmu, str, UnitInterface, float | None]) -> None:
        """Make the memory that both share, and start the process. Raises OSError."""
        descriptor = shared.create(2 * len(self.interface.variables))
        try:
            self._shared = shared.Shared(descriptor)
            self._slots = self._shared.slots
            self._slots[S.SPIN], self._turn[L.LOOKING] = handover.spin_time(), LOOK_TIME
            self._process = Process(loading, descriptor, self._limits)
        finally:
            os.close(descriptor)

    @property
    def warnings(self) -> int:
        return self._shared.warnings()

    @property
    def asked_end(self) -> float | None:
        return self._slots[S.ASKED_END] if self._slots[S.ASKS_END] else None

    @property
    def warned(self) -> Mapping[str, int]:
        return dict(self._shared.warned())

    # ---- requests

    def _call(self, name: str, *arguments: Any) -> Any:
        """Request a call of the unit's method, once or seldom in a run, and return its value."""
        if not self._loaded:
            self._loaded = True  # whatever the answer is, there is no other
            self._answer(self._frame())
        self._check_free()
        self._asked = name + (f" of {on_one_line(str(arguments[0]))}" if name in _OF_ONE_VARIABLE else "")
        self._request(S.CALL)
        try:
            framing.send(self._process.connection, pickle.dumps((name, arguments)), self._impatience)
        except OSError as error:
            self._ended(error)
        return self._answer(self._frame())

    def _check_free(self) -> None:
        if self._turn[L.PENDING]:
            raise UnitError(f"unit '{self.name}': was interrupted while it was asked for {self._asked}")

    def _request(self, kind: float) -> None:
        self._slots[S.KIND] = kind
        self._turn[L.REQUESTS] += 1.0
        self._turn[L.PENDING] = 1.0
        try:
            self._side.post(self._turn[L.REQUESTS])
        except OSError as error:
            self._ended(error)

    def _finish(self) -> None:
        """Wait until the request is done. Raises UnitError or FmuError with the unit's own message."""
        with WAITING:
            frame = b"" if self._side.comes(self._turn[L.REQUESTS]) else self._sleep()
        if frame or self._slots[S.FRAME]:
            self._answer(frame or self._frame())
        self._turn[L.PENDING] = 0.0

    def _sleep(self) -> bytes:
        self._deadline = time.monotonic() + self._time
        try:
            return self._side.sleep_until(self._turn[L.REQUESTS], framing.LONGEST, self._impatience)
        except (OSError, EOFError) as error:
            self._ended(error)

    def _frame(self) -> bytes:
        self._deadline = time.monotonic() + self._time
        try:
            with WAITING:
                return self._side.frame(framing.LONGEST, self._impatience)
        except (OSError, EOFError) as error:
            self._ended(error)

    def _impatience(self) -> None:
        self._process.check_alive()
        if time.monotonic() > self._deadline:
            raise TimeoutError

    def _answer(self, frame: bytes) -> Any:
        """Return the value in an answer. Raises FmuError or UnitError for an error or an invalid answer."""
        self._turn[L.PENDING] = 0.0
        try:
            answer = json.loads(frame)
        except (ValueError, RecursionError):
            answer = None
        if not isinstance(answer, dict):
            raise UnitError(f"unit '{self.name}': its process sent an invalid answer to {self._asked}")
        if "error" in answer:
            said = str(answer["error"])
            match answer.get("kind"):
                case "FmuError" | "ConfigError":
                    raise FmuError(*said.split("\n"))
                case "ShortageError":
                    raise ShortageError(said)
            raise UnitError(said)
        return answer.get("value")

    def _ended(self, error: Exception) -> NoReturn:
        """Raise UnitError that says how the process ended, or that it did not answer and was ended."""
        if isinstance(error, TimeoutError):
            how = f"did not answer for {self._time:g} s ({self._key}) and was ended"
        else:
            how = self._process.ending()
        self._process.kill()
        said = [f"unit '{self.name}': its process {how}, asked for {self._asked}"]
        said += [f"{what}:\n{text}" for what, text in self._last_words() if text]
        raise UnitError("\n".join(said)) from error

    def _last_words(self) -> list[tuple[str, str]]:
        log = UnitLog()
        for status, text in self._shared.heard():
            log.add(status, text)
        log.close()
        return [("its last messages", log.last()), ("it printed", self._process.printed())]

    # ---- the calls of `unit.Unit`

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        """Keep the pairs of slices, of the run's memory and of the shared one, that a turn copies at once."""
        theirs, _ = shared.private(plan)
        ours, view = floats(self._shared.values), floats(memory)
        numbers = shared.copies(plan.groups, theirs.groups, texts=False)
        texts = shared.copies(plan.groups, theirs.groups, texts=True)
        self._inputs = [(ours, slice(t, t + n), view[h : h + n]) for h, t, n in numbers.inputs]
        self._through, self._outputs = (
            [(view, slice(h, h + n), ours[t : t + n]) for h, t, n in copied]
            for copied in (numbers.through, numbers.outputs)
        )
        self._texts = plan.texts
        self._exchange = TextExchange(self.name, plan.texts, self._call)
        self._texts_in, self._texts_through, self._texts_out = (
            [(h + i, t + i) for h, t, n in copied for i in range(n)] for copied in texts
        )
        self._memory, self._values = view, ours
        if POSSIBLE and self._slots[S.SPIN]:
            self.hand = self._hand(memory, numbers)
        self._call("bind", theirs)

    def _hand(self, memory: NDArray[np.float64], numbers: shared.Copies) -> Hand:
        """Return what machine code needs to hand over a turn."""
        run, own = memory.ctypes.data, self._shared.values.ctypes.data
        back: list[Span] = [
            (own + 8 * there, run + 8 * here, count)
            for here, there, count in (*numbers.through, *numbers.outputs)
        ]
        row = {L.SLOTS: self._shared.address, L.SOCKET: self._process.connection.fileno()}
        return Hand(
            row=row | {L.TURN: self._own.ctypes.data},
            inputs=[(run + 8 * here, own + 8 * there, count) for here, there, count in numbers.inputs],
            outputs=back,
            texts_in=self._send_texts if self._texts_in else None,
            texts_out=self._receive_texts if self._texts_out else None,
        )

    def quicken(self, code: bytes) -> None:
        self._call("quicken", code)

    def settle(self, cores: set[int], look: float) -> None:
        self._slots[S.LOOK] = look
        os.sched_setaffinity(self._process.number, cores)

    def enter_initialization(
        self,
        start_time: float,
        stop_time: float | None,
        values: Mapping[str, Value] = NO_VALUES,
        inputs: Mapping[str, Value] = NO_VALUES,
    ) -> str:
        notice = self._call("enter_initialization", start_time, stop_time, dict(values), dict(inputs))
        return str(notice or "")

    def exit_initialization(self) -> None:
        self._call("exit_initialization")
        self._time, self._key = self._limits.step, "step_timeout"

    def get(self, name: str) -> Value:
        match self._call("get", name):
            case str() as text:
                return as_c_text(text)
            case bool() | int() | float() as value:
                return value
            case [float() as number]:
                return self._texts.text(self._exchange.from_child(number))
        raise UnitError(f"unit '{self.name}': its process sent no value for {on_one_line(name)}")

    def set(self, name: str, value: Value) -> None:
        self._call("set", name, value)

    def save_state(self) -> int:
        """Save the state in its process and return its number (see `fmi.state`)."""
        match self._call("save_state"):
            case int() as number:
                return number
        raise UnitError(f"unit '{self.name}': its process sent no number of a state")

    def restore_state(self, number: int) -> None:
        """Go back to a saved state."""
        self._call("restore_state", number)

    def free_state(self, number: int) -> None:
        """Forget a saved state."""
        self._call("free_state", number)

    def set_inputs(self) -> None:
        """Copy the inputs into the shared memory; the unit takes them with the next request."""
        for target, place, values in self._inputs:
            target[place] = values
        self._send_texts()

    def _send_texts(self) -> None:
        for here, there in self._texts_in:
            self._values[there] = self._exchange.to_child(self._memory[here])

    def get_feedthrough(self) -> None:
        """Note that the unit shows outputs before the step that follows."""
        self._turn[L.SHOWS] = 1.0

    def start_step(self, steps: FmuSteps) -> None:
        """Request the steps; the process does them while the caller goes on."""
        self._check_free()
        for place, number in enumerate(steps, S.STEPS):
            self._slots[place] = number
        self._asked = "a step"
        self._request(S.STEP_SHOWN if self._turn[L.SHOWS] else S.STEP)

    def finish_step(self) -> None:
        if not self._turn[L.PENDING]:
            return
        self._asked = "a step"
        self._finish()
        self._turn[L.FRESH] = 1.0
        if self._turn[L.SHOWS]:
            self._turn[L.SHOWS] = 0.0
            for target, place, values in self._through:
                target[place] = values
            self._take_texts(self._texts_through)

    def get_outputs(self) -> None:
        """Copy the outputs out of the shared memory, where a step has left them, else after a request."""
        if not self._turn[L.FRESH]:
            self._check_free()
            self._asked = "its outputs"
            self._request(S.OUTPUTS)
            self._finish()
        self._turn[L.FRESH] = 0.0
        for target, place, values in self._outputs:
            target[place] = values
        self._take_texts(self._texts_out)

    def _receive_texts(self) -> None:
        self._take_texts(self._texts_through)
        self._take_texts(self._texts_out)

    def _take_texts(self, places: list[tuple[int, int]]) -> None:
        for here, there in places:
            self._memory[here] = self._exchange.from_child(self._values[there])

    def terminate(self) -> None:
        self._call("terminate")

    def free(self) -> None:
        """Release everything; a unit that does not answer within two seconds is ended."""
        if not self._freed:
            self._freed = True
            if not self._turn[L.PENDING]:  # one that still works hears nothing
                self._time = min(_FREEING, self._time)
                with contextlib.suppress(UnitError, ConfigError):  # what fails now changes no result
                    self._call("free")
            self._process.close()
