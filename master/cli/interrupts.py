"""Signals that end a command, whatever it is doing: Ctrl-C (SIGINT), SIGTERM, SIGHUP, and those below.

Batch systems announce the end of a job by SIGUSR1, SIGUSR2 or SIGXCPU; Ctrl-\\ is SIGQUIT; timers send
SIGALRM. Each signal is taken whose default is to end the process, but for those of a crash.

Python would raise KeyboardInterrupt wherever it happens to be: in an import, which takes it for a missing
module, in a `finally`, in a model that runs on pythonfmu, whose native library makes a failed step of it. And
it would wait for the end of whatever native code is running. So nothing is raised here:

- Where nothing is to be kept, the handler takes away temporary folders, half-written files and children, and
  ends the process with 128 + signal. A thread, which the signal wakes by itself, does it where Python does
  not come to the handler in time.
- While a run has rows to keep (`Interrupts`), the signal is noted, and `check` raises it between two steps.
  The run has PATIENCE to write its results; then, or at a second signal, the thread saves the rows as they
  are and ends the process. While the master waits for a unit in a process of its own, the wait is broken off.

A signal that is ignored at the start stays ignored (nohup), and one that somebody else handles, as
faulthandler or a profiler does, stays theirs. A program that uses evcosim as a library handles signals by
itself: only the command line calls `install`.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import NoReturn

from ...cosim import shortage
from ..isolation.waiting import waits

_exit = os._exit  # `early_exit` puts another one in its place
PATIENCE = 0.7  # s that the end of a run may take
_GRACE = 0.25  # s until the thread ends a process whose handler has not come
_OURS = ("SIGINT", "SIGHUP", "SIGTERM")  # whoever else handles them; Windows has no SIGHUP
_OTHERS = (
    "SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGXCPU", "SIGALRM", "SIGVTALRM", "SIGPROF", "SIGIO", "SIGPWR",
)  # fmt: skip # a list


class Interrupted(KeyboardInterrupt):
    """A signal that ends the command; `number` is the signal's."""

    def __init__(self, number: int = signal.SIGINT) -> None:
        super().__init__()
        self.number = int(number)


def exit_code(error: BaseException) -> int:
    """Return the exit code of a command that a signal has ended: 128 + its number."""
    return 128 + int(getattr(error, "number", signal.SIGINT))


def words(number: int) -> str:
    """Return what is said of a command that a signal has ended."""
    if number == signal.SIGINT:
        return "interrupted"
    name = signal.Signals(number).name
    return f"ended by {name}{_state.time_limit if name == 'SIGXCPU' else ''}"


class _State:
    """The signals of this process: `number` is the first one that came (0: none)."""

    def __init__(self) -> None:
        self.handled: list[int] = []
        self.number = 0
        self.keeping = False
        self.rescue: Callable[[str], str] | None = None
        self.said = self.time_limit = ""
        self.ending = threading.Lock()  # whoever has it ends the process


_state = _State()


def install() -> None:
    """Handle the signals from now on, all but those that are ignored. The process is the command's own."""
    _state.time_limit = shortage.announced_time_limit()
    foreign = _caught()
    for name in (*_OTHERS, *_OURS):
        number = getattr(signal, name, None)
        if number is None or signal.getsignal(number) is signal.SIG_IGN:
            continue
        if name in _OURS or (signal.getsignal(number) is signal.SIG_DFL and number not in foreign):
            signal.signal(number, _handle)
            _state.handled.append(int(number))
    if os.name == "posix":  # Windows has no wake-up by a pipe: there the handler alone does it
        reader, writer = os.pipe()
        os.set_blocking(writer, False)
        thread = threading.Thread(target=_watch, args=(reader,), name="evcosim signals", daemon=True)
        with contextlib.suppress(RuntimeError):  # no thread can be started: the handler alone does it
            thread.start()
            signal.set_wakeup_fd(writer, warn_on_full_buffer=False)


