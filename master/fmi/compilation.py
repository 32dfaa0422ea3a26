"""The library of an FMU that brings its C sources, made by this machine's C compiler.

FMPy's own command needs CMake, a valid description and the list of its sources; a compiler is enough.
"""

from __future__ import annotations

import os
import posixpath
import re
import shlex
import shutil
import subprocess
import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ...cosim import leftovers
from ...cosim.writing import replacing
from .archive import FmuError, extract, read_entry
from .built_library import exported, ran
from .description import parsed_xml
from .fmu import Fmu, read_fmu

_SHOWN = 3000  # characters of the compiler's messages
_TIME = 600.0  # s
_INCLUDED = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"\n]+\.c)"', re.MULTILINE)


def compile_fmu(path: Path, output: Path | None = None) -> Path:
    """Write the FMU with a library for this machine, to `output` or over itself; every other entry stays.

    The compiler is $CC, else `cc`. An FMU with both interfaces gets the libraries of both.
    Raises FmuError naming the file and the reason; then nothing is written.
    """
    fmu = read_fmu(path)
    missing = [used for used in _interfaces(fmu) if used.binary not in fmu.entries]
    if not missing:
        raise FmuError(f"{path}: has a binary for this machine already: {fmu.binary}")
    if not fmu.c_sources:
        raise FmuError(f"{path}: has no C sources (sources/*.c), so that nothing can be compiled")
    folder = extract(path)
    try:
        made = {used.binary: _library(used, folder) for used in missing}
        return _written(path, output or path, made)
    finally:
        leftovers.remove_folder(folder)


def _interfaces(fmu: Fmu) -> list[Fmu]:
    """Return the FMU by each of its interfaces, one for each library."""
    about = fmu.description
    kinds = (("co_simulation", about.coSimulation), ("model_exchange", about.modelExchange))
    found = [fmu.using(name) for name, kind in kinds if kind is not None]  # type: ignore[arg-type] # two of them
    return list({each.binary: each for each in found}.values())


def _library(fmu: Fmu, folder: Path) -> bytes:
    """Compile the sources in `folder`, load the library once, and return its bytes.

    Where its functions have another prefix than FMI's, it is made again with the definitions that leave it
    out. Raises FmuError.
    """
    names = _functions(fmu)
    identifier = fmu.kind.modelIdentifier
    found: set[str] = set()
    for definitions in ([], _NO_PREFIX):
        target = _built(fmu, folder, definitions)
        try:
            found = exported(target, [*names, *(f"{identifier}_{name}" for name in names)])
        except OSError as error:
            raise FmuError(f"{fmu.path}: the library of its sources cannot be loaded: {error}") from error
        if found.issuperset(names):
            return target.read_bytes()
    lacking = next(name for name in names if name not in found)
    other = f"; it has {identifier}_{lacking}" if f"{identifier}_{lacking}" in found else ""
    raise FmuError(f"{fmu.path}: the library of its sources lacks the function {lacking}{other}")


_NO_PREFIX = [  # of 20-sim; of the headers of FMI
    "-DNO_FUNCTION_PREFIX",
    "-DFMI2_OVERRIDE_FUNCTION_PREFIX",
    "-DFMI3_OVERRIDE_FUNCTION_PREFIX",
]


def _functions(fmu: Fmu) -> list[str]:
    """Return two functions that the library of the interface must have."""
    steps = fmu.interface_type == "co_simulation"
    version = fmu.description.fmiVersion[0]
    if version == "1":
        what = ("InstantiateSlave", "DoStep") if steps else ("InstantiateModel", "GetDerivatives")
        return [f"{fmu.kind.modelIdentifier}_fmi{name}" for name in what]
    if version == "2":
        return ["fmi2Instantiate", "fmi2DoStep" if steps else "fmi2GetDerivatives"]
    if steps:
        return ["fmi3InstantiateCoSimulation", "fmi3DoStep"]
    return ["fmi3InstantiateModelExchange", "fmi3GetContinuousStateDerivatives"]


