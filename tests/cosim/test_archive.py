"""Archives that are damaged or hostile are refused before anything is written, each with its reason."""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
import zipfile
from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.fmi.archive import FmuError, entries_of, extract, read_entry


def archive(path: Path, **entries: bytes) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in entries.items():
            file.writestr(name, content)
    return path


@pytest.mark.parametrize("name", ["../evil", "/etc/evil", "a/../../evil", "..\\evil", "C:\\evil"])
def test_no_entry_stands_outside(tmp_path: Path, name: str) -> None:
    path = archive(tmp_path / "a.fmu", **{name: b"x"})
    with pytest.raises(FmuError, match=r"a.fmu: entry .* would be written outside the FMU's folder"):
        extract(path)


def test_a_name_with_a_nul_is_refused(tmp_path: Path) -> None:
    path = archive(tmp_path / "a.fmu", aXb=b"x")
    path.write_bytes(path.read_bytes().replace(b"aXb", b"a\0b"))
    with pytest.raises(FmuError, match="outside"):
        entries_of(path)


def test_no_links(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.fmu", "w") as file:
        link = zipfile.ZipInfo("binaries")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        file.writestr(link, "/etc")
    with pytest.raises(FmuError, match="'binaries' is a link or a device"):
        extract(tmp_path / "a.fmu")


def test_bombs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = archive(tmp_path / "a.fmu", zeros=bytes(30_000_000))
    with pytest.raises(FmuError, match=r"'zeros' unpacks to \d+ times its size, more than 500"):
        extract(path)
    monkeypatch.setenv("EVCOSIM_FMU_LIMITS", "ratio=1e9 size=2e7")
    with pytest.raises(FmuError, match=r"unpacked it has 3e\+07 bytes, more than 2e\+07 .EVCOSIM_FMU_LIMITS"):
        extract(path)
    monkeypatch.setenv("EVCOSIM_FMU_LIMITS", "ratio=1e9")
    folder = extract(path)
    assert (folder / "zeros").stat().st_size == 30_000_000
    (folder / "zeros").unlink()
    folder.rmdir()


def test_too_many_entries_and_wrong_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = archive(tmp_path / "a.fmu", **{f"f{i}": b"" for i in range(11)})
    monkeypatch.setenv("EVCOSIM_FMU_LIMITS", "entries=10")
    with pytest.raises(FmuError, match="has 11 entries, more than 10"):
        entries_of(path)
    for text in ("entries=-1", "depth=3", "size", "size=nan"):
        monkeypatch.setenv("EVCOSIM_FMU_LIMITS", text)
        with pytest.raises(ConfigError, match=f"EVCOSIM_FMU_LIMITS: '{text}' is not"):
            entries_of(path)


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_two_entries_that_are_one_file(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.fmu", "w") as file:
        file.writestr("modelDescription.xml", "a")
        file.writestr("modeldescription.XML", "b")
    with pytest.raises(
        FmuError, match=r"'modelDescription.xml' and 'modeldescription.XML' are the same file"
    ):
        entries_of(tmp_path / "a.fmu")


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize(("content", "once"), [(b"a" * 100, True), (b"b" * 100, False), (b"a", False)])
def test_an_entry_that_was_written_twice(tmp_path: Path, content: bytes, once: bool) -> None:
    path = tmp_path / "a.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for text in (b"a" * 100, content):
            file.writestr("extra/manifest.xml", text)
    if not once:
        with pytest.raises(FmuError, match="are the same file"):
            entries_of(path)
        return
    assert [entry.filename for entry in entries_of(path)] == ["extra/manifest.xml"]
    folder = extract(path)
    assert (folder / "extra/manifest.xml").read_bytes() == content
    shutil.rmtree(folder)


def test_what_is_no_archive(tmp_path: Path) -> None:
    (tmp_path / "empty.fmu").write_bytes(b"")
    (tmp_path / "text.fmu").write_text("hello")
    whole = archive(tmp_path / "whole.fmu", a=bytes(range(256)) * 100).read_bytes()
    (tmp_path / "cut.fmu").write_bytes(whole[:-30])
    for name, reason in [
        ("empty", "the file is empty"),
        ("text", "it is no zip"),
        ("cut", "truncated"),
        ("none", "there is no such"),
    ]:
        with pytest.raises(FmuError, match=rf"{name}.fmu: .*{reason}"):
            entries_of(tmp_path / f"{name}.fmu")
    with pytest.raises(FmuError, match="is a folder, not an FMU"):
        entries_of(tmp_path)


def test_a_damaged_entry_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.fmu"
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("first", b"x" * 100)
        file.writestr("second", b"content of the second")
    path.write_bytes(path.read_bytes().replace(b"content of", b"c0ntent of"))
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    with pytest.raises(
        FmuError, match=r"a.fmu: entry .second. cannot be extracted: Bad CRC-32 for file 'second'"
    ):
        extract(path)
    assert list(folder.iterdir()) == []
    with pytest.raises(FmuError, match="entry 'second' cannot be read: Bad CRC-32"):
        read_entry(path, "second")


@pytest.mark.skipif(os.name != "posix", reason="a pipe in the file system is a thing of POSIX systems")
def test_a_device_or_a_pipe_is_no_fmu(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.fmu")
    for path in (tmp_path / "pipe.fmu", Path("/dev/zero")):
        with pytest.raises(FmuError, match=f"{path}: is no file, but a pipe or a device"):
            entries_of(path)


def test_folders_of_an_archive_that_separates_them_otherwise(tmp_path: Path) -> None:
    path = archive(tmp_path / "a.fmu", **{"resources/table/one.txt": b"1"})
    path.write_bytes(path.read_bytes().replace(b"resources/table/one", b"resources\\table\\one"))
    folder = extract(path)
    assert (folder / "resources" / "table" / "one.txt").read_bytes() == b"1"
    assert read_entry(path, "resources/table/one.txt") == b"1"
    shutil.rmtree(folder)


@pytest.mark.parametrize("name", ["resources/NUL", "aux.txt", "resources/a:b", "resources/a./b", "what?"])
def test_names_that_windows_takes_for_something_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    path = archive(tmp_path / "a.fmu", **{name: b"x"})
    assert entries_of(path)
    monkeypatch.setattr("evcosim.cosim.archive._WINDOWS", True)
    with pytest.raises(FmuError, match="has a name that no file can have in Windows"):
        entries_of(path)
