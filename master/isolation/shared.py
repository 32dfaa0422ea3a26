"""The memory that the master shares with one child: numbers of requests and answers, log messages, values.

All of it is 8-byte slots that hold doubles, counts too (exact up to 2^53): a slot is written as a whole.
Nobody else shares it, so that a unit that writes anywhere spoils nothing but its own values; and the child
cannot make it smaller, which would end the master at its next look. What the child writes is no more than a
claim: the master reads counts and lengths within their bounds.

The last log messages stand here, and not in an answer, since a unit that ends its process answers nothing.
"""

from __future__ import annotations

import dataclasses
import mmap
import os
import tempfile
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...cosim.plan.unit_plan import FmuSteps, SlotGroup, UnitPlan
from ...cosim.texts import Texts
from ..machine import slots as S
from ..unit import floats
from ..warned import KINDS, WarningKinds

_RING, _KEPT, _TEXT = 32, 20, 2048  # first slot, messages, bytes of one
_RECORD = 2 + _TEXT // 8  # status, length, text
_WARNED_AT = _RING + _KEPT * _RECORD  # the first kinds of warnings, which the ring does not keep
_VALUES = -(-(_WARNED_AT + KINDS * _RECORD) // 16) * 16


def create(count: int) -> int:
    """Return the descriptor of a new memory for `count` values; the caller closes it. Raises OSError."""
    size = 8 * (_VALUES + count)
    import fcntl  # Windows has none, and needs none

    if not hasattr(os, "memfd_create"):  # macOS
        with tempfile.TemporaryFile(prefix="evcosim-") as file:
            file.truncate(size)
            return os.dup(file.fileno())
    descriptor = os.memfd_create("evcosim", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    try:
        os.ftruncate(descriptor, size)
        fcntl.fcntl(
            descriptor, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
        )
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


class Shared:
    """The memory behind a descriptor: `slots` are all of it, `values`, shape (size,), those of the unit.

    `address` is where it begins.
    """

    def __init__(self, descriptor: int) -> None:
        self._memory = mmap.mmap(descriptor, os.fstat(descriptor).st_size)
        whole = np.frombuffer(self._memory, dtype=np.float64)
        self.slots, self.address = floats(whole), whole.ctypes.data
        self.values = whole[_VALUES:]
        self._kinds = WarningKinds()

    def warnings(self) -> int:
        """Return the number of warnings that the child has counted."""
        return _count(self.slots[S.WARNINGS])

    def hear(self, status: int, text: str) -> None:
        """Keep a log message; the child calls it."""
        number = _count(self.slots[S.MESSAGES])
        content = text.encode("utf-8", "replace")[:_TEXT]
        self._write(_RING + number % _KEPT * _RECORD, status, content)
        self.slots[S.MESSAGES] = number + 1
        if status == 1:
            self.slots[S.WARNINGS] += 1  # the exact number comes with the answer, if one comes
            self._warn(text, content)

    def _warn(self, text: str, content: bytes) -> None:
        """Count a warning with those of its kind; a new kind is kept, if it is one of the first."""
        number = self._kinds.add(text)
        if number is None:
            return
        place = _WARNED_AT + number * _RECORD
        if number < _count(self.slots[S.WARNED]):
            self.slots[place] += 1  # in a record of the ring it is the status
        else:
            self._write(place, 1, content)
            self.slots[S.WARNED] = number + 1

    def warned(self) -> list[tuple[str, int]]:
        """Return the first text of each of the first kinds of warnings, and their number."""
        number = min(_count(self.slots[S.WARNED]), KINDS)
        found = [self._read(_WARNED_AT + i * _RECORD) for i in range(number)]
        return [(content.decode("utf-8", "replace"), count) for count, content in found]

    def heard(self) -> list[tuple[int, str]]:
        """Return the last log messages, at most 20, as (status, text)."""
        number = _count(self.slots[S.MESSAGES])
        found = []
        for i in range(max(0, number - _KEPT), number):
            status, content = self._read(_RING + i % _KEPT * _RECORD)
            found.append((status, content.decode("utf-8", "replace")))
        return found

    def _write(self, place: int, status: int, content: bytes) -> None:
        self.slots[place], self.slots[place + 1] = status, len(content)
        self._memory[8 * (place + 2) : 8 * (place + 2) + len(content)] = content

    def _read(self, place: int) -> tuple[int, bytes]:
        length = min(_count(self.slots[place + 1]), _TEXT)
        return _count(self.slots[place]), self._memory[8 * (place + 2) : 8 * (place + 2) + length]


def fmu_steps(slots: memoryview[float]) -> FmuSteps:
    """Return the FMU steps that the master has written."""
    first, advance, divisor, total, *sizes = slots[S.STEPS : S.STEPS_END]
    return FmuSteps(first, advance, divisor, _count(total), *sizes)


def _count(number: float) -> int:
    """Return the count that stands in a slot; 0 for a number that is none."""
    return int(number) if 0.0 <= number < 2.0**53 else 0


def private(plan: UnitPlan) -> tuple[UnitPlan, int]:
    """Return the plan of a unit with its groups in a memory of their own, from 0 on, and the size of that."""
    groups, place = [], 0
    for group in plan.groups:
        n = len(group.variables)
        latest = place + n if group.kind == "continuous" else -1
        groups.append(dataclasses.replace(group, slot=place, latest=latest))
        place += 2 * n if group.kind == "continuous" else n
    return dataclasses.replace(plan, groups=tuple(groups), routes=(), texts=Texts()), place


CopiedSlots = tuple[int, int, int]
"""Values that are copied: their first slots in the run's memory and in the shared one, and their number."""


class Copies(NamedTuple):
    """The values that a turn copies: `inputs` before it, after it those that feed `through` and `outputs`."""

    inputs: list[CopiedSlots]
    through: list[CopiedSlots]
    outputs: list[CopiedSlots]


def copies(ours: Sequence[SlotGroup], theirs: Sequence[SlotGroup], texts: bool) -> Copies:
    """Return the copies of a unit's groups, which stand in the run's memory and in the shared one.

    They are those of numbers, or with `texts` those of the numbers of texts.
    """
    pairs = [(o, t) for o, t in zip(ours, theirs, strict=True) if (o.type == "String") == texts]
    return Copies(
        inputs=[(o.slot, t.slot, len(o.variables)) for o, t in pairs if o.kind == "input"],
        through=[(o.slot, t.slot, o.feedthrough) for o, t in pairs if o.feedthrough],
        outputs=[(_shown(o), _shown(t), len(o.variables)) for o, t in pairs if o.kind != "input"],
    )


def _shown(group: SlotGroup) -> int:
    """Return the first slot into which a unit writes the outputs of a group after its step."""
    return group.latest if group.kind == "continuous" else group.slot
