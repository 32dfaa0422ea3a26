"""The C of the runtime by itself: warnings of compilers, memory, symbols, the headers of the standard."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest

from evcosim.fmus.native import toolchain
from evcosim.fmus.native.package import sources, token_of
from support.needs import give_up, need_c_compiler

HERE = Path(__file__).parent
HEADERS = Path(fmpy.__file__).parent / "c-code"
WARNINGS = ("-Wall", "-Wextra", "-pedantic", "-Werror", "-Wstrict-prototypes", "-Wvla", "-Wcast-align")
ALLOCATING = ("malloc", "calloc", "realloc", "free")


def unpacked(parts: Any, folder: Path, fmi: int = 2) -> list[str]:
    """Write the sources of an FMU into a folder; return the names of the C files."""
    files = sources(parts.source, fmi)
    for name, content in files.items():
        (folder / name).write_bytes(content)
    return [name for name in files if name.endswith(".c")]


def run(command: list[Any], folder: Path) -> str:
    """Run a command, which must end well; return what it says."""
    done = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.fixture(params=["gcc", "clang"])
def compiler(request: pytest.FixtureRequest) -> str:
    """A compiler that may be there."""
    if shutil.which(request.param) is None:
        if request.param == "gcc":
            need_c_compiler()
        give_up(f"there is no {request.param} on this machine")
    return str(request.param)


@pytest.mark.parametrize(
    ("name", "fmi", "which"),
    [
        ("Handmade", 2, "*.c"),
        ("HandmadeSampled", 3, "fmi3.c"),
        ("HandmadeSampled", 2, "model.c"),
        ("HandmadePlain", 2, "model.c"),
    ],
)
def test_no_compiler_warns(
    name: str, fmi: int, which: str, compiler: str, parts: Callable[..., Any], tmp_path: Path
) -> None:
    unpacked(parts(name), tmp_path, fmi)
    files = [path.name for path in tmp_path.glob(which)]
    flags = [*toolchain.EXACT, *WARNINGS]
    assert run([compiler, *flags, "-O2", "-c", *files], tmp_path) == ""
    assert run([compiler, *flags, "-O0", "-fsyntax-only", *files], tmp_path) == ""


def _program(parts: Any, folder: Path, flags: list[str], fmi: int = 2) -> Path:
    files = unpacked(parts, folder, fmi)
    exercise = HERE / f"exercise_fmi{fmi}.c"
    token = f'-DTOKEN="{token_of(parts.digest)}"'
    command = [
        "cc",
        *toolchain.EXACT,
        "-g",
        *flags,
        token,
        f"-I{HEADERS}",
        *files,
        exercise,
        "-o",
        "exercise",
    ]
    run([*command, "-lm"], folder)
    return folder / "exercise"


@pytest.mark.parametrize("fmi", [2, 3])
def test_nothing_is_allocated_after_the_creation(fmi: int, parts: Callable[..., Any], tmp_path: Path) -> None:
    wrapped = [f"-Wl,--wrap={name}" for name in ALLOCATING]
    program = _program(parts("Handmade"), tmp_path, ["-O2", "-DCOUNTING", *wrapped], fmi)
    assert run([program], tmp_path) == ""


@pytest.mark.parametrize("fmi", [2, 3])
def test_sanitizers_find_nothing(fmi: int, parts: Callable[..., Any], tmp_path: Path) -> None:
    flags = ["-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    try:
        program = _program(parts("Handmade"), tmp_path, flags, fmi)
    except AssertionError as error:
        if "cannot find" in str(error):
            give_up("the compiler has no sanitizers")
        raise
    assert run([program], tmp_path) == ""


def _exports(library: Path) -> set[str]:
    said = run(["nm", "-D", "--defined-only", library], library.parent)
    return {line.split()[-1] for line in said.splitlines()}


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_functions_of_the_standard_and_nothing_else(
    fmi: int, pairs: Callable[..., Any], tmp_path: Path
) -> None:
    library = _library(pairs("Handmade", fmi).native, tmp_path)
    assert _exports(library) == declared(fmi)


def _library(fmu: Path, folder: Path) -> Path:
    fmpy.extract(str(fmu), str(folder))
    (library,) = folder.glob("binaries/*/*.so")
    return library


def declared(fmi: int) -> set[str]:
    """Return the functions for Co-Simulation of a version of FMI, as its headers name them."""
    text = (HEADERS / f"fmi{fmi}Functions.h").read_text()
    found = set(re.findall(rf"FMI{fmi}_Export\s+\w+TYPE\s+(\w+);", text))
    if fmi == 2:
        exchange = text.split("FMI2 for Model Exchange")[-1].split("FMI2 for Co-Simulation")[0]
        found -= set(re.findall(r"FMI2_Export\s+\w+TYPE\s+(\w+);", exchange))
    assert len(found) > 30
    return found


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_types_are_those_of_the_standard(fmi: int, parts: Callable[..., Any], tmp_path: Path) -> None:
    unpacked(parts("Handmade"), tmp_path, fmi)
    theirs = f'#include "fmi{fmi}Functions.h"\n#define EXPORT FMI{fmi}_Export\n'
    (tmp_path / f"fmi{fmi}_types.h").write_text(theirs)
    run(["cc", "-std=c99", "-Wall", "-Werror", f"-I{HEADERS}", "-c", f"fmi{fmi}.c"], tmp_path)


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_library_has_no_state_of_its_own(fmi: int, pairs: Callable[..., Any], tmp_path: Path) -> None:
    library = _library(pairs("Handmade", fmi).native, tmp_path)
    said = run(["nm", "--format=sysv", library], tmp_path)
    rows = [[field.strip() for field in line.split("|")] for line in said.splitlines() if "|" in line]
    kept = [row[0] for row in rows if row[-1] in (".data", ".bss") and row[3] == "OBJECT"]
    ours = [name for name in kept if not name.startswith(("_", "completed."))]  # not the C library's
    assert ours == []
    assert len(kept) > len(ours)  # so that the table was read
