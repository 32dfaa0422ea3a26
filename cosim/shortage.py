"""Shortages of this process, and the words for them: room on a disk, files, processes, memory.

The system says "Resource temporarily unavailable" and names no limit; these words do, with what to do.
"""

from __future__ import annotations

import errno
import math
import os
import sys
from typing import TypeGuard

LINEAR_ALGEBRA = "scipy.linalg"
"""The module whose library tries without an end to get the memory that it lacks."""
_SCIPY = 150e6  # bytes of address space that scipy and its libraries take

_ANNOUNCED = 2  # s of processor time before its limit

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT)
_NO_FOLDER = (*_NO_ROOM, errno.EROFS, errno.EACCES, errno.EPERM, errno.ENOENT, errno.ENOTDIR)
_LIMITS = {  # the limited thing, its name in `resource`, what sets it, and the unit that this counts
    errno.EMFILE: ("open files", "RLIMIT_NOFILE", "`ulimit -n`", 1, ""),
    errno.EAGAIN: ("processes and threads of a user", "RLIMIT_NPROC", "`ulimit -u`", 1, ""),
    errno.ENOMEM: ("memory", "RLIMIT_AS", "`ulimit -v`, in a unit's process memory_limit", 1024, " KiB"),
    errno.EFBIG: (
        "a file's size",
        "RLIMIT_FSIZE",
        "`ulimit -f`, in a unit's process file_limit",
        1024,
        " KiB",
    ),
}


def is_shortage(error: BaseException) -> TypeGuard[OSError]:
    """Return True for an error of the system behind which a full disk or one of the limits stands."""
    return isinstance(error, OSError) and (error.errno in _NO_ROOM or error.errno in _LIMITS)


def reason(error: OSError) -> str:
    """Return why the system refused something, with the limit behind it and what changes that."""
    said = error.strerror or str(error)
    if error.errno in _NO_ROOM:
        return f"{said}: make room on the disk"
    return said + _limited(error.errno)


def reason_of_import(error: Exception) -> str:
    """Return why a module cannot be loaded where a limit is the reason; "" for another reason."""
    if isinstance(error, OSError):
        return reason(error) if is_shortage(error) else ""
    for number in (errno.EMFILE, errno.ENOMEM):  # the loader of libraries says it in words or by number
        if os.strerror(number) in str(error) or f"Error {number}" in str(error):
            return os.strerror(number) + _limited(number)
    return ""


def of_temporary_files(error: OSError) -> str:
    """Return why a temporary file or folder was refused: the folder of all of them, and what to do."""
    if error.errno not in _NO_FOLDER:
        return reason(error)
    import tempfile  # slow to import, and a command imports this module before all

    said = error.strerror or str(error)
    try:
        where = f"{tempfile.gettempdir()}: "
    except OSError:  # there is none, as the error says
        where = ""
    if error.errno in _NO_ROOM:
        return f"{where}{said}: make room there, or let TMPDIR name another folder"
    return f"{where}{said}: let TMPDIR name a folder that can be written"


def no_thread() -> str:
    """Return why no thread can be started: Python names no reason."""
    limits = _limited(errno.EAGAIN) + _limited(errno.ENOMEM).replace(": ", ", or ", 1)
    return f"no further thread can be started{limits}"


def no_memory() -> str:
    """Return why there is no memory."""
    return f"no memory is left{_limited(errno.ENOMEM)}"


def _limited(number: int | None) -> str:
    """Return ": the limit of ..." for the number of an error behind which a limit of this process stands."""
    if number not in _LIMITS:
        return ""
    what, name, setting, size, unit = _LIMITS[number]
    most = _limit(name)
    if math.isinf(most):
        return ""
    return f": the limit of {what} is {most / size:.0f}{unit} ({setting})"


def _limit(name: str) -> float:
    """Return a limit of this process; infinity without one, and on Windows, which has none."""
    try:
        import resource
    except ImportError:
        return math.inf
    soft, _ = resource.getrlimit(getattr(resource, name))
    return math.inf if soft == resource.RLIM_INFINITY else float(soft)


def announced_time_limit() -> str:
    """Let the limit of processor time announce itself by SIGXCPU, and return " (the limit of ...)"; "": none.

    `ulimit -t` sets both limits at once, and then the system kills the process without a word.
    """
    most = _limit("RLIMIT_CPU")
    if math.isinf(most):
        return ""
    import resource

    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    if most == hard and hard > 1:
        resource.setrlimit(resource.RLIMIT_CPU, (hard - min(_ANNOUNCED, hard - 1), hard))
    return f" (the limit of processor time is {most:.0f} s: `ulimit -t`)"


def memory_left() -> float:
    """Return the bytes of address space that this process may still take; infinity without a limit."""
    most = _limit("RLIMIT_AS")
    if math.isinf(most):
        return most
    try:
        with open("/proc/self/statm") as file:
            return most - int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:  # a system without /proc
        return most


def too_little_memory(least: float, what: str, module: str = "") -> str:
    """Return a sentence where fewer bytes than `least` are left for `what`; "" where there are as many.

    They are those that a `module` takes with its libraries, if it is not loaded yet. Libraries of linear
    algebra do not fail with too little memory: they try again without an end.
    """
    left = memory_left()
    if left >= least or module in sys.modules:
        return ""
    return (
        f"{what} needs {least / 1e6:.0f} MB of memory, and {max(0.0, left) / 1e6:.0f} MB are left"
        f"{_limited(errno.ENOMEM)}"
    )


def require_memory(least: float, what: str, module: str = "") -> None:
    """Raise ShortageError where fewer bytes are left than `too_little_memory` says."""
    from .errors import ShortageError  # as above

    if said := too_little_memory(least, what, module):
        raise ShortageError(said)


def require_scipy() -> None:
    """Raise ShortageError where there is too little memory to load scipy and its libraries."""
    require_memory(_SCIPY, "scipy", LINEAR_ALGEBRA)
