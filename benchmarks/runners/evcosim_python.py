"""This project with the engine in Python."""

from __future__ import annotations

from pathlib import Path

from ..case import Case
from . import Measured, evcosim

version = evcosim.version


def measure(case: Case, folder: Path) -> Measured:
    """Run a case, all units in this process."""
    return evcosim.measure(case, folder, "python")
