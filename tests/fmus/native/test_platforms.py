"""Native FMUs for other platforms: made by zig, checked by their headers, and run where there is a way to.

They need ziglang (pip install "evcosim[native]"), and wine to run the library for Windows. A job of CI has
both, and sets EVCOSIM_PLATFORMS, where they must not be missing. zig takes minutes for its first library for
Windows.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import struct
import subprocess
import sys
import zipfile
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

import pytest

from evcosim.fmus.interface import exposed
from evcosim.fmus.native import toolchain
from evcosim.fmus.native.build import native_parts
from evcosim.fmus.native.package import build_native, native_content, token_of
from evcosim.fmus.recipes import catalog_recipe
from support.needs import need_linux

HOST = Path(__file__).with_name("platform_host.c")
OTHERS = [name for name in toolchain.PLATFORMS if name != "linux64"]
STEPS, REFERENCES = "40", ("7", "11", "12", "16")  # of HandmadePlain: speed; total, direct, oldest


def _lacking(reason: str) -> NoReturn:
    (pytest.fail if os.environ.get("EVCOSIM_PLATFORMS") else pytest.skip)(reason)
    raise AssertionError(reason)


@pytest.fixture(scope="module", autouse=True)
def zig() -> None:
    """Give up where there is no zig."""
    need_linux()
    if importlib.util.find_spec("ziglang") is None:
        _lacking('ziglang is not installed: pip install "evcosim[native]"')


@pytest.fixture(scope="module")
def everywhere(parts: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An unpacked FMU with libraries for all platforms."""
    folder = tmp_path_factory.mktemp("everywhere")
    path = build_native(parts("HandmadePlain"), folder, platforms=tuple(toolchain.PLATFORMS))
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    return folder


def _elf(head: bytes) -> tuple[bytes, int]:
    return head[:6], struct.unpack_from("<H", head, 18)[0]


def _mach_o(head: bytes) -> tuple[bytes, int]:
    return head[:4], struct.unpack_from("<I", head, 4)[0]


def _pe(head: bytes) -> tuple[bytes, int]:
    place = struct.unpack_from("<I", head, 0x3C)[0]
    return head[place : place + 4], struct.unpack_from("<H", head, place + 4)[0]


@pytest.mark.parametrize(
    ("place", "read", "expected"),
    [
        ("win64/HandmadePlain.dll", _pe, (b"PE\0\0", 0x8664)),
        ("darwin64/HandmadePlain.dylib", _mach_o, (b"\xcf\xfa\xed\xfe", 0x01000007)),
        ("aarch64-darwin/HandmadePlain.dylib", _mach_o, (b"\xcf\xfa\xed\xfe", 0x0100000C)),
        ("aarch64-linux/HandmadePlain.so", _elf, (b"\x7fELF\x02\x01", 183)),
        ("linux64/HandmadePlain.so", _elf, (b"\x7fELF\x02\x01", 62)),
    ],
)
def test_each_is_for_its_platform_and_has_the_functions(
    place: str, read: Any, expected: tuple[bytes, int], everywhere: Path
) -> None:
    content = (everywhere / "binaries" / place).read_bytes()
    assert read(content) == expected
    for function in ("fmi2Instantiate", "fmi2DoStep", "fmi2DeSerializeFMUstate"):
        assert function.encode() in content


def test_the_same_bytes_each_time(parts: Callable[..., Any]) -> None:
    platforms = ("win64", "aarch64-linux")
    assert len({native_content(parts("HandmadePlain"), platforms=platforms, fmi=3) for _ in range(2)}) == 1


def _printed(command: list[Any], folder: Path) -> list[str]:
    environment = os.environ | {"WINEDEBUG": "-all", "WINEPREFIX": str(folder / "wine")}
    done = subprocess.run(
        list(map(str, command)), cwd=folder, env=environment, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.split("\n")


@pytest.fixture(scope="module")
def run_both(everywhere: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., list[list[str]]]:
    """Run the library for Linux, and that for Windows in wine; return what both print."""
    wine = shutil.which("wine64") or shutil.which("wine") or "/usr/lib/wine/wine64"  # Debian's wine64
    if not Path(wine).exists():
        _lacking("wine is not installed: apt-get install wine64")
    headers, folder = f"-I{everywhere / 'sources'}", tmp_path_factory.mktemp("host")
    subprocess.run(["cc", headers, HOST, "-o", folder / "host", "-ldl"], check=True)
    target = toolchain.platform_named("win64").zig
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", target, headers, HOST, "-o", folder / "host.exe"]
    subprocess.run(zig, check=True)

    def run(name: str, binaries: Path, *arguments: str) -> list[list[str]]:
        shutil.copy(binaries / "win64" / f"{name}.dll", folder)
        here = _printed([folder / "host", binaries / "linux64" / f"{name}.so", *arguments], folder)
        there = _printed([wine, "host.exe", f"{name}.dll", *arguments], folder)
        return [here, [line.rstrip("\r") for line in there]]

    return run


def test_the_library_for_windows_computes_what_the_one_for_linux_does(
    everywhere: Path, parts: Callable[..., Any], run_both: Callable[..., list[list[str]]]
) -> None:
    token = token_of(parts("HandmadePlain").digest)
    here, there = run_both("HandmadePlain", everywhere / "binaries", token, STEPS, *REFERENCES)
    assert len(here) > int(STEPS)
    assert [line for line in there if "0x" not in line] == [line for line in here if "0x" not in line]
    assert _numbers(there) == _numbers(here)  # this model calls no function of the mathematical library


@pytest.mark.parametrize("name", ["Scooter", "Rider"])
def test_another_mathematical_library_has_other_last_digits_at_most(
    name: str, run_both: Callable[..., list[list[str]]], tmp_path: Path
) -> None:
    recipe = catalog_recipe(name)
    model = getattr(import_module(recipe.module), name)
    made = native_parts(recipe, model)
    path = build_native(made, tmp_path, platforms=("linux64", "win64"))
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path)
    real = {
        causality: [str(r) for r, c, v in exposed(model) if c == causality and v.type == "Real"]
        for causality in ("input", "output")
    }
    references = (real["input"][0], *real["output"])
    here, there = run_both(name, tmp_path / "binaries", token_of(made.digest), "200", *references)
    assert len(_numbers(here)) == 200 * len(real["output"])
    assert _numbers(there) == pytest.approx(_numbers(here), rel=1e-12, abs=1e-12)


def _numbers(lines: list[str]) -> list[float]:
    return [float.fromhex(word) for line in lines if "0x" in line for word in line.split()]
