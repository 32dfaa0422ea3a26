"""A file format of results: a writer of a recording, and a reader that returns the contents of a file."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from ...row_store import Array
from ..recording import Recording
from ..variable import ResultVariable


@dataclasses.dataclass(frozen=True)
class Contents:
    """The contents of a file: `time` [s], shape (n,), `data`, shape (n, m), and the m `variables`.

    The time does not decrease. `manifest` holds the facts of the run as a whole, where the format has a place
    for them.
    """

    time: Array
    data: Array
    variables: Sequence[ResultVariable]
    manifest: Mapping[str, Any] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True)
class Format:
    """A format by its two functions; what they need beyond numpy, they import when they are called.

    `write(recording, file)` writes into a new binary file and lets OSError through; the caller then removes
    what is there. `read(path)` raises ConfigError naming the file, and the place in it where it can.
    """

    write: Callable[[Recording, BinaryIO], None]
    read: Callable[[Path], Contents]
