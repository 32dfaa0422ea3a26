"""Compilers: this machine's own for its platform, and `zig cc` (the package ziglang) for the others.

What the flags must see to: no product is fused with a sum (-ffp-contract=off), and functions of the
mathematical library are called, not computed by the compiler, whose last bits may differ from the library's
(-fno-builtin). Sources that are compiled elsewhere find the same flags in their build description.
"""

from __future__ import annotations

import importlib.util
import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from .errors import ToolchainError

_MATHEMATICAL = (
    "acos acosh asin asinh atan atan2 atanh cbrt cos cosh erf erfc exp exp2 expm1 fmod hypot lgamma log log10"
    " log1p log2 pow sin sinh tan tanh tgamma"
)
EXACT = ("-std=c99", "-ffp-contract=off", *(f"-fno-builtin-{name}" for name in _MATHEMATICAL.split()))
"""Flags without which a library computes something else than Python."""

_SCALAR = ("-fno-tree-vectorize", "-fno-tree-slp-vectorize")  # pairs of numbers cost a step more
_FLAGS = ("-O3", *_SCALAR, "-fvisibility=hidden", *EXACT)
_SHOWN = 12  # lines of a compiler's messages
_TIME = 600.0  # s; zig compiles the libraries of a platform at its first use


class Platform(NamedTuple):
    """A platform by its names in FMI 2.0 and 3.0, zig's name for it, and the suffix of its libraries."""

    fmi2: str
    fmi3: str
    zig: str
    suffix: str


_PLATFORMS = (
    Platform("linux64", "x86_64-linux", "x86_64-linux-gnu.2.17", ".so"),
    Platform("win64", "x86_64-windows", "x86_64-windows-gnu", ".dll"),
    Platform("darwin64", "x86_64-darwin", "x86_64-macos", ".dylib"),
    Platform("aarch64-darwin", "aarch64-darwin", "aarch64-macos", ".dylib"),
    Platform("aarch64-linux", "aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
)
PLATFORMS = {each.fmi2: each for each in _PLATFORMS}
"""The platforms by the names that a user gives them, which are those of FMI 2.0."""


def here() -> Platform:
    """Return the platform of this machine. Raises ToolchainError for one that is not in the list."""
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine())
    system = {"win32": "windows"}.get(sys.platform, sys.platform)
    for each in _PLATFORMS:
        if each.fmi3 == f"{machine}-{system}":
            return each
    raise ToolchainError(f"no platform is known for this machine ({machine}, {system}); {_known()}")


def platform_named(name: str) -> Platform:
    """Return the platform of a name in FMI 2.0 or 3.0. Raises ToolchainError for an unknown one."""
    for each in _PLATFORMS:
        if name in (each.fmi2, each.fmi3):
            return each
    raise ToolchainError(f"there is no platform {name!r}; {_known()}")


def targets(names: Sequence[str]) -> list[Platform]:
    """Return the platforms of these names, this machine's if there are none. Raises ToolchainError."""
    return [platform_named(name) for name in names] or [here()]


def _known() -> str:
    return f"the platforms are {', '.join(PLATFORMS)}"


def compiled(folder: Path, sources: Sequence[str], target: Platform, command: Sequence[str] = ()) -> bytes:
    """Return the shared library of the C files (or objects) of a folder, by their names in it.

    `command` is the compiler, by default that of the platform. Raises ToolchainError where there is none, and
    where it fails.
    """
    library = f"library{target.suffix}"
    ending = [] if target.suffix == ".dll" else ["-lm"]
    return _made(folder, ["-shared", *sources], target, command, library, ending)


def compiled_object(folder: Path, source: str, target: Platform, command: Sequence[str] = ()) -> bytes:
    """Return a C file of a folder as an object, for `compiled`. Raises ToolchainError."""
    return _made(folder, ["-c", source], target, command, "object.o", [])


def _made(
    folder: Path,
    arguments: Sequence[str],
    target: Platform,
    command: Sequence[str],
    file: str,
    ending: Sequence[str],
) -> bytes:
    """Return what a compiler writes into a file of a folder. Raises ToolchainError."""
    command = command or compiler(target)
    position = [] if target.suffix == ".dll" else ["-fPIC"]
    line = [*command, *_FLAGS, *position, *arguments, "-o", file, *ending]
    try:
        done = subprocess.run(line, cwd=folder, capture_output=True, timeout=_TIME, check=False)
    except FileNotFoundError as error:
        raise ToolchainError(
            f"there is no C compiler {command[0]!r} here; install one (apt-get install gcc) "
            "or name it: CC=clang"
        ) from error
    except OSError as error:
        raise ToolchainError(f"{command[0]} cannot be run: {error.strerror or error}") from error
    except subprocess.TimeoutExpired as error:
        raise ToolchainError(f"{shlex.join(command)} took more than {_TIME:g} s") from error
    made = folder / file
    if done.returncode or not made.is_file():
        raise ToolchainError(_failure(command, target, done))
    return made.read_bytes()


def compiler(target: Platform) -> list[str]:
    """Return the command of a compiler for a platform: $CC, cc, gcc or clang for this one, else zig's.

    Raises ToolchainError where there is none.
    """
    if target == here():
        if chosen := shlex.split(os.environ.get("CC", "")):
            return chosen
        for name in ("cc", "gcc", "clang"):
            if shutil.which(name):
                return [name]
        if not has_zig():
            raise ToolchainError(
                "there is no C compiler here (cc, gcc, clang): install one (apt-get install gcc), name it in "
                'the environment variable CC, or pip install "evcosim[native]", which brings one'
            )
    if not has_zig():
        raise ToolchainError(
            f"libraries for {target.fmi2} are made by zig, which is not installed here: "
            'pip install "evcosim[native]"'
        )
    return zig(target)


def zig(target: Platform) -> list[str]:
    """Return the command of zig's compiler for a platform; of Linux, for old versions of glibc too."""
    return [sys.executable, "-m", "ziglang", "cc", "-target", target.zig, "-s"]


def named(command: Sequence[str]) -> str:
    """Return the short name of a compiler: gcc, zig."""
    return "zig" if "ziglang" in command else Path(command[0]).name


def has_zig() -> bool:
    """Return True if zig is installed, from PyPI's package ziglang."""
    return importlib.util.find_spec("ziglang") is not None


def _failure(command: Sequence[str], target: Platform, done: subprocess.CompletedProcess[bytes]) -> str:
    """Return that a compiler failed, and the first lines that it said."""
    said = (done.stderr + done.stdout).decode("utf-8", "replace").strip().splitlines()
    shown = [f"  {line}" for line in said[:_SHOWN]] or ["  (it says nothing)"]
    if len(said) > _SHOWN:
        shown.append(f"  ({len(said) - _SHOWN} more lines)")
    end = f"exit code {done.returncode}" if done.returncode else "nothing was written"
    return "\n".join([f"{shlex.join(command)} fails for {target.fmi2} ({end}):", *shown])
