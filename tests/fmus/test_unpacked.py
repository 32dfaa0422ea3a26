"""Built-in FMUs are unpacked once, into a folder that is made anew as soon as anything in it was changed."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from evcosim.fmus import cache
from evcosim.fmus import unpacked as unpacking
from evcosim.fmus.build import build, built
from evcosim.fmus.native.build import native_built
from evcosim.fmus.unpacked import unpacked
from support.needs import need_c_compiler

pytestmark = pytest.mark.skipif(os.name != "posix", reason="files have owners and modes in POSIX systems")

BINARY = "binaries/linux64/Battery.so"


@pytest.fixture
def battery(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The FMU in a cache of the test's own."""
    (there := built("Battery")).is_file()
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o700)
    for suffix in ("", ".sha256"):
        shutil.copyfile(f"{there}{suffix}", folder / f"{there.name}{suffix}")
    monkeypatch.setenv("EVCOSIM_CACHE", str(folder))
    return folder / there.name


def made(battery: Path) -> Path:
    folder = unpacked(battery, BINARY)
    assert folder is not None
    return folder


def model_of(folder: Path) -> Path:
    (file,) = folder.glob("resources/Battery_*/evcosim/models/battery.py")
    return file


def test_a_folder_has_what_a_run_needs_and_stays(battery: Path) -> None:
    folder = made(battery)
    names = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert {BINARY, "modelDescription.xml", "resources/slavemodule.txt"} <= names
    assert not any(name.startswith(("binaries/win64", "documentation")) for name in names)
    sources = {name for name in names if name.endswith(".py")}
    assert len(sources) > 15 and sum(name.endswith(".pyc") for name in names) == len(sources)
    before = model_of(folder).stat()
    assert made(battery) == folder
    assert model_of(folder).stat() == before


def test_python_takes_the_bytecode_and_not_the_source(battery: Path) -> None:
    folder = made(battery)
    slave = battery.stem + "_slave"
    code = f"import sys; sys.path.insert(0, {str(folder / 'resources')!r}); import {slave}"
    told = subprocess.run(
        [sys.executable, "-v", "-c", code], capture_output=True, text=True, check=True
    ).stderr
    own = [line for line in told.splitlines() if battery.stem in line]
    assert any("matches" in line for line in own)
    assert not any("code object from" in line and ".pyc" not in line for line in own)
    assert made(battery) == folder  # nothing was written on the way


def test_a_native_one_has_its_library_and_no_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    need_c_compiler()
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    native = native_built("Battery")
    folder = made(native)
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert files == {BINARY, "modelDescription.xml"}
    library = (folder / BINARY).read_bytes()
    written(folder / BINARY)
    assert made(native) == folder and (folder / BINARY).read_bytes() == library


def written(file: Path) -> None:
    file.write_bytes(file.read_bytes().replace(b"a", b"b"))


def written_as_before(file: Path) -> None:
    about = file.stat()
    written(file)
    os.utime(file, ns=(about.st_atime_ns, about.st_mtime_ns))


def replaced(file: Path) -> None:
    shutil.copy2(file, file.with_suffix(".new"))
    os.replace(file.with_suffix(".new"), file)


CHANGES: dict[str, Callable[[Path], object]] = {
    "written": written,
    "written, with its times": written_as_before,
    "replaced": replaced,
    "missing": Path.unlink,
    "cut": lambda file: os.truncate(file, 10),
    "one more": lambda file: file.with_name("numpy.py").write_text("raise SystemExit"),
    "others may write it": lambda file: file.chmod(0o666),
    "others may write its folder": lambda file: file.parent.chmod(0o777),
    "bytecode": lambda file: written(next((file.parent / "__pycache__").glob("battery*.pyc"))),
    "library": lambda file: written(file.parents[4] / BINARY),
    "list": lambda file: written(file.parents[5] / "list"),
    "no list": lambda file: (file.parents[5] / "list").unlink(),
    "a link": lambda file: (file.rename(file.with_name("b.py")), file.symlink_to("b.py")),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_was_changed_is_made_anew(
    change: str, battery: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = made(battery)
    content = model_of(folder).read_bytes()
    CHANGES[change](model_of(folder))
    assert made(battery) == folder
    assert capsys.readouterr().err == f"evcosim: {folder.parent}: was changed; it is dropped and made anew\n"
    assert model_of(folder).read_bytes() == content
    assert made(battery) == folder
    assert capsys.readouterr().err == ""
    assert not list(battery.parent.glob(".*"))


def test_a_folder_that_others_may_write_is_not_used(battery: Path) -> None:
    folder = made(battery)
    folder.parent.chmod(0o777)
    assert unpacked(battery, BINARY) is None


def test_other_fmus_have_none(battery: Path, tmp_path: Path) -> None:
    """A copy elsewhere, a file in the cache that no record notes, and one that was changed there."""
    assert unpacked(build("Battery", tmp_path), BINARY) is None
    other = battery.with_name("Other.fmu")
    shutil.copyfile(battery, other)
    assert unpacked(other, BINARY) is None
    made(battery)
    written(battery)
    assert unpacked(battery, BINARY) is None


def test_where_it_cannot_be_kept_there_is_none(battery: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(unpacking, "_extract", full)
    assert unpacked(battery, BINARY) is None
    assert not list(battery.parent.glob(".*")) and not list(battery.parent.glob("*.unpacked-*"))
    monkeypatch.setattr(unpacking, "_can_run", lambda folder: False)
    assert unpacked(battery, BINARY) is None


def test_a_place_that_pythonfmu_cannot_name_is_none(tmp_path: Path) -> None:
    for name, possible in (("a cache", True), ("a%20cache", False), (os.fsdecode(b"\xff"), False)):
        (tmp_path / name).mkdir()
        assert unpacking._can_run(tmp_path / name) is possible


def _unpack(battery: Path, folder: str) -> None:
    os.environ["EVCOSIM_CACHE"] = folder
    assert made(battery) == made(battery)


def test_processes_may_unpack_at_once(battery: Path) -> None:
    context = multiprocessing.get_context("fork")
    running = [context.Process(target=_unpack, args=(battery, str(battery.parent))) for _ in range(4)]
    for process in running:
        process.start()
    for process in running:
        process.join()
    assert [process.exitcode for process in running] == [0] * 4
    assert not list(battery.parent.glob(".*"))
    assert unpacking._is_whole(made(battery).parent)


def test_of_many_those_go_that_were_not_used_for_long(battery: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unpacking, "_MOST", 2)
    ages = {"used": 10.0, "new": 20.0, "late": 7000.0, "old": 8000.0}
    for name, age in ages.items():
        (folder := battery.with_name(f"{name}.unpacked-x")).mkdir()
        os.utime(folder, (time.time() - age,) * 2)
    folder = made(battery)
    assert {path.stem for path in battery.parent.glob("*.unpacked-*")} == {battery.stem, "used", "new"}
    assert folder.is_dir() and cache.folder() == battery.parent
