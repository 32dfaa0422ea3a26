"""The words for what a process runs out of name the limit, its value and what sets it."""

from __future__ import annotations

import errno
import math
import os
import re
import resource
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from evcosim.cosim import shortage
from evcosim.cosim.errors import RunError, ShortageError
from support.forked import forked
from support.needs import need_linux


def limited(kind: int, most: int, call: Callable[[], Any]) -> Any:
    """The value of a call in a copy of this process with a limit."""

    def within() -> Any:
        resource.setrlimit(kind, (most, resource.getrlimit(kind)[1]))
        return call()

    found = forked(within)
    assert not found.crash, found.crash
    return found.value


@pytest.mark.parametrize(
    ("number", "kind", "most", "words"),
    [
        (errno.EMFILE, resource.RLIMIT_NOFILE, 50, r": the limit of open files is 50 \(`ulimit -n`\)$"),
        (errno.EAGAIN, resource.RLIMIT_NPROC, 40, r": .* processes and threads .* 40 \(`ulimit -u`\)$"),
        (errno.ENOMEM, resource.RLIMIT_AS, 4 << 30, r" is 4194304 KiB \(`ulimit -v`, .* memory_limit\)$"),
        (errno.EFBIG, resource.RLIMIT_FSIZE, 5 << 20, r" is 5120 KiB \(`ulimit -f`, .* file_limit\)$"),
    ],
)
def test_a_limit_is_named_with_its_value(number: int, kind: int, most: int, words: str) -> None:
    error = OSError(number, os.strerror(number))
    assert shortage.is_shortage(error)
    for said in (shortage.reason, shortage.of_temporary_files):
        text = limited(kind, most, lambda said=said: said(error))
        assert text.startswith(os.strerror(number))
        assert re.search(words, text), text


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (OSError(errno.EMFILE, "Too many open files"), "Too many open files"),
        (OSError(errno.ENOENT, "No such file or directory"), ""),
        (
            ImportError("libm.so: cannot open shared object file: Too many open files"),
            "Too many open files",
        ),
        (ImportError("libm.so: cannot open shared object file: Error 24"), "Too many open files"),
        (ImportError("libm.so: cannot open shared object file: No such file or directory"), ""),
        (ModuleNotFoundError("No module named 'fmpy'"), ""),
    ],
)
def test_a_limit_behind_a_module_that_cannot_be_loaded_is_named(error: Exception, said: str) -> None:
    text = limited(resource.RLIMIT_NOFILE, 50, lambda: shortage.reason_of_import(error))
    assert text == (f"{said}: the limit of open files is 50 (`ulimit -n`)" if said else "")


def test_a_full_disk_is_named_with_its_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", "/some/folder")
    full = OSError(errno.ENOSPC, "No space left on device")
    assert shortage.reason(full) == "No space left on device: make room on the disk"
    assert shortage.of_temporary_files(full) == (
        "/some/folder: No space left on device: make room there, or let TMPDIR name another folder"
    )
    locked = OSError(errno.EROFS, "Read-only file system")
    assert shortage.of_temporary_files(locked) == (
        "/some/folder: Read-only file system: let TMPDIR name a folder that can be written"
    )
    assert shortage.is_shortage(full) and not shortage.is_shortage(locked)


def test_where_there_is_no_folder_at_all_the_reason_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> str:
        raise FileNotFoundError(errno.ENOENT, "No usable temporary directory found in ['/a']")

    monkeypatch.setattr(tempfile, "gettempdir", none)
    with pytest.raises(FileNotFoundError) as caught:
        tempfile.gettempdir()
    assert shortage.of_temporary_files(caught.value) == (
        "No usable temporary directory found in ['/a']: let TMPDIR name a folder that can be written"
    )


def test_other_errors_keep_the_words_of_the_system() -> None:
    for error in (OSError(errno.EISDIR, "Is a directory"), OSError("text")):
        assert shortage.reason(error) == (error.strerror or "text")
        assert not shortage.is_shortage(error)
    assert not shortage.is_shortage(ValueError())


def test_memory_that_is_left() -> None:
    need_linux()

    def with_room(size: int) -> float:
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + size, resource.RLIM_INFINITY))
        return shortage.memory_left()

    for size in (100_000_000, 700_000_000):
        assert forked(lambda size=size: with_room(size)).value == pytest.approx(size, abs=5e6)
    if resource.getrlimit(resource.RLIMIT_AS)[0] == resource.RLIM_INFINITY:
        assert shortage.memory_left() == math.inf


def test_too_little_memory_is_refused_with_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    shortage.require_memory(1e6, "a run")
    monkeypatch.setattr(shortage, "memory_left", lambda: 50e6)
    monkeypatch.setattr(shortage, "_limit", lambda name: 300 * 1024.0)
    with pytest.raises(
        ShortageError, match=r"^a run needs 200 MB of memory, and 50 MB are left: the limit .* 300 KiB"
    ):
        shortage.require_memory(200e6, "a run")
    assert issubclass(ShortageError, RunError)
    shortage.require_memory(50e6, "a run")
    shortage.require_memory(200e6, "a run", "evcosim.cosim.shortage")  # what is loaded takes no more
    with pytest.raises(ShortageError, match=r"^a run needs"):
        shortage.require_memory(200e6, "a run", "not_loaded")
    monkeypatch.delitem(sys.modules, "scipy.linalg", raising=False)
    with pytest.raises(ShortageError, match=r"^scipy needs 150 MB"):
        shortage.require_scipy()
    assert shortage.no_memory().startswith("no memory is left: the limit of memory is 300 KiB")
    assert "300 (`ulimit -u`), or the limit of memory is 300 KiB" in shortage.no_thread().replace(
        "307200", "300"
    )
