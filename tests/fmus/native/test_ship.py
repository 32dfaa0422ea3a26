"""Libraries that a wheel ships: compiled once for all, found by the C that they are of, and no other's."""

from __future__ import annotations

import json
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from evcosim.fmus import cache, records
from evcosim.fmus.native import build, package, ship, shipped, toolchain
from evcosim.fmus.native.build import content_of, difference, native_built, why_not
from evcosim.fmus.native.errors import ToolchainError
from evcosim.fmus.native.wanted import Wanted
from evcosim.fmus.recipes import catalog_recipe
from support import compiled_once
from support.needs import give_up, need_c_compiler, need_linux

NAMES = ("WheelSpeedEstimator", "BrakeActuator")


@pytest.fixture(scope="module")
def made() -> list[ship.Library]:
    """The libraries of two models."""
    need_linux()
    need_c_compiler()
    target = toolchain.here()
    return list(ship.libraries(NAMES, target, toolchain.compiler(target)))


@pytest.fixture
def folder(made: list[ship.Library], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder in which they are shipped, on a machine without a compiler, and with an empty cache."""
    ship.write(made, toolchain.here(), tmp_path / "shipped")
    monkeypatch.setattr(shipped, "FOLDER", tmp_path / "shipped")
    monkeypatch.setattr(toolchain, "has_zig", lambda: False)
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    yield tmp_path / "shipped"
    shipped._record.cache_clear()


def test_there_is_a_library_for_each_model_fmi_and_python(made: list[ship.Library]) -> None:
    about = [(each.name, each.fmi, each.minor) for each in made]
    assert sorted(about) == sorted(
        (name, fmi, minor) for name in NAMES for fmi in (2, 3) for minor in (11, 12, 13, 14)
    )
    assert len({each.key for each in made}) == len(made)


def test_a_shipped_library_is_the_one_that_a_compiler_makes_here(made: list[ship.Library]) -> None:
    recipe = catalog_recipe("BrakeActuator")
    parts = build.native_parts(recipe, build._model(recipe))
    for fmi in (2, 3):
        compiled, how = package.native_made(parts, fmi=fmi)
        assert how.startswith("compiled by ")
        assert any(each.content in compiled for each in made if each.fmi == fmi)


@pytest.mark.parametrize("name", NAMES)
def test_no_compiler_is_needed(folder: Path, name: str) -> None:
    path = native_built(name)
    assert records.library_of(cache.digest_of(path)) == "shipped with evcosim"
    assert why_not(name) == "" == difference(name)
    assert native_built(name, anew=True).read_bytes() == path.read_bytes()


def test_no_compiler_is_needed_for_fmi_3_and_for_another_python(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recipe = catalog_recipe("BrakeActuator")
    assert content_of(recipe, wanted=Wanted(fmi=3))
    found = set()
    for minor in (11, 14):
        monkeypatch.setattr("evcosim.fmus.native.emit.python_minor", lambda minor=minor: minor)
        monkeypatch.setattr(build, "python_minor", lambda minor=minor: minor)
        found.add(native_built("BrakeActuator").read_bytes())
    assert len(found) == 2


def test_other_sources_have_no_library(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A model, a translator or a runtime that was edited; a model that was not shipped."""
    with pytest.raises(ToolchainError, match="there is no C compiler here"):
        native_built("Battery")
    files = package.sources("int model;", 2)
    assert shipped.library(files, toolchain.here()) is None
    with monkeypatch.context() as edited:
        edited.setattr(build, "_digest", lambda model_digest: "0" * 32)
        assert "there is no C compiler here" in why_not("BrakeActuator")
    assert why_not("BrakeActuator") == ""


def test_other_platforms_have_none(folder: Path) -> None:
    with pytest.raises(ToolchainError, match="win64 are made by zig"):
        content_of(catalog_recipe("BrakeActuator"), wanted=Wanted(platforms=("win64",)))


def test_a_model_of_ones_own_has_none(folder: Path) -> None:
    """Also where it has the name of a built-in one."""
    recipe = catalog_recipe("BrakeActuator")
    with pytest.raises(ToolchainError, match="there is no C compiler here"):
        content_of(recipe, build._model(recipe))


@pytest.mark.parametrize("damage", [lambda content: content[:-1], lambda content: b"\0" + content[1:]])
def test_a_damaged_library_is_not_used(folder: Path, damage, capsys: pytest.CaptureFixture[str]) -> None:
    for file in folder.glob("BrakeActuator_*"):
        file.write_bytes(damage(file.read_bytes()))
    with pytest.raises(ToolchainError, match="there is no C compiler here"):
        native_built("BrakeActuator")
    said = capsys.readouterr().err
    assert "BrakeActuator_fmi2_py311.so: is damaged" in said and "it is not used" in said
    assert native_built("WheelSpeedEstimator")


@pytest.mark.parametrize("text", ["", "{", "[]", '{"linux64": 3}', '{"linux64": {"a": ["b"]}}'])
def test_a_damaged_record_is_no_record(folder: Path, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / shipped.RECORD).write_text(text)
    with pytest.raises(ToolchainError, match="there is no C compiler here"):
        native_built("BrakeActuator")
    assert "record.json: " in capsys.readouterr().err


def test_a_record_that_names_a_file_elsewhere_is_no_record(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (folder / shipped.RECORD).read_text().replace("BrakeActuator_", "../BrakeActuator_")
    (folder / shipped.RECORD).write_text(text)
    with pytest.raises(ToolchainError, match="there is no C compiler here"):
        native_built("BrakeActuator")
    assert "record.json: " in capsys.readouterr().err


def test_who_names_a_compiler_is_given_what_it_compiles(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(ToolchainError, match="there is no C compiler 'no-such-compiler' here"):
        native_built("BrakeActuator")


def test_the_same_libraries_are_the_same_files(made: list[ship.Library], tmp_path: Path) -> None:
    target = toolchain.here()
    compiled_once.forget()
    again = list(ship.libraries(NAMES[1:], target, toolchain.compiler(target)))
    assert again == [each for each in made if each.name == NAMES[1]]
    for order, place in ((made, tmp_path / "a"), (made[::-1], tmp_path / "b")):
        ship.write(sorted(order, key=lambda each: (each.name, each.fmi, each.minor)), target, place)
    files = [sorted((f.name, f.read_bytes()) for f in (tmp_path / k).iterdir()) for k in "ab"]
    assert files[0] == files[1]
    record = json.loads((tmp_path / "a" / shipped.RECORD).read_text())["linux64"]
    assert len(record) == len(made) and len({file for file, _ in record.values()}) < len(made)


# -- tags ----------------------------------------------------------------------------------------------------


def test_the_tag_is_that_of_the_newest_symbol(made: list[ship.Library]) -> None:
    contents = [each.content for each in made]
    found = re.fullmatch(r"manylinux_2_(\d+)_(\w+)", ship.platform_tag(contents))
    assert found and found[2] == platform.machine()
    asked = [ship.asked(content) for content in contents]
    newest = max(int(version.split(".")[1]) for _, versions in asked for version in versions)
    assert int(found[1]) == max(newest, 17)
    assert {"libc.so.6", "libm.so.6"} >= asked[0][0] >= {"libc.so.6"}


@pytest.mark.parametrize(
    ("old", "new", "tag"),
    [
        (b"GLIBC_2.2.5\0", b"GLIBC_2.987\0", "manylinux_2_987_x86_64"),
        (b"GLIBC_2.2.5\0", b"GLIBC_ABI_D\0", "linux_x86_64"),
        (b"GLIBC_2.2.5\0", b"OTHER_2.2.5\0", "linux_x86_64"),
        (b"libc.so.6\0", b"libx.so.6\0", "linux_x86_64"),
    ],
)
def test_what_is_not_everywhere_has_no_tag_of_everywhere(
    made: list[ship.Library], old: bytes, new: bytes, tag: str
) -> None:
    content = made[0].content
    assert ship.platform_tag([content], "x86_64").startswith("manylinux_2_")
    assert old in content
    assert ship.platform_tag([content, content.replace(old, new)], "x86_64") == tag


def test_objdump_reads_the_same(made: list[ship.Library], tmp_path: Path) -> None:
    if shutil.which("objdump") is None:
        give_up("there is no objdump (binutils) on this machine")
    (tmp_path / "library.so").write_bytes(made[0].content)
    call = ["objdump", "-p", str(tmp_path / "library.so")]
    said = subprocess.run(call, capture_output=True, text=True, check=True).stdout
    needed = set(re.findall(r"NEEDED +(\S+)", said))
    versions = set(re.findall(r"0x[0-9a-f]+ 0x[0-9a-f]+ \d+ (\S+)", said.partition("Version References")[2]))
    assert ship.asked(made[0].content) == (needed, versions)


def test_without_a_compiler_the_command_says_so(tmp_path: Path) -> None:
    """It is what setup.py calls."""
    done = subprocess.run(
        [sys.executable, "-m", "evcosim.fmus.native.ship", str(tmp_path / "shipped")],
        env={"PATH": str(tmp_path), "CC": "no-such-compiler"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1 and "there is no C compiler 'no-such-compiler' here" in done.stderr
    assert not (tmp_path / "shipped").exists()
