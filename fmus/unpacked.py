"""Built-in FMUs, of Python and native, unpacked once into the user's cache, with the bytecode of their files.

To unpack an FMU, to remove it and to compile what is in it takes longer than all else at the start of a
short run. The models that this package builds write nothing beside themselves, so that runs, at the same
time too, can have one folder.

A folder appears whole or not at all. Beside its files is a list of the state of each (`cache.state`), which
no write, no replacement, no other file and no other permission leaves as it was: then it is made anew.
Folders that were not used for long are removed when there are many.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import stat
import sys
import time
from pathlib import Path

from . import cache

_FILES, _LIST = "fmu", "list"
_MOST = 100
"""Folders that are kept in any case: a built-in FMU is half a megabyte."""
_UNUSED = 3600.0
"""Time [s] after which one more may be removed; who uses it has imported all, and its library is loaded."""
_MARK = ".unpacked"


def unpacked(archive: Path, binary: str) -> Path | None:
    """Return a folder with description, resources and the entry `binary` of a built-in FMU in the cache.

    None for any other FMU, and where it cannot be kept, so that it has to be unpacked elsewhere: in a system
    without owners of files, where nothing can be written, or where libraries cannot be loaded from.
    """
    if os.name != "posix" or sys.flags.optimize or archive.parent != cache.folder():
        return None
    folder = archive.with_name(f"{archive.stem}{_MARK}-{sys.implementation.cache_tag}")
    try:
        if not (_can_run(archive.parent) and cache.holds(archive)):
            return None
        if not _is_whole(folder):
            _make(folder, archive, binary)
    except OSError:
        return None
    with contextlib.suppress(OSError):  # a cache that is only read
        os.utime(folder)
    return folder / _FILES


def _can_run(folder: Path) -> bool:
    """Return True where libraries can be loaded, and pythonfmu's can name files: it reads %20 as a space."""
    name = os.fsencode(folder)
    with contextlib.suppress(UnicodeDecodeError):
        return not os.statvfs(folder).f_flag & os.ST_NOEXEC and "%20" not in name.decode()
    return False


def _is_whole(folder: Path) -> bool:
    """Return True if all that is in a folder is as it was made; drop it if it is not. Raises OSError."""
    if not folder.is_dir():
        return False
    cache.require_our_folder(folder)
    try:
        digest, _, listed = (folder / _LIST).read_bytes().partition(b"\n")
    except FileNotFoundError:
        digest = listed = b""
    if digest == hashlib.sha256(listed).hexdigest().encode() and listed == _states(folder / _FILES):
        return True
    _remove(folder)
    print(f"evcosim: {folder}: was changed; it is dropped and made anew", file=sys.stderr)
    return False


def _states(folder: Path) -> bytes:
    """Return the state of each file and folder from `folder` on, a line each. Raises OSError."""
    lines, waiting = [], [""]
    while waiting:
        name = waiting.pop()
        state = cache.state(path := f"{folder}{name}")
        lines.append(f"{name}: {state}")
        if stat.S_ISDIR(state[2]):
            waiting += [f"{name}/{each}" for each in sorted(os.listdir(path))]
    return "\n".join(lines).encode("utf-8", "surrogateescape")


def _make(folder: Path, archive: Path, binary: str) -> None:
    """Make the folder, unless another process has just made it. Raises OSError."""
    draft = cache.draft_folder(folder.name)
    try:
        _extract(archive, binary, draft / _FILES)
        listed = _states(draft / _FILES)
        (draft / _LIST).write_bytes(hashlib.sha256(listed).hexdigest().encode() + b"\n" + listed)
        with contextlib.suppress(FileExistsError):
            _rename(draft, folder)
    finally:
        cache.remove_draft(draft)
    _tidy(folder.parent)


def _rename(draft: Path, folder: Path) -> None:
    try:
        os.rename(draft, folder)
    except OSError as error:  # of a folder that is not empty, in two ways
        if folder.is_dir():
            raise FileExistsError from error
        raise


def _extract(archive: Path, binary: str, folder: Path) -> None:
    """Write what a run needs, with bytecode that Python takes without a look at the source."""
    import py_compile  # a run that finds its folders unpacks nothing
    import zipfile

    with zipfile.ZipFile(archive) as packed:
        for entry in packed.namelist():
            if entry in (binary, "modelDescription.xml") or entry.startswith("resources/"):
                path = folder / entry
                _make_folders(path.parent, folder.parent)
                path.write_bytes(packed.read(entry))
                path.chmod(0o644)
    for path in sorted(folder.rglob("*.py")):
        _make_folders(path.parent / "__pycache__", folder.parent)
        py_compile.compile(
            str(path), doraise=True, quiet=2, invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH
        )


def _make_folders(path: Path, top: Path) -> None:
    """Make a folder below `top` that nobody else may write, whatever the mode mask allows."""
    if path != top and not path.exists():
        _make_folders(path.parent, top)
        path.mkdir()
        path.chmod(0o755)


def _tidy(parent: Path) -> None:
    """Remove the folders that were not used for long, where there are many."""
    with contextlib.suppress(OSError):
        found = sorted((path.stat().st_mtime, path) for path in parent.glob(f"*{_MARK}-*"))
        for used, path in found[:-_MOST]:
            if time.time() - used > _UNUSED:
                _remove(path)


def _remove(folder: Path) -> None:
    """Remove a folder; nobody finds it half there."""
    away = cache.draft_folder(folder.name)
    try:
        with contextlib.suppress(FileNotFoundError):  # another process removes it
            os.rename(folder, away / "old")
    finally:
        cache.remove_draft(away)
