"""Machine code that another process has made (see `flat`), mapped into this one."""

from __future__ import annotations

import ctypes
import mmap
import os

import numpy as np

_ARGUMENTS = ctypes.c_int, ctypes.POINTER(ctypes.c_int64), ctypes.c_void_p, ctypes.c_int64
_RELEASING, _HOLDING = ctypes.CFUNCTYPE(*_ARGUMENTS), ctypes.PYFUNCTYPE(*_ARGUMENTS)


class Loaded:
    """A function of one int64 in machine code; `locked`: it holds Python's lock while it runs.

    Raises OSError where the system lets no such code run.
    """

    def __init__(self, code: bytes, locked: bool = False) -> None:
        descriptor = os.memfd_create("evcosim-code", os.MFD_CLOEXEC)
        try:
            os.write(descriptor, code)
            self._memory = mmap.mmap(descriptor, len(code), mmap.MAP_PRIVATE, mmap.PROT_READ | mmap.PROT_EXEC)
        finally:
            os.close(descriptor)
        self._answer = ctypes.c_int64()
        self._call = (_HOLDING if locked else _RELEASING)(
            np.frombuffer(self._memory, dtype=np.uint8).ctypes.data
        )

    def __call__(self, argument: int) -> int:
        """Return what the function returns."""
        self._call(ctypes.byref(self._answer), None, argument)
        return self._answer.value
