"""Byte code of the sources, which Python keeps beside them, but not where PYTHONDONTWRITEBYTECODE is set.

Many containers set it. Every process that a test starts would then parse all modules again: a fifth of what a
short run costs.
"""

from __future__ import annotations

import compileall
import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

_ROOT = Path(__file__).parents[2]
_FOLDERS = ("api", "benchmarks", "cosim", "fmus", "master", "models", "tests/support")


def compile_sources() -> None:
    """Compile the sources that have changed, as far as the folders can be written."""
    if sys.dont_write_bytecode and "PYTEST_XDIST_WORKER" not in os.environ:  # whose parent has done it
        for name in _FOLDERS:
            compileall.compile_dir(_ROOT / name, quiet=2)


@contextlib.contextmanager
def written() -> Iterator[None]:
    """Let this process write byte code: pytest that of the modules of tests, whose assertions it rewrites."""
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, False
    try:
        yield
    finally:
        sys.dont_write_bytecode = before
