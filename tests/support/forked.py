"""Something hostile in a child of this process, within limits of time and memory."""

from __future__ import annotations

import os
import pickle
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from typing import Any, NamedTuple

MEMORY = 3 << 30
"""Bytes that the child may take beside what it has."""


class Outcome(NamedTuple):
    """What became of a call: `value`, or `crash`, a text, where it raised, was killed or took too long.

    `seconds` are those of the clock on the wall, `busy` those of processors, of its own children too.
    """

    value: Any
    crash: str
    seconds: float
    busy: float = 0.0


def forked(call: Callable[[], Any], limit: float = 10.0) -> Outcome:
    """Return the outcome of a call in a child of this process, which is killed after `limit` seconds."""
    sys.stdout.flush()
    sys.stderr.flush()
    with tempfile.TemporaryFile() as answer:
        began = time.monotonic()
        child = os.fork()
        if child == 0:
            _in_child(call, answer, limit)
        _, status, used = os.wait4(child, 0)
        seconds, busy = time.monotonic() - began, used.ru_utime + used.ru_stime
        answer.seek(0)
        content = answer.read()
    if os.WIFSIGNALED(status):
        number = signal.Signals(os.WTERMSIG(status)).name
        late = f"more than {limit} s" if number == "SIGALRM" else f"killed by {number}"
        return Outcome(None, late, seconds, busy)
    value, crash = pickle.loads(content) if content else (None, f"exit code {os.WEXITSTATUS(status)}")
    return Outcome(value, crash, seconds, busy)


def _in_child(call: Callable[[], Any], answer: Any, limit: float) -> None:
    value, crash = None, ""
    try:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, limit)
        resource.setrlimit(resource.RLIMIT_AS, (_used() + MEMORY, resource.RLIM_INFINITY))
        value = call()
    except BaseException:
        crash = traceback.format_exc()
    finally:
        answer.write(pickle.dumps((value, crash)))
        answer.flush()
        os._exit(0)


def _used() -> int:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[0]) * resource.getpagesize()
