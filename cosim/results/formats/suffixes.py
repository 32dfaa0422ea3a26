"""The formats that results are written in and read from, by the suffix of a file's name.

A further format is a module beside this one and a line in FORMATS.
"""

from __future__ import annotations

from pathlib import Path

from ...errors import ConfigError
from . import csv
from .format import Format

CSV = Format(csv.write, csv.read)

FORMATS = {
    ".csv": CSV,
}
_TEXT = (".txt", ".tsv", ".dat", "")


def format_of(path: Path) -> Format:
    """Return the format that a file's suffix names. Raises ConfigError for another suffix, naming all."""
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        wrong = f"not as '{suffix}'" if suffix else f"and the name '{path.name}' has no suffix"
        raise ConfigError(f"{path}: results are written as {', '.join(FORMATS)}, {wrong}")
    return FORMATS[suffix]


def reader_of(path: Path) -> Format:
    """Return the format that a file is read as; a suffix of plain text, or none, is CSV.

    Raises ConfigError for another suffix of a file that is there, naming all.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS and suffix not in _TEXT and path.exists():
        known = ", ".join([*FORMATS, *filter(None, _TEXT)])
        raise ConfigError(f"{path}: results are read from {known}, not from '{suffix}'")
    return FORMATS.get(suffix, CSV)
