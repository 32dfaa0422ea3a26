"""Machine code that another process has made (see `flat`), mapped into this one."""

from __future__ import annotations

import mmap
import os

import numpy as np


class Loaded:
    """Machine code that is in the memory of this process as long as this object is.

    `address` is that of its first byte. Raises OSError where the system lets no such code run.
    """

    def __init__(self, code: bytes) -> None:
        descriptor = os.memfd_create("evcosim-code", os.MFD_CLOEXEC)
        try:
            with open(descriptor, "wb", closefd=False) as file:
                file.write(code)  # all of it, or OSError: a limit on the size of files counts here too
            self._memory = mmap.mmap(descriptor, len(code), mmap.MAP_PRIVATE, mmap.PROT_READ | mmap.PROT_EXEC)
        finally:
            os.close(descriptor)
        self.address = int(np.frombuffer(self._memory, dtype=np.uint8).ctypes.data)
