"""Repairs of defects in pythonfmu's native library, made from the side of the slave.

- On a failed call the library gives up its references to class, instance and message list, and in
  fmi2FreeInstance once more: `hold` takes them in advance.
- It puts the resources folder at the front of sys.path and leaves it there: `leave_search_path`.
- On Linux, when the process ends, the static pointer to its interpreter guard is destroyed first and released
  once more by the library's destructor, which corrupts the heap of a process whose results are long written:
  `settle_at_exit` releases it in time.
- For every instance it gives up a reference to the globals of the slave module: that module (its text is in
  `build`) takes one.

Relative imports only: this file also runs inside FMUs, in a package of another name.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import sys

_watched: set[str] = set()


def hold(*objects: object) -> None:
    """Take one reference to each object, for the library to give up."""
    for item in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(item))


def leave_search_path(resources: str) -> None:
    """Remove the resources folder from sys.path; everything in it has been imported."""
    if sys.path and sys.path[0] == resources:
        del sys.path[0]


def settle_at_exit(resources: str, name: str) -> None:
    """Make the library of the FMU `name` release its interpreter guard at exit, while it still can.

    This holds only where Python was started as a program: in an interpreter that the library itself started,
    the guard ends that interpreter, and must outlive it.
    """
    library = os.path.join(os.path.dirname(resources.rstrip("/")), "binaries", "linux64", f"{name}.so")
    if sys.platform == "linux" and sys.orig_argv and library not in _watched:
        _watched.add(library)
        atexit.register(_settle, library)


def _settle(library: str) -> None:
    if sys.platform != "linux":
        return
    try:
        loaded = ctypes.CDLL(library, mode=os.RTLD_NOLOAD | os.RTLD_NOW)
    except OSError:
        return  # unloaded meanwhile, and unloading releases the guard as it should
    release = getattr(loaded, "finalizePythonInterpreter", None)  # since pythonfmu 0.7
    if release is not None:
        release()
