"""The kind of a file that was given where another one is needed, and where it belongs."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ..reading import content
from .toml_text import parsed

_PICTURE = ("a picture", "`evcosim run` draws it anew beside its results")
_LIBRARY = (
    "a compiled library",
    "an FMU (.fmu) holds one, with its description: give the FMU, and `evcosim info FILE.fmu` shows it",
)
_MATLAB = ("a file of MATLAB or Simulink", "export an FMU from there, and give that")
_C = ("C code", "a description beside it and `evcosim compile` make an FMU of it (docs/how-to/c-vehicle.md)")
_CAN_LOG = ("a log of CAN frames", "`evcosim run SYSTEM --can-log FILE` writes one; none is read")
_TABLE = (
    "a table of numbers",
    "`--input NAME=FILE.csv` gives it to an FMU by itself, a [[stimulus]] of a scenario to a system, and "
    "`evcosim plot` and `compare` read results",
)
_DATABASE = (
    "a CAN database",
    "`evcosim info FILE` shows its messages, a system file names it in [buses.NAME] by `dbc`, and "
    "`evcosim new` makes an example",
)
_MATRIX = ("a table of CAN messages", "make a DBC of it, and look at signs, offsets and codes in that")
_BY_SUFFIX = {
    ".dbc": ("a CAN database (DBC)", _DATABASE[1]),
    ".kcd": _DATABASE, ".sym": _DATABASE, ".arxml": _DATABASE,
    ".xlsx": _MATRIX, ".xls": _MATRIX, ".dbf": _MATRIX,
    ".csv": _TABLE, ".txt": ("a text", "a system is a TOML file"),
    ".ssp": ("a package of SSP", "SSP is not read yet; a system is a TOML file, with the FMUs that it names"),
    ".ssd": ("a system of SSP", "SSP is not read yet; a system is a TOML file"),
    ".so": _LIBRARY, ".dll": _LIBRARY, ".dylib": _LIBRARY, ".a": _LIBRARY, ".o": _LIBRARY,
    ".png": _PICTURE, ".svg": _PICTURE, ".jpg": _PICTURE, ".jpeg": _PICTURE, ".gif": _PICTURE,
    ".pdf": _PICTURE,
    ".py": ("Python code", "`evcosim build FILE.py` makes an FMU of each model in it"),
    ".mo": ("Modelica code", "a Modelica tool makes an FMU of it (docs/how-to/vehicle.md)"),
    ".c": _C, ".cc": _C, ".cpp": _C, ".h": _C,
    ".slx": _MATLAB, ".mdl": _MATLAB, ".mat": _MATLAB, ".m": _MATLAB,
    ".log": _CAN_LOG, ".blf": _CAN_LOG, ".asc": _CAN_LOG,
    ".json": ("a JSON file", "`evcosim plot` and `compare` read the folder of a run by its run.json"),
    ".xml": ("an XML file", "an FMU (.fmu) holds its modelDescription.xml"),
    ".zip": ("an archive", "an FMU is one whose name ends in .fmu"),
    ".html": ("a page", "a browser shows it"), ".md": ("a page of text", "a system is a TOML file"),
    ".ipynb": ("a notebook", "Jupyter runs it"),
    ".fmu": ("an FMU", "`evcosim run FILE.fmu` runs it by itself"),
}  # fmt: skip # a table: suffix, what it is, and what is done with it
_BEGINS = {
    b"\x7fELF": _LIBRARY, b"MZ": _LIBRARY, b"\x89PNG": _PICTURE, b"%PDF": _PICTURE,
    b"VERSION ": _BY_SUFFIX[".dbc"], b"BO_ ": _BY_SUFFIX[".dbc"], b"PK\x03\x04": _BY_SUFFIX[".zip"],
}  # fmt: skip # a table: the first bytes of a file
_RUN = "run.json"


def kind_of(path: Path, wanted: str) -> str:
    """Return a sentence on a folder or file that is given where a `wanted` one is needed, as "system".

    "" for what may be it, or whose name says nothing: a file that ends in .toml, one of no known kind.
    """
    try:
        if path.is_dir():
            return f"{path}: is a folder; {_in_folder(path, wanted)}"
        if not path.exists() and path.suffix.lower() in _BY_SUFFIX:
            return f"{path}: there is no such file"
        if not path.is_file() or path.suffix.lower() == ".toml":
            return ""
    except (OSError, ValueError):  # no name that a file can have
        return ""
    found = _BY_SUFFIX.get(path.suffix.lower()) or _by_content(path)
    return f"{path}: is {found[0]}, not {_a(wanted)}; {found[1]}" if found else ""


def _a(wanted: str) -> str:
    return f"{'an' if wanted[0] in 'AEFIO' else 'a'} {wanted}"


def _by_content(path: Path) -> tuple[str, str] | None:
    try:
        with path.open("rb") as file:
            begin = file.read(16)
    except OSError:  # who reads it says why not
        return None
    return next((kind for mark, kind in _BEGINS.items() if begin.startswith(mark)), None)


def _in_folder(path: Path, wanted: str) -> str:
    """Return what may be meant by a folder: the results in it, or the files of the wanted kind."""
    if (path / _RUN).is_file():
        return f"it has the results of a run, which `evcosim plot {path}` draws"
    suffix = ".fmu" if wanted == "FMU" else ".toml"
    there = sorted(file for file in path.glob(f"*{suffix}") if wanted != "system" or is_system(file))
    if there:
        return f"name {_a(wanted)} in it: {', '.join(map(str, there[:5]))}"
    return f"{_a(wanted)} is a file that ends in {suffix}, and there is none in it"


def is_system(path: Path) -> bool:
    """Return True for a TOML file with the table of units that a system has."""
    return "units" in _keys(path)


def other_file(path: Path) -> str:
    """Return a sentence on a scenario or swap file that is given as a system; "" for what is neither."""
    keys = set(_keys(path))
    if "units" in keys:
        return ""
    if "fmu" in keys:
        return f"{path}: is a swap file: 'evcosim run SYSTEM --swap UNIT={path}' puts its FMU in"
    if keys & {"stimulus", "event", "leave_out", "identification"}:
        return f"{path}: is a scenario: 'evcosim run SYSTEM --scenario {path}' runs a system in it"
    return ""


def _keys(path: Path) -> Iterable[str]:
    try:
        return parsed(content(path).decode("utf-8-sig"))
    except ValueError:  # the reader of the file says what is wrong
        return ()
