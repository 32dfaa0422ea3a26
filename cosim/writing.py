"""Writing result files so that the name they end under never stands for half a file, and tables in pages."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

from .errors import ConfigError


@contextlib.contextmanager
def in_place_of(path: Path) -> Iterator[Path]:
    """Give the name of a file to write, which takes the place of `path` at the end of the `with` block.

    Where the block raises, the file is removed and `path` is as it was. The folder is made if needed. Raises
    ConfigError naming the path and the reason when the folder or the disk refuses, within the block too.
    """
    if not path.name:  # "", "." or "/"
        raise ConfigError(f"{path}: cannot be written: it is a folder")
    # beside it: a rename must not cross disks
    partial = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            yield partial
            partial.replace(path)
        finally:
            with contextlib.suppress(OSError):  # renamed, or a first error is on its way
                partial.unlink()
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {reason(path, error)}") from error


def reason(path: Path, error: OSError) -> str:
    """Return why a file cannot be written; the system's own words for a file among its folders mislead."""
    for folder in path.parents:
        if folder.exists() and not folder.is_dir():
            return f"{folder} is a file, not a folder"
    return error.strerror or str(error)


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Give a binary file, open for writing, which takes the place of `path` as `in_place_of` says."""
    with in_place_of(path) as partial, partial.open("wb") as file:
        yield file


def write_text(path: Path, text: str) -> None:
    """Write a text as UTF-8, with the line ends that it has. Raises ConfigError as `in_place_of` does."""
    with replacing(path) as file:
        file.write(text.encode())


def markdown_table(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a Markdown table; `|` and line ends in a cell are escaped, other marks are not."""
    escaped = [[cell.replace("|", "\\|").replace("\n", " ") for cell in cells] for cells in (headers, *rows)]
    head, *body = (f"| {' | '.join(cells)} |" for cells in escaped)
    return [head, "|---" * len(headers) + "|", *body]
