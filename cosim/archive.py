"""Opening and extracting archives that strangers made, FMUs and packages of SSP: damaged or hostile ones too.

Checked before anything is written: no entry stands outside the archive's folder, none is a link, a device or
encrypted, no two are the same file, and sizes, their ratio and their number are within limits. While files
are written, bytes are counted again, since an archive can lie about sizes. No honest one meets the limits;
EVCOSIM_FMU_LIMITS ("size=8e9 ratio=1000 entries=50000", sizes in bytes) sets others.
"""

from __future__ import annotations

import dataclasses
import os
import re
import stat
import unicodedata
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from . import leftovers
from .errors import ConfigError, ShortageError
from .shortage import is_shortage, of_temporary_files, reason

_VARIABLE = "EVCOSIM_FMU_LIMITS"
_BLOCK = 1 << 20
_RATIO_FROM = 1 << 20  # bytes: a small file of equal characters packs as well as a bomb
_DESCRIPTION = 64 << 20  # bytes of modelDescription.xml
_LONGEST_NAME, _LONGEST_PATH = 255, 2000  # bytes; systems take 4096 with the folder that it is extracted to
_LONGEST_SHOWN = 60
_WINDOWS = os.name == "nt"
_NOT_IN_WINDOWS = re.compile(
    r'[\x00-\x1f<>:"|?*]|[. ]$|^(con|prn|aux|nul|com\d|lpt\d)(\..*)?$', re.IGNORECASE
)


@dataclasses.dataclass(frozen=True)
class ArchiveKind:
    """The name of an archive in messages, "FMU" with its article "an", and the error that is raised of it.

    `unzipped` says how a folder in its place becomes one.
    """

    name: str
    article: str
    error: type[ConfigError]
    unzipped: str

    def __str__(self) -> str:
        return f"{self.article} {self.name}"


@dataclasses.dataclass(frozen=True)
class ArchiveLimits:
    """The limits of an archive: `size` bytes in all, `ratio` of unpacked to packed bytes, `entries`."""

    size: float = 4e9
    ratio: float = 500.0
    entries: float = 20_000


def archive_limits() -> ArchiveLimits:
    """Return the limits, those of the environment among them. Raises ConfigError for any other text there."""
    given = {}
    for part in os.environ.get(_VARIABLE, "").split():
        name, _, value = part.partition("=")
        try:
            number = float(value)
        except ValueError:
            number = -1.0
        if name not in ("size", "ratio", "entries") or not number > 0.0:
            raise ConfigError(
                f"{_VARIABLE}: '{part}' is not size=N, ratio=N or entries=N with a number above 0"
            )
        given[name] = number
    return ArchiveLimits(**given)


def entries_of(path: Path, kind: ArchiveKind) -> tuple[zipfile.ZipInfo, ...]:
    """Return the entries of an archive. Raises the kind's error for one that is damaged or breaks a rule."""
    if path.is_dir():
        raise kind.error(f"{path}: is a folder, not {kind}; {kind.unzipped}")
    if path.exists() and not path.is_file():
        raise kind.error(f"{path}: is no file, but a pipe or a device")
    try:
        with zipfile.ZipFile(path) as archive:
            found = tuple(archive.infolist())
    except FileNotFoundError as error:
        raise kind.error(f"{path}: there is no such file") from error
    except OSError as error:
        raise kind.error(f"{path}: cannot be read: {reason(error)}") from error
    except Exception as error:  # zipfile raises four unrelated types for damaged archives
        raise kind.error(f"{path}: is not {kind}: {_reason(path, error)}") from error
    for entry in found:  # some tools for Windows separate folders as no archive should
        entry.filename = entry.filename.replace("\\", "/")
    found = _once(path, found)
    _check(path, found, archive_limits(), kind)
    return found


def _once(path: Path, entries: tuple[zipfile.ZipInfo, ...]) -> tuple[zipfile.ZipInfo, ...]:
    """Leave out an entry that was written twice under one name with one content, as some build tools do."""
    kept: dict[str, zipfile.ZipInfo] = {}
    found = []
    for entry in entries:
        first = kept.setdefault(entry.orig_filename, entry)
        if first is entry or entry.is_dir() or not _equal(path, first, entry):
            found.append(entry)
    return tuple(found)


def _equal(path: Path, a: zipfile.ZipInfo, b: zipfile.ZipInfo) -> bool:
    """Return True if both entries have the same bytes, which are compared, not their checksums alone."""
    if (a.CRC, a.file_size) != (b.CRC, b.file_size) or a.file_size > _DESCRIPTION:
        return False
    try:
        with zipfile.ZipFile(path) as archive, archive.open(a) as one, archive.open(b) as other:
            while block := one.read(_BLOCK):
                if block != other.read(_BLOCK):
                    return False
            return not other.read(1)
    except Exception:  # zipfile raises unrelated types for damaged entries, which are not equal then
        return False


def _reason(path: Path, error: Exception) -> str:
    if path.stat().st_size == 0:
        return "the file is empty"
    return "it is no zip archive, or a truncated one" if isinstance(error, zipfile.BadZipFile) else str(error)


