"""The libraries of built-in models that a wheel ships (see `shipped`): what `setup.py` calls to build one.

    python -m evcosim.fmus.native.ship FOLDER

compiles every built-in model for this machine's platform, FMI 2.0 and 3.0 and every version of Python that
native FMUs follow, and prints the tag of the platforms on which the libraries run: manylinux_2_17_x86_64 for
what needs glibc 2.17. It imports nothing but Python's own modules and this package. The same sources and
compiler give the same files.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import struct
import sys
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from .. import cache
from ..catalog import CATALOG
from . import build, package, shipped, toolchain
from .errors import NoNativeError, ToolchainError

_FMI = (2, 3)


class Library(NamedTuple):
    """A library of a model, by the digest of the C files that it was compiled from (`shipped.key`)."""

    name: str
    fmi: int
    minor: int
    key: str
    content: bytes


def compiler(target: toolchain.Platform) -> list[str]:
    """Return the command that compiles what is shipped: $CC, zig for an old glibc, else this machine's own.

    Raises ToolchainError where there is none.
    """
    if not os.environ.get("CC") and toolchain.has_zig():
        return toolchain.zig(target)
    return toolchain.compiler(target)


def libraries(names: Iterable[str], target: toolchain.Platform, command: list[str]) -> Iterator[Library]:
    """Yield the libraries of built-in models for a platform, those of one model after the other's.

    What does not depend on a model is compiled once. Raises Unsupported, ToolchainError.
    """
    with cache.temporary_folder() as folder, ThreadPoolExecutor(os.cpu_count()) as pool:
        places = {fmi: _runtime(folder / f"fmi{fmi}", fmi) for fmi in _FMI}
        objects = {
            fmi: list(pool.map(lambda file, p=place: _object(p, file, target, command), _c_files(place)))
            for fmi, place in places.items()
        }
        waiting = []
        for name in names:
            for minor, source in build.sources_by_version(name).items():
                place = folder / f"{name}{minor}"
                waiting.append(pool.submit(_of_model, place, name, minor, source, objects, target, command))
        for each in waiting:
            yield from each.result()


def _runtime(folder: Path, fmi: int) -> Path:
    """Write the files of the runtime into a folder, and return it."""
    folder.mkdir()
    for file, content in package.sources("", fmi).items():
        if file != package.MODEL:
            (folder / file).write_bytes(content)
    return folder


def _c_files(folder: Path) -> list[str]:
    return sorted(file.name for file in folder.glob("*.c"))


def _object(folder: Path, file: str, target: toolchain.Platform, command: list[str]) -> tuple[str, bytes]:
    """Return the name and the content of the object of a C file. It is compiled in a folder of its own."""
    apart = folder / Path(file).stem
    apart.mkdir()
    for each in (file, *(header.name for header in folder.glob("*.h"))):
        (apart / each).write_bytes((folder / each).read_bytes())
    return Path(file).with_suffix(".o").name, toolchain.compiled_object(apart, file, target, command)


def _of_model(
    folder: Path,
    name: str,
    minor: int,
    source: str,
    objects: dict[int, list[tuple[str, bytes]]],
    target: toolchain.Platform,
    command: list[str],
) -> list[Library]:
    """Return the libraries of a model's C, one for each version of FMI."""
    _runtime(folder, _FMI[0])
    (folder / package.MODEL).write_text(source, encoding="utf-8")
    _, own = _object(folder, package.MODEL, target, command)
    made = []
    for fmi in _FMI:
        place = folder / f"fmi{fmi}"
        place.mkdir()
        parts = dict([("model.o", own), *objects[fmi]])
        for part, content in parts.items():
            (place / part).write_bytes(content)
        files = package.sources(source, fmi)
        order = [Path(file).with_suffix(".o").name for file in files if file.endswith(".c")]  # as in an FMU
        library = toolchain.compiled(place, order, target, command)
        made.append(Library(name, fmi, minor, shipped.key(files), library))
    return made


