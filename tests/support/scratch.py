"""Temporary files of the tests in memory, where the system has a folder for that.

A run unpacks its FMUs and removes them. On a disk that is a quarter of what a short run costs.
"""

from __future__ import annotations

import atexit
import os
import re
import shutil
import sys
import tempfile
from pathlib import Path

_MEMORY = Path("/dev/shm")
_ROOM = 4 << 30
"""Bytes that must be free in it; a run of all tests needs less than a tenth."""

failed = False
"""Set when tests failed, whose folders are then kept until the next run."""


def kept() -> Path:
    """Return the folder of what is made once: beside the temporary folders of the runs in memory."""
    user = f"evcosim-tests-{os.getuid()}"
    here = Path(tempfile.gettempdir())
    return here.parent if here.parent.name == user else here / user


def use() -> None:
    """Let this process, and those that it starts, make their temporary files there; a TMPDIR stays."""
    if "TMPDIR" in os.environ or not _is_good():
        return
    folder = _MEMORY / f"evcosim-tests-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    for left in folder.glob("run-*"):
        if not Path("/proc", left.name.removeprefix("run-")).exists():
            shutil.rmtree(left, ignore_errors=True)
    folder /= f"run-{os.getpid()}"
    folder.mkdir()
    os.environ["TMPDIR"] = tempfile.tempdir = str(folder)
    atexit.register(_leave, folder, os.getpid())


def _is_good() -> bool:
    """Return True if the folder is there, can be written, has room, and libraries can be loaded from it."""
    if sys.platform != "linux" or not _MEMORY.is_mount() or not os.access(_MEMORY, os.W_OK | os.X_OK):
        return False
    about, memory = os.statvfs(_MEMORY), Path("/proc/meminfo").read_text()
    free = min(about.f_bavail * about.f_frsize, int(re.findall(r"MemAvailable: +(\d+)", memory)[0]) << 10)
    return free > _ROOM and not about.f_flag & (os.ST_NOEXEC | os.ST_RDONLY)


def _leave(folder: Path, process: int) -> None:
    if os.getpid() == process and not failed:  # a child that was forked leaves it to its parent
        shutil.rmtree(folder, ignore_errors=True)
