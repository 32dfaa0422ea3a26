"""One hostile FMU: how it is made, and what is expected of a run with it."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from pathlib import Path

STEPS = 10
WHOLE = STEPS + 1
"""The rows of a run that ends well."""

Entries = dict[str, bytes]
Mutation = Callable[[Entries, int], Entries]
"""Other entries of those of a good FMU, in a version of FMI."""
Packing = Callable[[Path, Entries], None]
"""Writes the archive of an FMU with these entries."""


@dataclasses.dataclass(frozen=True)
class Case:
    """A good FMU (see `units`) that is made bad in one way.

    `act` is what its library does wrong; `changes` are replacements in its description, each of which must
    change something; `mutate` makes other entries of them, `pack` another archive of the entries.
    `entry` are further lines for the unit in the system file; `timeout` and `loading_timeout` [s] are its
    `step_timeout` and `load_timeout`; `loading` is what the library's constructor does wrong.

    `expected` must stand in what the run says ("…": anything). Of `rows` None means that the FMU is refused,
    WHOLE that the run ends well and `expected` is among its warnings ("": there
    are none), any other number that it fails with so many rows kept. `ending`: a run of WHOLE rows fails
    when its units are terminated. `exact`: the rows before the wrong-doing are those of the good FMU.
    """

    name: str
    what: str
    expected: str
    rows: int | None
    versions: tuple[int, ...] = (2, 3)
    act: str = ""
    changes: tuple[tuple[str, str], ...] = ()
    mutate: Mutation | None = None
    pack: Packing | None = None
    entry: str = ""
    timeout: float = 10.0
    loading_timeout: float = 20.0
    loading: int = 0
    ending: bool = False
    exact: bool = True

    def says(self, said: str) -> bool:
        """Whether it is what is expected."""
        if not self.expected and self.rows == WHOLE:
            return not said
        pattern = ".*".join(re.escape(part) for part in self.expected.split("…"))
        return re.search(pattern, said, re.DOTALL) is not None
