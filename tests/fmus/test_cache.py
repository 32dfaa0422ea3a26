"""The cache gives back what was kept and nothing else, and heals; what cannot be used is replaced."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from evcosim.fmus import cache

CONTENT = b"what was made\n" * 100

needs_owners = pytest.mark.skipif(os.name != "posix", reason="files have owners and modes in POSIX systems")


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    folder = tmp_path / "cache"
    monkeypatch.setenv("EVCOSIM_CACHE", str(folder))
    return folder


class Maker:
    """Makes the content and counts how often it was asked to."""

    def __init__(self):
        self.made = 0

    def __call__(self):
        self.made += 1
        return CONTENT


def flipped(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def a_folder(path):
    path.unlink()
    path.mkdir()
    (path / "inside").write_text("")


def a_link(path):
    shutil.move(path, path.with_name("elsewhere"))
    path.symlink_to("elsewhere")


def a_pipe(path):
    path.unlink()
    os.mkfifo(path)


def writable(path):
    path.chmod(0o666)


DAMAGES = [
    lambda path: path.write_bytes(b""),
    lambda path: path.write_bytes(path.read_bytes()[:50]),
    lambda path: path.write_bytes(path.read_bytes() + b"\0"),
    flipped,
    a_folder,
    pytest.param(a_link, marks=needs_owners),
    pytest.param(a_pipe, marks=needs_owners),
    pytest.param(writable, marks=needs_owners),
]
NAMES = ["empty", "truncated", "longer", "flipped", "a folder", "a link", "a pipe", "writable by others"]


@pytest.mark.parametrize("record", [False, True], ids=["file", "record"])
@pytest.mark.parametrize("damage", DAMAGES, ids=NAMES)
def test_a_damaged_file_is_told_and_made_anew(own_cache, capsys, damage, record):
    make = Maker()
    path = cache.fetch("A.fmu", make)
    damage(own_cache / "A.fmu.sha256" if record else path)
    assert cache.fetch("A.fmu", make) == path
    assert path.read_bytes() == CONTENT
    said = capsys.readouterr().err
    assert (make.made, said.count("\n")) == (2, 1)
    assert said.startswith(f"evcosim: {own_cache / 'A.fmu'}") and "is dropped and made anew" in said
    assert cache.fetch("A.fmu", make).read_bytes() == CONTENT
    assert (make.made, capsys.readouterr().err) == (2, "")


@pytest.mark.parametrize("damage", DAMAGES, ids=NAMES)
def test_a_damaged_entry_is_told_and_kept_anew(own_cache, capsys, damage):
    assert cache.keep("entry", CONTENT) == ""
    assert cache.load("entry") == CONTENT
    damage(own_cache / "entry")
    assert cache.load("entry") is None
    assert capsys.readouterr().err.count("is dropped and made anew") == 1
    assert cache.keep("entry", CONTENT) == ""
    assert cache.load("entry") == CONTENT


def test_a_file_without_its_record_is_made_anew_without_a_word(own_cache, capsys):
    make = Maker()
    cache.fetch("A.fmu", make)
    (own_cache / "A.fmu.sha256").unlink()  # as between the two writes of another process
    cache.fetch("A.fmu", make)
    assert (make.made, capsys.readouterr().err) == (2, "")


def test_another_entry_under_the_name_is_not_taken(own_cache):
    """Neither is a file that was kept under another name, with its record."""
    cache.fetch("A.fmu", lambda: b"another")
    make = Maker()
    path = cache.fetch("B.fmu", make)
    for suffix in ("", ".sha256"):
        shutil.copy(own_cache / f"A.fmu{suffix}", own_cache / f"B.fmu{suffix}")
    assert cache.fetch("B.fmu", make).read_bytes() == CONTENT
    assert (path.name, make.made) == ("B.fmu", 2)


def test_anew_replaces_what_was_kept(own_cache):
    path = cache.fetch("A.fmu", lambda: b"before")
    assert cache.fetch("A.fmu", Maker(), anew=True) == path
    assert path.read_bytes() == CONTENT


def taken_by_a_file(folder, monkeypatch):
    folder.write_text("")


def writable_by_others(folder, monkeypatch):
    folder.mkdir()
    folder.chmod(0o777)


def of_another_user(folder, monkeypatch):
    folder.mkdir()
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    monkeypatch.setattr(cache, "_distrust", _distrust_root)


def _distrust_root(about, before=cache._distrust):
    """Judge as if the files of these tests, which root may run, were a user's."""
    return before(os.stat_result([*about[:4], about.st_uid or 4711, *about[5:]]))


def full(folder, monkeypatch):
    before = cache.write

    def write(path, content, mode=0o666):
        if path.parent == folder:
            raise OSError(28, "No space left on device")
        return before(path, content, mode)

    monkeypatch.setattr(cache, "write", write)


@needs_owners
@pytest.mark.parametrize(
    ("unusable", "reason"),
    [
        (taken_by_a_file, "it is a file, not a folder"),
        (writable_by_others, "others can write it (mode 777; chmod go-w ends that)"),
        (of_another_user, "it belongs to another user"),
        (full, "No space left on device"),
    ],
)
def test_a_cache_that_cannot_be_used_is_replaced(own_cache, monkeypatch, capsys, unusable, reason):
    unusable(own_cache, monkeypatch)
    make = Maker()
    path = cache.fetch("A.fmu", make)
    assert cache.fetch("A.fmu", make) == path
    assert own_cache not in path.parents and path.read_bytes() == CONTENT
    said = capsys.readouterr().err
    assert (make.made, said.count("\n")) == (1, 1)
    assert said.startswith(f"evcosim: cannot use the cache folder {own_cache} (") and reason in said
    assert cache.load("entry") is None
    assert reason in cache.keep("entry", CONTENT)


