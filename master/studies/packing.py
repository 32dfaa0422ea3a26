"""Tasks as bytes for a process of their own, which must be able to import what they name.

A worker imports the script of its caller, and so finds what stands there; a notebook or a prompt is no file
that it could import.
"""

from __future__ import annotations

import contextlib
import io
import os
import pickle
import sys
import types
from collections.abc import Iterator
from multiprocessing import process
from typing import Any


class _NotImportableError(Exception):
    """Something that a task names stands in the main module, which is no file; the argument is its name."""


class _Pickler(pickle.Pickler):
    """A pickler that refuses functions and classes of a main module that no worker can import."""

    def __init__(self, file: io.BytesIO) -> None:
        super().__init__(file)
        self._alone = not main_is_a_file()

    def reducer_override(self, found: Any) -> Any:
        """Leave everything to pickle but what a worker would not find."""
        named = isinstance(found, types.FunctionType | type) and "<" not in found.__qualname__
        if self._alone and named and found.__module__ == "__main__":  # pickle refuses those without a name
            raise _NotImportableError(found.__qualname__)
        return NotImplemented


def packed(task: Any, name: str) -> bytes:
    """Return a task as bytes.

    Raises TypeError naming the task, and what to do, where no other process can read it.
    """
    file = io.BytesIO()
    try:
        _Pickler(file).dump(task)
    except _NotImportableError as error:
        raise TypeError(
            f"task '{name}': {error} is defined in a notebook or at a prompt, from where the processes that "
            "do the tasks cannot import it: write it into a file beside, as tasks.py, with the imports that "
            f"it needs, and take it from there: from tasks import {str(error).partition('.')[0]}"
        ) from None
    except Exception as error:  # pickle raises what the objects' own methods raise
        raise TypeError(f"task '{name}' cannot be sent to a process: {error}") from error
    return file.getvalue()


def main_is_a_file() -> bool:
    """Return whether a worker can import the main module, as a script is and a notebook or stdin is not."""
    main = sys.modules["__main__"]
    if getattr(main, "__spec__", None) is not None:
        return True
    path = getattr(main, "__file__", None)
    folder = getattr(process, "ORIGINAL_DIR", None) or ""
    return path is not None and os.path.isfile(os.path.join(folder, path))


@contextlib.contextmanager
def hiding_no_file() -> Iterator[None]:
    """Keep a worker that is started within from importing `<stdin>`, which Python says is the main file."""
    main = sys.modules["__main__"]
    if main_is_a_file() or not hasattr(main, "__file__"):
        yield
        return
    path = main.__file__
    del main.__file__
    try:
        yield
    finally:
        main.__file__ = path
