"""The library of an FMU that brings its C sources, made by this machine's C compiler.

FMPy's own command needs CMake, a valid description and the list of its sources; a compiler is enough.
"""

from __future__ import annotations

import contextlib
import os
import shlex
import shutil
import signal
import subprocess
import zipfile
from pathlib import Path
from typing import Any

from ...cosim import leftovers
from ...cosim.writing import replacing
from .archive import FmuError, extract, read_entry
from .description import parsed_xml
from .fmu import Fmu, read_fmu

_SHOWN = 3000  # characters of the compiler's messages
_TIME = 600.0  # s


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
    """Compile the sources in `folder` and return the bytes of the library. Raises FmuError."""
    sources, flags = _declared(fmu)
    target = folder / "evcosim-library"
    headers = Path(_fmpy_folder()) / "c-code"
    command = [
        *shlex.split(os.environ.get("CC", "cc")), "-O2", "-fPIC", "-shared", "-w", *flags,
        f"-I{folder / 'sources'}", f"-I{headers}", *(str(folder / name) for name in sources),
        "-o", str(target), "-lm",
    ]  # fmt: skip # the order in which compilers want it
    try:
        code, said = _ran(command, folder / "sources")
    except FileNotFoundError as error:
        raise FmuError(
            f"{fmu.path}: there is no C compiler '{command[0]}' here; install one (apt-get install gcc) or "
            "name it: CC=clang evcosim compile ..."
        ) from error
    except subprocess.TimeoutExpired as error:
        raise FmuError(f"{fmu.path}: compiling its sources took more than {_TIME:g} s") from error
    if code:
        said = said.replace(f"{folder}{os.sep}", "")
        raise FmuError(f"{fmu.path}: {command[0]} cannot compile its sources:\n{said.strip()[:_SHOWN]}")
    return target.read_bytes()


def _ran(command: list[str], folder: Path) -> tuple[int, str]:
    """Run a command in a folder; return its exit code and its messages. It ends with this process."""
    running = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    )

    def kill() -> None:  # a compiler starts processes of its own
        if hasattr(os, "killpg"):
            os.killpg(running.pid, signal.SIGKILL)
        else:
            running.kill()

    leftovers.add_child(running.pid, kill)
    try:
        out, err = running.communicate(timeout=_TIME)
    except BaseException:
        with contextlib.suppress(OSError):
            kill()
        running.communicate()
        raise
    finally:
        leftovers.forget_child(running.pid)
    return running.returncode, (err + out).decode("utf-8", "replace")


def _fmpy_folder() -> str:
    import fmpy

    return str(Path(fmpy.__file__).parent)


def _declared(fmu: Fmu) -> tuple[list[str], list[str]]:
    """Return the entries to compile and the compiler's flags, as the FMU declares them; else each C file.

    Raises FmuError for a declared file that is not in the archive.
    """
    names, flags = (_of_fmi_3 if fmu.description.fmiVersion.startswith("3") else _of_fmi_2)(fmu)
    if lacking := [name for name in names if name not in fmu.entries]:
        raise FmuError(f"{fmu.path}: declares the source {lacking[0]}, which is not in it")
    return names or list(fmu.c_sources), flags


def _root(fmu: Fmu, entry: str) -> Any:
    return parsed_xml(f"{fmu.path}: {entry}", read_entry(fmu.path, entry))


def _of_fmi_2(fmu: Fmu) -> tuple[list[str], list[str]]:
    tag = "CoSimulation" if fmu.interface_type == "co_simulation" else "ModelExchange"
    files = _root(fmu, "modelDescription.xml").findall(f"{tag}/SourceFiles/File")
    return [f"sources/{file.get('name')}" for file in files], []


def _of_fmi_3(fmu: Fmu) -> tuple[list[str], list[str]]:
    """Return sources and definitions of the first build configuration for the library."""
    entry = "sources/buildDescription.xml"
    if entry not in fmu.entries:
        return [], []
    found = _root(fmu, entry).findall("BuildConfiguration")
    mine = [c for c in found if c.get("modelIdentifier") == fmu.kind.modelIdentifier]
    sets = mine[0].findall("SourceFileSet") if mine else []
    names = [f"sources/{file.get('name')}" for each in sets for file in each.findall("SourceFile")]
    flags = []
    for definition in [d for each in sets for d in each.findall("PreprocessorDefinition")]:
        value = definition.get("value")
        flags.append(f"-D{definition.get('name')}" + ("" if value is None else f"={value}"))
    return names, flags


def _written(path: Path, output: Path, made: dict[str, bytes]) -> Path:
    """Write the archive with the libraries that were made."""
    with replacing(output) as file:
        with path.open("rb") as content:
            shutil.copyfileobj(content, file)
        with zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as archive:
            for name, library in made.items():
                archive.writestr(name, library)
    return output
