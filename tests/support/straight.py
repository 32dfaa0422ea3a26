"""Runs of the compiled engine by its tables, or by machine code for the structure of the program."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest

from evcosim.master.engine.compiled import straight
from evcosim.master.engine.engine import Engine


@contextlib.contextmanager
def by_code(wanted: bool) -> Iterator[None]:
    """Let all compiled engines that start and go on within the block be straight-line code, or none."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(straight, "WORTH", 0)
        patch.setattr(straight, "MOST_OPERATIONS", straight.MOST_OPERATIONS if wanted else -1)
        yield


def is_straight(engine: Engine) -> bool:
    """Return True for an engine that does its steps in straight-line code."""
    found = getattr(engine, "_straight", None)
    return found is not None and bool(found.address)