def _check(
    path: Path, entries: tuple[zipfile.ZipInfo, ...], allowed: ArchiveLimits, kind: ArchiveKind
) -> None:
    if len(entries) > allowed.entries:
        raise kind.error(
            f"{path}: the archive has {len(entries)} entries, more than {allowed.entries:g} ({_VARIABLE})"
        )
    total = sum(entry.file_size for entry in entries)
    if total > allowed.size:
        raise kind.error(
            f"{path}: unpacked it has {total:.3g} bytes, more than {allowed.size:.3g} ({_VARIABLE})"
        )
    seen: dict[str, str] = {}
    files = {_folded(entry) for entry in entries if not entry.is_dir()}
    for entry in entries:
        if problem := _problem(entry, allowed, kind):
            raise kind.error(f"{path}: entry {_shown(entry.filename)} {problem}")
        folded = _folded(entry)
        if folded in seen and not entry.is_dir():
            raise kind.error(f"{path}: entries {seen[folded]} and {_shown(entry.filename)} are the same file")
        seen[folded] = _shown(entry.filename)
        if file := next((p for p in _folders(folded) if p in files), None):
            raise kind.error(f"{path}: entry {_shown(entry.filename)} stands in {file!r}, which is a file")


def _folded(entry: zipfile.ZipInfo) -> str:
    """Return an entry's name as a file system that ignores case sees it."""
    return unicodedata.normalize("NFC", entry.filename.rstrip("/")).casefold()


def _folders(name: str) -> Iterator[str]:
    return (name[: found.start()] for found in re.finditer("/", name))


def _shown(name: str) -> str:
    """Return a name for a message, shortened."""
    return repr(name if len(name) <= _LONGEST_SHOWN else name[:_LONGEST_SHOWN] + "...")


def _problem(entry: zipfile.ZipInfo, allowed: ArchiveLimits, kind: ArchiveKind) -> str:
    """Return the rule that an entry breaks, as a clause; "" when it breaks none."""
    name = entry.orig_filename  # zipfile cuts `filename` at a NUL and turns separators
    parts = re.split(r"[/\\]", name)
    if not name or "\0" in name or name[0] in "/\\" or ".." in parts or re.match(r"[A-Za-z]:", name):
        return f"would be written outside the {kind.name}'s folder"
    if len(name.encode()) > _LONGEST_PATH or max(len(part.encode()) for part in parts) > _LONGEST_NAME:
        return "has a name that is too long for a file system"
    if _WINDOWS and any(_NOT_IN_WINDOWS.search(part) for part in parts):
        return "has a name that no file can have in Windows"
    mode = entry.external_attr >> 16
    if mode and stat.S_IFMT(mode) not in (0, stat.S_IFREG, stat.S_IFDIR):
        return "is a link or a device, not a file"
    if entry.flag_bits & 1:
        return "is encrypted"
    if entry.file_size > _RATIO_FROM and entry.file_size > allowed.ratio * max(1, entry.compress_size):
        return (
            f"unpacks to {entry.file_size / max(1, entry.compress_size):.0f} times its size, more than "
            f"{allowed.ratio:g} ({_VARIABLE})"
        )
    return ""


def read_entry(path: Path, name: str, kind: ArchiveKind) -> bytes:
    """Return the bytes of an entry of at most 64 MiB by its name in `entries_of`. Raises the kind's error."""
    try:
        with zipfile.ZipFile(path) as archive, archive.open(_named(archive, name)) as file:
            content = file.read(_DESCRIPTION + 1)
    except Exception as error:  # a wrong checksum, a compression that is not known, ...
        raise kind.error(f"{path}: entry {name!r} cannot be read: {error}") from error
    if len(content) > _DESCRIPTION:
        raise kind.error(f"{path}: entry {name!r} has more than {_DESCRIPTION >> 20} MiB")
    return content


def _named(archive: zipfile.ZipFile, name: str) -> zipfile.ZipInfo:
    """Return the entry of a name whose folders the archive may separate otherwise. Raises KeyError."""
    found = (entry for entry in archive.infolist() if entry.filename.replace("\\", "/") == name)
    return next(found, None) or archive.getinfo(name)


def extract(path: Path, kind: ArchiveKind) -> Path:
    """Extract an archive into a new temporary folder, which the caller removes.

    Raises the kind's error naming the entry, ShortageError where the disk is full or a limit reached; then
    no folder is left.
    """
    entries = entries_of(path, kind)
    try:
        folder = leftovers.temporary_folder()
    except OSError as error:
        raise ShortageError(f"{path}: cannot be extracted: {of_temporary_files(error)}") from error
    left, place = archive_limits().size, ""
    try:
        with zipfile.ZipFile(path) as archive:
            for entry in entries:
                place = f"entry {_shown(entry.filename)} "
                target = folder / entry.filename
                if entry.is_dir():
                    target.mkdir(parents=True, exist_ok=True)
                    continue
                target.parent.mkdir(parents=True, exist_ok=True)
                with archive.open(entry) as source, target.open("wb") as copy:
                    left -= _copied(entry, source, copy, left)
    except BaseException as error:
        leftovers.remove_folder(folder)
        if not isinstance(error, Exception):
            raise
        if isinstance(error, _LargerError):
            raise kind.error(f"{path}: {place}is larger than it declares") from error
        if is_shortage(error):
            said = of_temporary_files(error)
            raise ShortageError(f"{path}: {place}cannot be extracted: {said}") from error
        reason = getattr(error, "strerror", None) or error
        raise kind.error(f"{path}: {place}cannot be extracted: {reason}") from error
    return folder


class _LargerError(Exception):
    """An entry has more bytes than it declares, or than may be left."""


def _copied(entry: zipfile.ZipInfo, source: IO[bytes], target: IO[bytes], left: float) -> int:
    """Copy an entry and return its bytes. Raises _LargerError for more than it declares or `left`."""
    count = 0
    while block := source.read(_BLOCK):
        count += len(block)
        if count > entry.file_size or count > left:
            raise _LargerError
        target.write(block)
    return count
