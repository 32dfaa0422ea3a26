"""The writer of all files, so that the name of one never stands for half a file.

Beside it data as JSON has it, and tables in pages.
"""

from __future__ import annotations

import contextlib
import errno
import math
import os
import secrets
import stat
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from . import shortage
from .errors import ConfigError
from .file_names import check_name, flaw_of_name
from .leftovers import partial

_DRAFT, _DRAFT_SUFFIX = ".evcosim-", ".part"  # begin and end of the name of a file that is being written


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Give a binary file, open for writing and reading, which takes the place of `path` when the block ends.

    It is a new file in the same folder, which is made if needed; where the block raises, it is removed and
    `path` is as it was. A link in the place of `path` is replaced, never followed; anything else that is no
    regular file is refused. Raises ConfigError naming the path and the reason when the folder or the disk
    refuses, within the block too.
    """
    _check_name(path)
    # beside it: a rename must not cross disks
    draft = path.with_name(f"{_DRAFT}{secrets.token_hex(6)}{_DRAFT_SUFFIX}")
    try:
        _check_replaceable(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        with partial(draft):
            with create(draft) as file:
                yield file
            draft.replace(path)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {reason(path, error)}") from error


def _check_name(path: Path) -> None:
    check_name(path, "cannot be written: ")
    if not path.name:  # "", "." or "/"
        raise ConfigError(f"{path}: cannot be written: it is a folder")


def check_writable(path: Path) -> None:
    """Raise ConfigError where `replacing` could not write a file. Its folder is made and tried."""
    _check_name(path)
    try:
        _check_replaceable(path)
        try_folder(path.parent)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {reason(path, error)}") from error


def create(path: Path) -> BinaryIO:
    """Make a new file and open it for writing and reading. Raises OSError, also where anything is there."""
    return path.open("x+b")  # exclusively: it follows no link and truncates nothing


def _check_replaceable(path: Path) -> None:
    """Raise OSError for a folder, a device or a pipe in the place of a file, behind a link too."""
    with contextlib.suppress(FileNotFoundError, NotADirectoryError):
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not stat.S_ISREG(mode):
            raise OSError(errno.EINVAL, "it is a device or a pipe, not a file", str(path))


def try_folder(folder: Path) -> None:
    """Make a folder if needed, and try to write into it. Raises OSError with the reason."""
    folder.mkdir(parents=True, exist_ok=True)
    trial = folder / f"{_DRAFT}{secrets.token_hex(6)}{_DRAFT_SUFFIX}"
    with partial(trial), create(trial) as file:
        file.write(b"evcosim")


def remove_drafts(folder: Path) -> None:
    """Remove what a killed process was writing in a folder that no other process writes into."""
    for draft in folder.glob(f"{_DRAFT}*{_DRAFT_SUFFIX}"):
        with contextlib.suppress(OSError):
            draft.unlink()


def reason(path: Path, error: OSError) -> str:
    """Return why a file cannot be written; the system's own words for a file among its folders mislead."""
    if flaw := flaw_of_name(path):
        return flaw
    for folder in path.parents:
        if folder.exists() and not folder.is_dir():
            return f"{folder} is a file, not a folder"
    return shortage.reason(error)


def write_text(path: Path, text: str) -> None:
    """Write a text as UTF-8, with the line ends that it has. Raises ConfigError as `replacing` does."""
    with replacing(path) as file:
        file.write(text.encode())


def markdown_table(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a Markdown table; `|` and line ends in a cell are escaped, other marks are not."""
    escaped = [[cell.replace("|", "\\|").replace("\n", " ") for cell in cells] for cells in (headers, *rows)]
    head, *body = (f"| {' | '.join(cells)} |" for cells in escaped)
    return [head, "|---" * len(headers) + "|", *body]


def finite(data: Any) -> Any:
    """Return data as JSON has it: texts as keys, numbers of numpy as Python's, None for NaN and infinity."""
    if isinstance(data, Mapping):
        return {str(key): finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [finite(value) for value in data]
    if type(data).__module__ == "numpy":
        return finite(data.item())
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return str(data) if isinstance(data, os.PathLike) else data
