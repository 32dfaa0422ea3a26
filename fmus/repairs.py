"""Repairs of defects in pythonfmu's native library, made from the side of the slave.

- On a failed call the library gives up its references to class, instance and message list, and in
  fmi2FreeInstance once more: `hold` takes them in advance.
- It puts the resources folder at the front of sys.path and leaves it there: `leave_search_path`.
- On Linux, when the process ends, the static pointer to its interpreter guard is destroyed first and released
  once more by the library's destructor, which corrupts the heap of a process whose results are long written:
  `settle_at_exit` releases it in time.
- In a host that is no Python program it starts Python with the handler of a program for SIGINT, so that
  Ctrl-C no longer ends the host: `give_back_interrupts` restores what was there.
- For every instance it gives up a reference to the globals of the slave module: that module (its text is in
  `build`) takes one.

Relative imports only: this file also runs inside FMUs, in a package of another name.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import signal
import sys

_watched: set[str] = set()
_given_back = False


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

    Where Python was started as a program, Python does it at its end. In an interpreter that the library
    itself started, the guard ends that interpreter: there the C library does it, before it destroys what the
    library made earlier, and the library stays loaded to the end of the process.
    """
    library = os.path.join(os.path.dirname(resources.rstrip("/")), "binaries", "linux64", f"{name}.so")
    if sys.platform != "linux" or library in _watched:
        return
    _watched.add(library)
    if sys.orig_argv:
        atexit.register(_settle, library)
    else:
        _settle_with_the_process(library)


def give_back_interrupts() -> None:
    """Leave Ctrl-C to a host that is no Python program, once: to its own handler, or to end the process.

    Python replaces the system's default alone, so that a handler of the host is still there. The call of
    the C library works in every thread; `signal.signal` would need the one in which Python was started.
    """
    global _given_back
    if sys.orig_argv or _given_back or os.name != "posix":
        return
    _given_back = True
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        restore = ctypes.CDLL(None).signal
        restore.argtypes, restore.restype = (ctypes.c_int, ctypes.c_void_p), ctypes.c_void_p
        restore(int(signal.SIGINT), None)  # SIG_DFL


def _settle_with_the_process(library: str) -> None:
    """Let the C library release the guard when the process ends (__cxa_atexit, the last one first)."""
    if sys.platform != "linux":
        return
    try:
        loaded = ctypes.CDLL(library, mode=os.RTLD_NOLOAD | os.RTLD_NOW | os.RTLD_NODELETE)
    except OSError:
        return
    release = getattr(loaded, "finalizePythonInterpreter", None)  # since pythonfmu 0.7
    if release is not None:
        at_exit = ctypes.CDLL(None).__cxa_atexit
        at_exit.argtypes = (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
        at_exit(ctypes.cast(release, ctypes.c_void_p), None, None)


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
