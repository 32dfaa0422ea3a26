"""Straight-line machine code for the structure of a program, where it is worth its making.

The kernel looks up in tables what each operation is; code that is made for one structure knows it, and takes
a fraction of the time. It is made by LLVM in some hundredths of a second to some tenths, once for all runs of
that structure on this machine, and kept in the cache like the kernel. So it is used at once where the cache
has it, and made where a run is long enough to win the time back; other runs follow the tables.
"""

from __future__ import annotations

import hashlib

from ....cosim.shortage import too_little_memory
from ...builtin import keep_some, kept
from ...machine.hands import POSSIBLE
from ...machine.loaded import Loaded
from . import cache
from .program import Program
from .structure import Structure, key, structure_of

WORTH = 10_000_000
"""Operations of a run for which code is made: they take the kernel longer than LLVM takes to make it."""
MOST_OPERATIONS = 3000
"""Operations of a step, beyond which the code would leave the processor's caches, and take LLVM seconds."""
KEPT = 200
"""Entries of the cache at most; the oldest ones leave it."""
_LLVM = 300e6  # bytes of address space
_SOURCES = tuple(
    f"evcosim.master.engine.compiled.{name}"
    for name in (
        "straight", "straight_code", "straight_calls", "straight_values", "straight_frames", "straight_ways",
        "straight_cells", "straight_numbers", "known_frames", "llvm_text", "structure", "program",
    )
)  # fmt: skip # names
_loaded: dict[str, Loaded] = {}


class Straight:
    """The code of a program: `address` is that of its function, 0 while there is none."""

    def __init__(self, program: Program) -> None:
        self.address = 0
        self._operations, self._left = len(program.ops), float(WORTH)
        self._structure: Structure | None = None
        if POSSIBLE and self._operations <= MOST_OPERATIONS and cache.operation():
            self._structure = structure_of(program)
            self._name = entry(self._structure)
            self._load(_loaded.get(self._name) or kept(self._name))

    def expect(self, steps: int) -> None:
        """Make the code if the run is long enough with so many steps more."""
        self._left -= steps * self._operations
        if self._left > 0 or self.address or self._structure is None:
            return
        self._left = float("inf")  # not again, where it cannot be made
        if not too_little_memory(_LLVM, "straight-line code", "LLVM") and (code := made(self._structure)):
            keep_some(self._name, code, KEPT)  # a cache that keeps nothing is told by the engine's own
            self._load(code)

    def _load(self, code: Loaded | bytes | None) -> None:
        if code is None:
            return
        try:
            _loaded[self._name] = code if isinstance(code, Loaded) else Loaded(code)
        except OSError:  # the system lets no such code run
            return
        self.address = _loaded[self._name].address


def entry(structure: Structure) -> str:
    """Return the name of a structure's entry in the cache."""
    of = hashlib.sha256(key(structure).encode()).hexdigest()[:24]
    return f"straight-{of}-{cache.digest(_SOURCES + cache.KERNEL.sources + cache.WIRE.sources)}.bin"


def made(structure: Structure) -> bytes | None:
    """Return the machine code of a structure, compiled now; None: it cannot be made on this machine."""
    try:
        from .straight_making import machine_code
    except (ImportError, OSError):  # OSError: no memory is left for its libraries
        return None
    return machine_code(structure)
