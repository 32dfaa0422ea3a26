"""What a test needs of the machine beside Python."""

from __future__ import annotations

import importlib
import os
import shutil
import sys
from typing import Any, NoReturn

import pytest


def give_up(reason: str) -> NoReturn:
    """Skip for want of a tool or a network; fail where CI says that it has them."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(reason)
    raise AssertionError(reason)


def need_c_compiler() -> None:
    """Give up where there is no `cc`."""
    if shutil.which("cc") is None:
        give_up("there is no C compiler (cc) on this machine")


def need_linux() -> None:
    """Give up on another system."""
    if sys.platform != "linux":
        give_up("this needs what Linux has: its libraries and /proc")


def need_module(name: str) -> Any:
    """Return a module of the extra `test`, or give up where it is not installed."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        if os.environ.get("CI"):
            raise
        pytest.skip(f"{name} is not installed: pip install -e '.[test]'", allow_module_level=True)
