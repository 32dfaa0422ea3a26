"""The tables of the frame path as its machine code finds them: an address and a shape each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....cosim.can.wire.tables import Wire
from ..fault_tables import Arrays

WORDS = 3
"""Words of a table: address, rows, columns (0: it has one dimension)."""


def wire_table(arrays: Arrays, helper: int) -> NDArray[np.int64]:
    """Return address and shape of each table, in the order of `Wire`, shape (tables, 3).

    `helper` is the address of the function of Python that `ask` calls.
    """
    found = np.zeros((len(Wire._fields), WORDS), dtype=np.int64)
    for row, name in zip(found, Wire._fields, strict=True):
        if name == "helper":
            row[0] = helper
        else:
            row[: 1 + arrays[name].ndim] = (arrays[name].ctypes.data, *arrays[name].shape)
    return found
