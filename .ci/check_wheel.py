"""A wheel holds the files of the packages, byte for byte, and its own metadata: none missing, nothing else.

    python3 .ci/check_wheel.py dist/evcosim-0.2.0-py3-none-any.whl    # exit code 1 and what is wrong

One for a platform holds the libraries of the built-in models too, which its record lists. None has more than
5 MB.
It needs the standard library (and git in a clone) alone, so that it runs before anything is installed.
"""

from __future__ import annotations

import hashlib
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
_FOLDERS = {"api": "", "models": "models/", "fmus": "fmus/", "cosim": "cosim/", "master": "master/"}
_METADATA = {"METADATA", "WHEEL", "RECORD", "entry_points.txt", "top_level.txt", "licenses/LICENSE"}


_SHIPPED = "evcosim/fmus/native/shipped/"
_RECORD = f"{_SHIPPED}record.json"
_MOST = 5_000_000  # bytes


def wanted(root: pathlib.Path = ROOT) -> dict[str, pathlib.Path]:
    """The files of the packages by their names in the wheel: in a git checkout those that git knows."""
    known = _tracked(root)
    return {
        f"evcosim/{inside}{path.relative_to(root / folder).as_posix()}": path
        for folder, inside in _FOLDERS.items()
        for path in (root / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and (known is None or path in known)
    }


def _tracked(root: pathlib.Path) -> set[pathlib.Path] | None:
    """The files that git tracks, so that a stray one is no part of a package; None where git says nothing."""
    if not (root / ".git").exists() or shutil.which("git") is None:  # a source distribution, or no git
        return None
    call = ["git", "-c", "safe.directory=*", "ls-files", "-z"]  # the clone may be another user's
    listed = subprocess.run(call, cwd=root, capture_output=True, text=True, check=True)
    return {root / name for name in listed.stdout.split("\0") if name}


def problems(wheel: pathlib.Path, root: pathlib.Path = ROOT) -> list[str]:
    """Return the defects of a wheel, a line each; [] for none."""
    version = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    files = wanted(root)
    metadata = {f"evcosim-{version}.dist-info/{name}" for name in _METADATA}
    size = wheel.stat().st_size
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        libraries, found = _shipped(archive, root, pure=wheel.name.endswith("-py3-none-any.whl"))
        if size > _MOST:
            found.append(f"it has {size} bytes, more than {_MOST}")
        expected = files.keys() | metadata | libraries
        found += [f"it lacks {name}" for name in sorted(expected - names)]
        found += [f"it has {name}, which no package has" for name in sorted(names - expected)]
        differ = [
            name for name in sorted(files.keys() & names) if archive.read(name) != files[name].read_bytes()
        ]
    return found + [f"{name} is not the one of the package" for name in differ]


def _shipped(archive: zipfile.ZipFile, root: pathlib.Path, pure: bool) -> tuple[set[str], list[str]]:
    """Return the files of the shipped libraries, and what is wrong with them; a pure wheel has none."""
    if pure:
        return set(), []
    if _RECORD not in archive.namelist():
        return {_RECORD}, []
    found: list[str] = []
    ((platform, record),) = json.loads(archive.read(_RECORD)).items()
    if platform not in ("linux64", "aarch64-linux"):
        found.append(f"{_RECORD} is of {platform}")
    for file, digest in record.values():
        name = f"{_SHIPPED}{file}"
        if name in archive.namelist() and hashlib.sha256(archive.read(name)).hexdigest() != digest:
            found.append(f"{name} is not the recorded one")
    catalog = (root / "fmus" / "catalog.py").read_text(encoding="utf-8")
    for model in re.findall(r'^    "(\w+)": ', catalog, re.MULTILINE):
        count = sum(file.startswith(f"{model}_fmi") for file, _ in record.values())
        if count != _VERSIONS:
            found.append(f"{_RECORD} has {count} libraries of {model}, not {_VERSIONS}")
    return {_RECORD} | {f"{_SHIPPED}{file}" for file, _ in record.values()}, found


_VERSIONS = 2 * 4  # of FMI 2.0 and 3.0, of Python 3.11 to 3.14


def main() -> None:
    """Check the wheel that the command line names."""
    wheel = pathlib.Path(sys.argv[1])
    if found := problems(wheel):
        sys.exit("\n".join([f"{wheel}:", *found]))
    size = wheel.stat().st_size / 1e6
    kind = "" if wheel.name.endswith("-any.whl") else ", the libraries of the built-in models"
    print(f"{wheel.name}: the {len(wanted())} files of the packages{kind} and metadata, {size:.1f} MB")


if __name__ == "__main__":
    main()
