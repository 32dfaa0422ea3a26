"""A native FMU: the C of a model and the runtime around it, compiled, described and packed.

    modelDescription.xml
    binaries/<platform>/<Name>.<so|dll|dylib>
    sources/model.c                        the model
    sources/*.c, *.h                       the runtime of all models
    sources/buildDescription.xml           which files, which flags
    sources/python_files.txt               the files of a model of the user's own, with their digests
    documentation/licenses/evcosim.txt

The same sources and compilers give the same bytes. Compilers see the files of `sources` alone, under the same
names, so that no folder of this machine gets into a library.
"""

from __future__ import annotations

import functools
import uuid
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from ...models.base import Model
from .. import cache, runtime
from ..archive import packed
from ..catalog import Experiment
from ..description import Origin, describe, written
from ..recipes import PYTHON_FILES
from . import shipped, toolchain
from .description3 import describe_3

_RUNTIME = Path(__file__).with_name("c")
MODEL = "model.c"
_OF_FMI = {2: ("fmi2.c", "fmi2_types.h"), 3: ("fmi3.c", "fmi3_types.h")}
"""The files of the runtime that only one version of FMI needs."""


class NativeParts(NamedTuple):
    """The ingredients of a native FMU; `digest` has 32 hexadecimal digits and stands for all of them.

    `python_files` is the content of the entry of that name, left out where it is empty.
    """

    model: type[Model]
    source: str
    digest: str
    experiment: Experiment
    version: str
    license: str
    python_files: str = ""


def identity_of(name: str, digest: str) -> str:
    """Return what a saved state of an FMU begins with."""
    return f"{name}_{digest[:12]}_native"


def token_of(digest: str) -> str:
    """Return the guid (FMI 2.0) and instantiationToken (FMI 3.0) of an FMU."""
    return "{" + str(uuid.UUID(digest)) + "}"


def build_native(
    parts: NativeParts, folder: str | Path, *, platforms: Sequence[str] = (), fmi: int = 2
) -> Path:
    """Write `folder/<name>.fmu` and return its path; on any failure nothing is written.

    `platforms` are names of `toolchain.PLATFORMS`, this machine's if there are none, and `fmi` is 2 or 3.
    Raises ToolchainError, ValueError for an unknown unit of measure, OSError.
    """
    content = native_content(parts, platforms=platforms, fmi=fmi)
    return cache.write(Path(folder) / f"{parts.model.__name__}.fmu", content)


def native_content(parts: NativeParts, *, platforms: Sequence[str] = (), fmi: int = 2) -> bytes:
    """Return the bytes of a native FMU. Raises what `build_native` raises."""
    return native_made(parts, platforms=platforms, fmi=fmi).content


class Made(NamedTuple):
    """The bytes of a native FMU, and where its libraries came from: `SHIPPED` or "compiled by gcc"."""

    content: bytes
    library: str


SHIPPED = "shipped with evcosim"


def native_made(parts: NativeParts, *, platforms: Sequence[str] = (), fmi: int = 2) -> Made:
    """Return a native FMU, and where its libraries came from. Raises what `build_native` raises."""
    if fmi not in _OF_FMI:
        raise ValueError(f"there are native FMUs of FMI 2 and 3, not of {fmi}")
    name, targets = parts.model.__name__, toolchain.targets(platforms)
    files = sources(parts.source, fmi)
    c_files = [file for file in files if file.endswith(".c")]
    origin = Origin(
        token_of(parts.digest), f"evcosim {runtime.version('evcosim')}", parts.version, parts.license
    )
    entries = {f"sources/{file}": content for file, content in files.items()}
    entries["sources/buildDescription.xml"] = build_description(name, c_files)
    entries["modelDescription.xml"] = (
        describe(parts.model, origin, parts.experiment, c_files)
        if fmi == 2
        else describe_3(parts.model, origin, parts.experiment)
    )
    if parts.python_files:
        entries[PYTHON_FILES] = parts.python_files.encode()
    entries["documentation/licenses/evcosim.txt"] = runtime.license_text("evcosim")
    made: list[str] = []
    for target in dict.fromkeys(targets):
        place = f"binaries/{target.fmi2 if fmi == 2 else target.fmi3}/{name}{target.suffix}"
        entries[place], how = _library(files, target)
        made.append(how)
    return Made(packed(entries), "; ".join(dict.fromkeys(made)))


def _library(files: dict[str, bytes], target: toolchain.Platform) -> tuple[bytes, str]:
    """Return the library of these sources for a platform, and where it came from. Raises ToolchainError."""
    if (library := shipped.library(files, target)) is not None:
        return library, SHIPPED
    command = toolchain.compiler(target)
    with cache.temporary_folder() as folder:
        for file, content in files.items():
            (folder / file).write_bytes(content)
        made = toolchain.compiled(folder, [file for file in files if file.endswith(".c")], target)
    return made, f"compiled by {toolchain.named(command)}"


def sources(model_c: str, fmi: int) -> dict[str, bytes]:
    """Return the files of the folder `sources` by name: the model and the runtime of a version of FMI."""
    others = {file for version, files in _OF_FMI.items() if version != fmi for file in files}
    files = {name: content for name, content in _runtime().items() if name not in others}
    return {MODEL: model_c.encode(), **files}


@functools.cache
def _runtime() -> dict[str, bytes]:
    """Return the C files and headers of the runtime by name."""
    found = sorted(file for file in _RUNTIME.iterdir() if file.suffix in (".c", ".h"))
    return {file.name: file.read_bytes() for file in found}


def build_description(name: str, c_files: Iterable[str]) -> bytes:
    """Return buildDescription.xml of FMI 3.0, which FMUs of FMI 2.0 have too: files, language and flags."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    build = SubElement(root, "BuildConfiguration", modelIdentifier=name)
    files = SubElement(build, "SourceFileSet", language="C99", compilerOptions=" ".join(toolchain.EXACT))
    for file in c_files:
        SubElement(files, "SourceFile", name=file)
    SubElement(build, "Library", name="m", external="true", description="The mathematical functions of C")
    return written(root)
