"""Exceptions of failed calls, and their text in the importer's log."""

from __future__ import annotations

import os
import traceback

_FOLDER = os.path.join(os.path.dirname(__file__), "..", "..")


class Refused(Exception):
    """A request that FMI or the model's declaration does not allow; its text needs no type and no place."""


class SlaveError(Exception):
    """A failed call; its repr is the message, because pythonfmu logs the repr."""

    def __repr__(self) -> str:
        return str(self)


def message(call: str, error: BaseException) -> str:
    """Return one line for the importer's log: call, exception and place; safe for printf and UTF-8."""
    try:
        text = str(error)
    except Exception:  # str() of a model's exception may raise, which must not hide the exception
        text = "(its text cannot be shown: str() of it fails)"
    if not isinstance(error, Refused):
        text = f"{type(error).__name__}: {text}{_place(error)}"
    return told(f"{call}: {text}")


def told(text: str) -> str:
    """Return a text as the importer's log takes it: a printf format without arguments, UTF-8, no NUL."""
    line = text.replace("%", "%%").replace("\0", "\\0")
    return line.encode("utf-8", "backslashreplace").decode("utf-8")


def _place(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    if not frames:
        return ""
    file = os.path.abspath(frames[-1].filename)
    folder = os.path.abspath(_FOLDER) + os.sep
    return f" ({file.removeprefix(folder)}:{frames[-1].lineno})"
