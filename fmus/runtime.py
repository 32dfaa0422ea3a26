"""The parts that every FMU carries besides its model: pythonfmu's libraries and Python files, licenses."""

from __future__ import annotations

import functools
import importlib.util
from pathlib import Path

_PYTHON_FILES = ("fmi2slave", "logmsg", "default_experiment", "enums", "variables", "_version")


@functools.cache
def binaries() -> dict[str, bytes]:
    """Return the content of pythonfmu's native libraries by `platform/suffix`: linux64/.so, win64/.dll."""
    folder = _folder() / "resources" / "binaries"
    files = (f for f in sorted(folder.glob("*/*")) if f.suffix in (".so", ".dll", ".dylib"))
    return {f"{file.parent.name}/{file.suffix}": file.read_bytes() for file in files}


@functools.cache
def python_files() -> dict[str, bytes]:
    """Return the content of the modules of pythonfmu that a slave needs, by file name."""
    return {f"{name}.py": (_folder() / f"{name}.py").read_bytes() for name in _PYTHON_FILES}


@functools.cache
def licenses() -> dict[str, bytes]:
    """Return the license texts by file name below documentation/licenses."""
    return {f"{name}.txt": license_text(name) for name in ("evcosim", "pythonfmu")}


@functools.cache
def version(distribution: str) -> str:
    """Return the installed version of a distribution."""
    from importlib import metadata  # slow to import

    return metadata.version(distribution)


def _folder() -> Path:
    """Return the folder of pythonfmu, found without importing it. Raises ModuleNotFoundError."""
    spec = importlib.util.find_spec("pythonfmu")
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError("pythonfmu is not installed: pip install pythonfmu")
    return Path(spec.origin).parent


@functools.cache
def license_text(distribution: str) -> bytes:
    """Return the license text of an installed distribution. Raises FileNotFoundError where it has none.

    The text lies in dist-info/licenses since metadata version 2.4, before in dist-info itself. A checkout's
    own is beside the folder of this package. Several distributions of one name may be found: the working
    folder can hold the egg-info of a build, which has no texts.
    """
    checkout = Path(__file__).resolve().parents[1] / "LICENSE"
    if distribution == "evcosim" and checkout.is_file():
        return checkout.read_bytes()
    from importlib import metadata  # slow to import

    for found in metadata.distributions(name=distribution):
        if text := found.read_text("licenses/LICENSE") or found.read_text("LICENSE"):
            return text.encode()
    raise FileNotFoundError(f"the installed {distribution} has no LICENSE, which an FMU must carry")
