"""A library that this machine cannot load is refused from its header, with the reason."""

from __future__ import annotations

import struct
import sys
from pathlib import Path

import fmpy
import pytest

from evcosim.master.fmi import binary
from support.c_fmu import SOURCES, compiled

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only ELF is looked into")


@pytest.fixture(scope="module")
def whole() -> bytes:
    """A shared library of this machine."""
    return compiled(SOURCES / "mixed.c", ("-DFMI=2", "-DBEHAVIOR=0", "-DMODEL=mixed"))


def problem(folder: Path, content: bytes) -> str:
    path = folder / "library.so"
    path.write_bytes(content)
    return binary.problem(path)


def test_nothing_is_wrong_with_one_of_this_machine(tmp_path: Path, whole: bytes) -> None:
    assert problem(tmp_path, whole) == ""


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "it is empty"),
        (b"hello", "it is no library"),
        (b"MZ" + bytes(100), "it is a library for Windows"),
        (b"\xcf\xfa\xed\xfe" + bytes(100), "it is a library for macOS"),
        (
            b"version https://git-lfs.github.com/spec/v1\n",
            "it is a pointer of Git LFS, not the library itself",
        ),
        (b"\x7fELF\x02\x01", "it is cut off"),
        (b"\x7fELF\x01\x01" + bytes(100), "it is for 32 bits, this machine has 64"),
    ],
)
def test_what_is_no_library_of_this_machine(tmp_path: Path, content: bytes, reason: str) -> None:
    assert problem(tmp_path, content) == reason


def test_one_for_another_machine(tmp_path: Path, whole: bytes) -> None:
    other = 243  # RISC-V
    assert "it is for riscv64, this machine is " in problem(
        tmp_path, whole[:18] + struct.pack("<H", other) + whole[20:]
    )
    unknown = 7
    assert problem(tmp_path, whole[:18] + struct.pack("<H", unknown) + whole[20:]) == ""


def test_one_that_is_cut_off_anywhere_within_its_segments(tmp_path: Path, whole: bytes) -> None:
    """Behind them stand names for linkers, which nobody loads."""
    cuts = [length for length in range(0, len(whole), 997) if problem(tmp_path, whole[:length])]
    assert cuts and cuts == list(range(0, cuts[-1] + 1, 997))
    assert cuts[-1] > len(whole) / 3


def test_libraries_of_this_machine_are_where_fmpy_looks_for_them() -> None:
    assert binary.folder_of_libraries("1.0") == binary.folder_of_libraries("2.0") == fmpy.platform
    assert binary.folder_of_libraries("3.0") == fmpy.platform_tuple
    assert fmpy.sharedLibraryExtension == binary.SUFFIX


@pytest.mark.parametrize(
    ("system", "machine", "bits", "old", "new"),
    [
        ("win32", "AMD64", 64, "win64", "x86_64-windows"),
        ("win32", "AMD64", 32, "win32", "x86-windows"),
        ("darwin", "arm64", 64, "darwin64", "aarch64-darwin"),
        ("darwin", "x86_64", 64, "darwin64", "x86_64-darwin"),
        ("linux", "aarch64", 64, "linux64", "aarch64-linux"),
        ("linux", "i686", 32, "linux32", "x86-linux"),
    ],
)
def test_the_folders_of_other_machines(
    system: str, machine: str, bits: int, old: str, new: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(sys, "maxsize", 2 ** (bits - 1) - 1)
    monkeypatch.setattr("platform.machine", lambda: machine)
    assert (binary.folder_of_libraries("2.0"), binary.folder_of_libraries("3.0")) == (old, new)