def write(made: Iterable[Library], target: toolchain.Platform, folder: Path) -> list[bytes]:
    """Write libraries and their record into a folder, equal ones of a model once; return what is written."""
    record: dict[str, tuple[str, str]] = {}
    files: dict[str, bytes] = {}
    names: dict[str, str] = {}
    for each in made:
        digest = hashlib.sha256(each.content).hexdigest()
        file = names.setdefault(digest, f"{each.name}_fmi{each.fmi}_py3{each.minor}{target.suffix}")
        files[file] = each.content
        record[each.key] = file, digest
    folder.mkdir(parents=True, exist_ok=True)
    for file, content in files.items():
        (folder / file).write_bytes(content)
    text = json.dumps({target.fmi2: record}, indent=0, sort_keys=True)
    (folder / shipped.RECORD).write_text(f"{text}\n", encoding="utf-8")
    return list(files.values())


# -- the tag of a wheel --------------------------------------------------------------------------------------

_EVERYWHERE = ("libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1")
_OLDEST = 17  # of the tags manylinux_2_*: each glibc 2 before it is in no use any more


def platform_tag(made: Iterable[bytes], machine: str = "") -> str:
    """Return the tag of the platforms on which libraries of this one run: manylinux_2_35_x86_64.

    It has the newest version of glibc that any of them asks for; it is linux_x86_64 where one asks for
    anything else. `machine` is this one by default.
    """
    machine = machine or platform.machine()
    newest = _OLDEST
    for content in made:
        needed, versions = asked(content)
        if not needed or not needed <= set(_EVERYWHERE):
            return f"linux_{machine}"
        for version in versions:
            name, _, number = version.partition("_")
            parts = number.split(".")
            if name != "GLIBC" or parts[0] != "2" or not parts[1].isdigit():
                return f"linux_{machine}"
            newest = max(newest, int(parts[1]))
    return f"manylinux_2_{newest}_{machine}"


def asked(library: bytes) -> tuple[set[str], set[str]]:
    """Return the libraries that a 64-bit ELF library needs, and the versions of symbols that it needs."""
    sections = list(_sections(library))
    needed, versions = set(), set()
    for kind, start, size, link, info in sections:
        if kind not in (_DYNAMIC, _VERSIONS_NEEDED):
            continue
        texts = sections[link][1]
        if kind == _DYNAMIC:
            for tag, value in struct.iter_unpack("<qQ", library[start : start + size]):
                if tag == 1:  # DT_NEEDED
                    needed.add(_text(library, texts + value))
        else:
            versions |= {_text(library, texts + name) for name in _needed_versions(library, start, info)}
    return needed, versions


_DYNAMIC, _VERSIONS_NEEDED = 6, 0x6FFFFFFE


def _sections(library: bytes) -> Iterator[tuple[int, int, int, int, int]]:
    """Yield type, place, size, link and info of each section."""
    (table,) = struct.unpack_from("<Q", library, 0x28)
    size, count = struct.unpack_from("<HH", library, 0x3A)
    for k in range(count):
        _, kind, _, _, start, length, link, info = struct.unpack_from("<IIQQQQII", library, table + k * size)
        yield kind, start, length, link, info


def _needed_versions(library: bytes, start: int, count: int) -> Iterator[int]:
    """Yield the places of the names of the versions that a section of them lists."""
    for _ in range(count):
        _, entries, _, first, following = struct.unpack_from("<HHIII", library, start)
        place = start + first
        for _ in range(entries):
            _, _, _, name, after = struct.unpack_from("<IHHII", library, place)
            yield name
            place += after
        start += following


def _text(library: bytes, place: int) -> str:
    return library[place : library.index(b"\0", place)].decode()


def main() -> None:
    """Write the libraries of all built-in models into the folder of the command line, and print their tag."""
    folder = Path(sys.argv[1])
    try:
        target = toolchain.here()
        if target.suffix != ".so":
            raise ToolchainError(f"libraries are shipped for Linux, not for {target.fmi2}")
        written = write(libraries(CATALOG, target, compiler(target)), target, folder)
    except NoNativeError as error:
        sys.exit(str(error))
    print(platform_tag(written))


if __name__ == "__main__":
    main()
