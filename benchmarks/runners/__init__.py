"""One module for each master: `version()` of it, and `measure(case, folder) -> Measured`.

`version` raises ImportError where the master is not installed; `measure` raises Unable with the reason for a
case that it cannot do. A module is imported in a process of its own.
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from numpy.typing import NDArray


class Unable(RuntimeError):
    """A master cannot do a case. The message says why."""


@dataclasses.dataclass(frozen=True)
class Measured:
    """One run: wall seconds of the stepping loop alone, and the outputs that prove what it did.

    `outputs` has shape (units, signals) after the last step, or (steps, units, signals) where they were
    recorded, which may differ from the reference by `digits`. `order` is that in which the master passes
    values on.
    """

    seconds: float
    outputs: NDArray
    order: Literal["jacobi", "gauss_seidel"]
    digits: float = 1e-9  # a few thousand roundings; a value that is passed on a step late is off by 1e-3
