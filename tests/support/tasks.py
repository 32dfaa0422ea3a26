"""Functions for worker processes, which import them by name."""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import time
from pathlib import Path

from evcosim.cosim.errors import ConfigError


def square(x, after=0.0):
    """x * x, after some seconds."""
    time.sleep(after)
    return x * x


def where():
    """Process, temporary folder."""
    return os.getpid(), tempfile.mkdtemp()


def refuse(text):
    """Fail as bad input does."""
    raise ConfigError(text)


def leave(code):
    """Ask Python to exit."""
    sys.exit(code)


def die(number):
    """Die by a signal."""
    os.kill(os.getpid(), number)


def vanish():
    """End without a word."""
    os._exit(3)


def say(text):
    """Print to stdout, as Python and as native code do."""
    print(text, flush=True)
    os.write(1, text.encode())


def unsendable():
    """Something that no pipe carries."""
    return lambda: None


def interrupt_parent(path):
    """Leave a mark, Ctrl-C the caller, and go on for a long time."""
    Path(path).write_text(str(os.getpid()))
    os.kill(os.getppid(), signal.SIGINT)
    os.kill(os.getpid(), signal.SIGINT)  # a terminal sends it to all: a worker does not mind
    time.sleep(60.0)


def stay(path):
    """Leave a mark and go on for a long time."""
    Path(path).write_text(str(os.getpid()))
    time.sleep(60.0)


def frames_that_were_read_before(path, variants):
    """Return the number of frames of a log, which somebody else must have read."""
    from evcosim.cosim.can.logs import kept

    def never(path, variants):
        raise AssertionError("it was read anew")

    kept.recorded = never
    return kept.recorded_once(path, variants).table.shape[0]