def _caught() -> set[int]:
    """Return the signals that have a handler: Python itself does not know those that machine code set."""
    with contextlib.suppress(OSError, IndexError, ValueError), open("/proc/self/status") as file:
        mask = int(file.read().partition("SigCgt:")[2].split()[0], 16)
        return {number for number in range(1, signal.NSIG) if mask >> (number - 1) & 1}
    return set()  # not Linux


def leave() -> None:
    """Ignore the signals from now on: the command has done all, and its exit code stands."""
    for number in _state.handled:
        signal.signal(number, signal.SIG_IGN)


def wait_if_ending() -> None:
    """Wait for the end of the process, where a thread is ending it."""
    while _state.ending.locked():
        time.sleep(1.0)


def _handle(number: int, frame: FrameType | None) -> None:
    if not _state.number:
        _state.number = number
    if not _state.keeping:
        _end()
    elif waits():
        raise Interrupted(_state.number)


def _watch(reader: int) -> None:
    """Wait for signals, and end the process where its main thread does not do it in time."""
    seen, deadline = 0, 0.0
    while True:
        ready = select.select([reader], [], [], max(0.0, deadline - time.monotonic()) if seen else None)[0]
        if ready:
            for number in os.read(reader, 16):
                if number in _state.handled:
                    seen += 1
                    _state.number = _state.number or number
                    if seen == 1:
                        deadline = time.monotonic() + (PATIENCE if _state.keeping else _GRACE)
        if seen > 1 or (seen and time.monotonic() >= deadline):
            _end()


def _end() -> NoReturn:
    """End the process after a signal."""
    _end_with(words(_state.number), 128 + _state.number)


def end_failed(error: str, code: int) -> NoReturn:
    """End the process at once with an error and an exit code, as after a signal."""
    _end_with(error, code, failed=True)


def _end_with(why: str, code: int, failed: bool = False) -> NoReturn:
    """End the process: save the rows, take away what it would leave, say why."""
    if not _state.ending.acquire(blocking=False):
        while True:  # another thread does it
            time.sleep(1.0)
    said = _state.said
    if _state.keeping and _state.rescue is not None:
        with contextlib.suppress(Exception):  # whatever fails, the process ends
            said = _state.rescue(why if failed else "")
    for module in ("evcosim.cosim.leftovers", "evcosim.fmus.cache"):
        take_away = getattr(sys.modules.get(module), "take_away", None)  # None while it is being imported
        if take_away is not None:
            with contextlib.suppress(Exception):  # as above
                take_away()
    cursor = "\r\x1b[K\x1b[?25h" if _is_terminal() else ""  # a progress bar hides it
    # None while nothing was read yet that could stand in the text
    shown = getattr(sys.modules.get("evcosim.cosim.visible"), "visible", str)(f"evcosim: {why}{said}")
    with contextlib.suppress(OSError):
        os.write(2, f"{cursor}{shown}\n".encode("utf-8", "replace"))
    _exit(code)


def _is_terminal() -> bool:
    with contextlib.suppress(OSError):
        return os.isatty(2)
    return False


class Interrupts:
    """A `with` block in which a signal is noted, and `check` raises Interrupted after it.

    `rescue` saves what is there, when the process ends at once all the same; it is given the error of the run
    ("": a signal) and returns what to say beyond that.
    """

    def __init__(self, rescue: Callable[[str], str] | None = None) -> None:
        self._rescue = rescue

    @property
    def number(self) -> int:
        """The signal that was noted; 0: none."""
        return _state.number

    def check(self) -> None:
        """Raise Interrupted if a signal was noted."""
        if _state.number:
            raise Interrupted(_state.number)

    def __enter__(self) -> Interrupts:
        _state.rescue = self._rescue
        _state.keeping = True
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _state.keeping = False


def say(text: str) -> None:
    """Set what is said beyond the words for a signal that comes from now on."""
    _state.said = text
