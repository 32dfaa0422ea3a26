"""A word on what takes long before the first step: machine code that is compiled once."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from contextvars import ContextVar

_REPORT: ContextVar[Callable[[str], None] | None] = ContextVar("report", default=None)


@contextlib.contextmanager
def reporting(report: Callable[[str], None] | None) -> Iterator[None]:
    """Call `report` with a text each time that something takes long within the block; None: call nothing."""
    before = _REPORT.set(report)
    try:
        yield
    finally:
        _REPORT.reset(before)


def announce(text: str) -> None:
    """Report that something begins which takes some seconds."""
    if (report := _REPORT.get()) is not None:
        report(text)