@needs_owners
def test_what_stands_in_a_folder_of_others_is_not_read(own_cache, monkeypatch):
    path = cache.fetch("A.fmu", lambda: b"somebody else's")
    cache.keep("entry", b"somebody else's")
    own_cache.chmod(0o775)
    assert cache.fetch("A.fmu", Maker()).read_bytes() == CONTENT
    assert cache.load("entry") is None
    own_cache.chmod(0o755)
    assert cache.fetch("A.fmu", Maker()) == path


@needs_owners
@pytest.mark.parametrize("mask", [0o000, 0o002, 0o077])
def test_what_is_kept_is_trusted_whatever_the_mode_mask(own_cache, monkeypatch, mask):
    monkeypatch.setattr(cache, "_umask", lambda: mask)
    before = os.umask(mask)
    try:
        make = Maker()
        assert cache.fetch("A.fmu", make) == cache.fetch("A.fmu", make) == own_cache / "A.fmu"
    finally:
        os.umask(before)
    assert make.made == 1


def test_a_user_without_a_home_has_a_cache(monkeypatch, tmp_path):
    def no_home():
        raise RuntimeError("Could not determine home directory.")

    for variable in ("EVCOSIM_CACHE", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(Path, "home", no_home)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    make = Maker()
    assert tmp_path in cache.fetch("A.fmu", make).parents
    assert cache.fetch("A.fmu", make).read_bytes() == CONTENT
    assert make.made == 1


def test_processes_that_damage_and_keep_at_once_read_what_was_made(own_cache):
    """Each keeps bytes of its own, as compilers do: what is read is always the whole of one of them."""
    script = """
import os, sys
from evcosim.fmus import cache
mine = bytes([65 + int(sys.argv[1])]) * 50_000
for i in range(60):
    assert cache.fetch("A.fmu", lambda: b"the same" * 9999).read_bytes() == b"the same" * 9999
    assert cache.keep("entry", mine) == ""
    read = cache.load("entry")
    assert len(read) == 50_000 and len(set(read)) == 1, len(read)
"""
    running = [
        subprocess.Popen([sys.executable, "-c", script, str(i)], stderr=subprocess.PIPE) for i in range(4)
    ]
    said = [process.communicate(timeout=120)[1] for process in running]
    assert [process.returncode for process in running] == [0] * 4, said
    assert said == [b""] * 4


def test_a_file_that_was_compared_is_not_read_again_until_it_is_written(monkeypatch):
    """Within a process, and not in the tick of the file system's clock in which it was written."""
    make = Maker()
    path = cache.fetch("thing", make)
    assert cache.settled(path) is None
    monkeypatch.setattr(cache, "_JUST_NOW", -1)
    read, original = [], cache._read
    monkeypatch.setattr(cache, "_read", lambda path: read.append(path) or original(path))
    for _ in range(3):
        assert cache.fetch("thing", make) == path
    assert (len(read), make.made) == (2, 1)
    flipped(path)
    assert cache.fetch("thing", make).read_bytes() == CONTENT
    assert make.made == 2
    os.utime(path, (0, 0))
    assert cache.fetch("thing", make) == path and make.made == 2


@needs_owners
def test_a_folder_that_others_may_write_is_not_trusted_again(own_cache, monkeypatch, capsys):
    monkeypatch.setattr(cache, "_JUST_NOW", -1)
    monkeypatch.setattr(cache, "_replaced", {})
    path = cache.fetch("thing", Maker())
    assert cache.fetch("thing", Maker()) == path
    own_cache.chmod(0o777)
    assert cache.fetch("thing", Maker()) != path
    assert "others can write it" in capsys.readouterr().err


def test_within_a_block_a_look_is_taken_once_unless_it_found_nothing(own_cache):
    looks, answers = [], ["", "held", "other"]

    def look():
        looks.append(1)
        return answers[len(looks) - 1]

    with cache.looking_once():
        assert cache.once("a", look) == ""
        with cache.looking_once():  # the same block
            assert cache.once("a", look) == "held"
        assert cache.once("a", look) == "held"
        assert cache.once("b", look) == "other"
    assert len(looks) == 3
    assert cache.once("b", lambda: "outside") == "outside"


def test_after_a_block_a_damaged_file_is_seen(own_cache, capsys):
    with cache.looking_once():
        path = cache.fetch("a.fmu", lambda: b"content")
        assert cache.fetch("a.fmu", lambda: b"content") == path
    path.write_bytes(b"damaged")
    with cache.looking_once():
        assert cache.fetch("a.fmu", lambda: b"content").read_bytes() == b"content"
    assert "is damaged" in capsys.readouterr().err


def test_the_digest_of_a_file_is_that_of_its_record(own_cache, tmp_path, monkeypatch):
    digest = hashlib.sha256(b"content").hexdigest()
    path = cache.fetch("a.fmu", lambda: b"content")
    assert cache.digest_of(path) == digest
    (other := tmp_path / "a.fmu").write_bytes(b"content")  # without a record
    assert cache.digest_of(other) == digest
    path.with_name("a.fmu.sha256").write_text(f"{'0' * 64}  b.fmu\n")  # of another file
    assert cache.digest_of(path) == digest