def _built(fmu: Fmu, folder: Path, definitions: list[str]) -> Path:
    """Compile the sources in `folder` to where the library belongs there, and return it. Raises FmuError."""
    sources, flags = _declared(fmu)
    target = folder / fmu.binary
    target.parent.mkdir(parents=True, exist_ok=True)
    headers = Path(_fmpy_folder()) / "c-code"
    more = sorted({str(path.parent) for path in (folder / "sources").rglob("*.h")})
    command = [
        *shlex.split(os.environ.get("CC", "cc")), "-O2", "-fPIC", "-shared", "-w", *flags, *definitions,
        f"-I{folder / 'sources'}", f"-I{headers}", *(f"-idirafter{path}" for path in more),
        *(str(folder / name) for name in sources), "-o", str(target), "-lm",
    ]  # fmt: skip # the order in which compilers want it
    try:
        code, said = ran(command, folder / "sources", _TIME)
    except FileNotFoundError as error:
        raise FmuError(
            f"{fmu.path}: there is no C compiler '{command[0]}' here; install one (apt-get install gcc) or "
            "name it: CC=clang evcosim compile ..."
        ) from error
    except subprocess.TimeoutExpired as error:
        raise FmuError(f"{fmu.path}: compiling its sources took more than {_TIME:g} s") from error
    if code:
        said = said.replace(f"{folder}{os.sep}", "").strip()[:_SHOWN]
        raise FmuError(f"{fmu.path}: {command[0]} cannot compile its sources:", *said.splitlines())
    return target


def _fmpy_folder() -> str:
    import fmpy

    return str(Path(fmpy.__file__).parent)


def _declared(fmu: Fmu) -> tuple[list[str], list[str]]:
    """Return the entries to compile and the compiler's flags, as the FMU declares them; else each C file that
    no other one includes.

    Raises FmuError for a declared file that is not in the archive.
    """
    names, flags = _of_build_description(fmu)
    if fmu.description.fmiVersion.startswith("2"):
        names = _of_fmi_2(fmu)
    if lacking := [name for name in names if name not in fmu.entries]:
        raise FmuError(f"{fmu.path}: declares the source {lacking[0]}, which is not in it")
    return names or _not_included(fmu), flags


def _not_included(fmu: Fmu) -> list[str]:
    """Return the C files that no other one includes: FMI 1.0 declares none, and templates are included."""
    included = set()
    for entry in fmu.c_sources:
        for name in _INCLUDED.findall(read_entry(fmu.path, entry).decode("utf-8", "replace")):
            places = posixpath.dirname(entry), "sources"
            included |= {posixpath.normpath(f"{place}/{name}") for place in places} - {entry}
    return [entry for entry in fmu.c_sources if entry not in included] or list(fmu.c_sources)


def _root(fmu: Fmu, entry: str) -> Any:
    return parsed_xml(f"{fmu.path}: {entry}", read_entry(fmu.path, entry))


def _of_fmi_2(fmu: Fmu) -> list[str]:
    tag = "CoSimulation" if fmu.interface_type == "co_simulation" else "ModelExchange"
    return _entries(_root(fmu, "modelDescription.xml").findall(f"{tag}/SourceFiles/File"))


def _entries(files: Iterable[Any]) -> list[str]:
    """Return the archive's entries for declared files, which tools write as ./util/a.c and util\\a.c too."""
    names = [str(file.get("name")).replace("\\", "/") for file in files]
    return list(dict.fromkeys(posixpath.normpath(f"sources/{name}") for name in names))


def _of_build_description(fmu: Fmu) -> tuple[list[str], list[str]]:
    """Return sources and flags of the first build configuration for the library.

    It is a part of FMI 3.0, and some FMUs of FMI 2.0, as the native ones of evcosim, have one for the flags.
    """
    entry = "sources/buildDescription.xml"
    if entry not in fmu.entries:
        return [], []
    found = _root(fmu, entry).findall("BuildConfiguration")
    mine = [c for c in found if c.get("modelIdentifier") == fmu.kind.modelIdentifier]
    sets = mine[0].findall("SourceFileSet") if mine else []
    names = _entries(file for each in sets for file in each.findall("SourceFile"))
    flags = [option for each in sets for option in _options(each)]
    for definition in [d for each in sets for d in each.findall("PreprocessorDefinition")]:
        value = definition.get("value")
        flags.append(f"-D{definition.get('name')}" + ("" if value is None else f"={value}"))
    return names, flags


def _options(source_set: Any) -> list[str]:
    """Return the options for a compiler in the manner of gcc that change what the code computes."""
    if source_set.get("compiler", "gcc").lower() not in ("gcc", "clang", "cc"):
        return []
    given = (source_set.get("compilerOptions") or "").split()
    return [option for option in given if option.startswith(_COMPUTING)]


_COMPUTING = ("-std=", "-ffp-", "-fno-", "-frounding-math", "-fsignaling-nans", "-fwrapv", "-D", "-U")


def _written(path: Path, output: Path, made: dict[str, bytes]) -> Path:
    """Write the archive with the libraries that were made."""
    with replacing(output) as file:
        with path.open("rb") as content:
            shutil.copyfileobj(content, file)
        with zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as archive:
            for name, library in made.items():
                archive.writestr(name, library)
    return output
