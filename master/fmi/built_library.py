"""A library that was just made of an FMU's sources, loaded once: in a process of its own, as it may crash."""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import signal
import subprocess
import sys
from collections.abc import Collection
from pathlib import Path

from ...cosim import leftovers

_TIME = 60.0  # s
_FOUND = "evcosim found:"
_LOAD = f"""
import ctypes, os, sys
library = ctypes.CDLL(sys.argv[1])
found = [name for name in sys.argv[2:] if hasattr(library, name)]
os.write(1, " ".join(["\\n{_FOUND}", *found, "\\n"]).encode())
"""  # the library may print when it is loaded and when it ends, and what it prints may come at the end only


def exported(path: Path, names: Collection[str]) -> set[str]:
    """Load the library, and return which of the names it exports.

    Raises OSError with the reason why it cannot be loaded.
    """
    command = [sys.executable, "-I", "-c", _LOAD, str(path), *names]
    try:
        code, said = ran(command, path.parent, _TIME)
    except subprocess.TimeoutExpired as error:
        raise OSError(f"loading it took more than {_TIME:g} s") from error
    if code < 0:
        raise OSError(f"loading it ended with {signal.Signals(-code).name}")
    lines = said.strip().splitlines()
    if code:
        last = lines[-1] if lines else "no reason was given"
        raise OSError(_reason(last.removeprefix("OSError: ").replace(f"{path}: ", "")))
    found = [line.removeprefix(_FOUND) for line in lines if line.startswith(_FOUND)]
    return set(" ".join(found).split()) & set(names)


def _reason(said: str) -> str:
    """Return the loader's reason; for a function of Windows or a library that is missing, what to do."""
    if found := re.search(r"undefined symbol: (\w+)", said):
        name = found[1]
        if name.startswith("_") and _in_c_library(name[1:]):  # as _strdup, _snprintf
            return f'{said}, which {name[1:]} is here: CC="cc -D{name}={name[1:]}" evcosim compile ...'
        return f"{said}: its sources call a function that none of them has"
    return said


def _in_c_library(name: str) -> bool:
    """Return True if the C library has a function of this name."""
    return hasattr(ctypes.CDLL(None), name)


def ran(command: list[str], folder: Path, limit: float) -> tuple[int, str]:
    """Run a command in a folder, for `limit` [s] at most; return its exit code and what it printed.

    It ends with this process. Raises FileNotFoundError, TimeoutExpired.
    """
    running = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    )

    def kill() -> None:  # a compiler starts processes of its own
        if hasattr(os, "killpg"):
            os.killpg(running.pid, signal.SIGKILL)
        else:
            running.kill()

    leftovers.add_child(running.pid, kill)
    try:
        out, err = running.communicate(timeout=limit)
    except BaseException:
        with contextlib.suppress(OSError):
            kill()
        running.communicate()
        raise
    finally:
        leftovers.forget_child(running.pid)
    return running.returncode, (err + out).decode("utf-8", "replace")
