"""FMPy's validator of a model description, with a check of the names that takes linear time.

FMPy checks each structured name with a general parser: 10 ms a name, minutes for the FMU of a whole vehicle.
Here a regular expression accepts the same names, those that FMPy reads more leniently than FMI among them:

    name       = identifier | "der(" identifier ["," digits] ")"
    identifier = part {"." part}
    part       = (letter {letter | digit} | quoted) ["[" digits {"," digits} "]"]
    quoted     = "'" (character | escape) {character | escape} "'"
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from .archive import entries_of, read_entry
from .description import from_a_readable_folder, no_collection, parsed_xml

_BASIC = r"[A-Za-z_][A-Za-z_0-9]*"
_IN_QUOTES = r"""[A-Za-z_0-9!#$%&()*+,\-./:;<>=?@[\]^{}|~ "\\\n\r\t\f]|\\'"""
_PART = rf"(?:{_BASIC}|'(?:{_IN_QUOTES})+')(?:\[[0-9]+(?:,[0-9]+)*\])?"
_IDENTIFIER = rf"{_PART}(?:\.{_PART})*"
_NAME = re.compile(rf"{_IDENTIFIER}|der\({_IDENTIFIER}(?:,[0-9]+)?\)")
_FLAT_FORBIDS = {"\r": "carriage return", "\n": "line feed", "\t": "tab"}
_OF_SCHEMA = re.compile(r"[A-Z_]+ \(line \d+, column \d+\): ")


def is_structured_name(name: str) -> bool:
    """Return True for a name that the naming convention "structured" allows."""
    return _NAME.fullmatch(name) is not None


def validated(path: Path) -> list[str]:
    """Return what FMPy's validator finds in an FMU's description as it is in the file, one message each.

    As there, nothing else is looked at where the XML does not follow its schema.
    """
    from fmpy.model_description import ValidationError, read_model_description

    problems: list[str] = []
    try:
        file = str(path.absolute())
        with no_collection(), from_a_readable_folder():
            read_model_description(file, validate=True, validate_model_structure=True)
    except ValidationError as error:
        problems = error.problems
        if problems and _OF_SCHEMA.match(problems[0]):
            return problems
    except Exception as error:  # FMPy raises five unrelated types for broken descriptions
        return [str(error)]
    return [*_illegal_names(path), *problems] or _backslashes(path)


def _illegal_names(path: Path) -> Iterator[str]:
    root = parsed_xml(str(path), read_entry(path, "modelDescription.xml"))
    check = _flat if root.get("variableNamingConvention", "flat") == "flat" else _structured
    variables = [v for v in root.find("ModelVariables") if v.get("name") is not None]
    for variable in variables:
        yield from check(variable.get("name"), variable.sourceline)
    for variable in variables:
        for alias in variable.findall("Alias"):  # of FMI 3.0
            yield from check(alias.get("name", ""), variable.sourceline)


def _structured(name: str, line: int) -> Iterator[str]:
    if not is_structured_name(name):
        yield f'"{name}" (line {line}) is not a legal variable name for naming convention "structured".'


def _flat(name: str, line: int) -> Iterator[str]:
    for character, word in _FLAT_FORBIDS.items():
        if character in name:
            yield f'Variable "{name}" (line {line}) contains an illegal {word} character.'


def _backslashes(path: Path) -> list[str]:
    names = [entry.orig_filename for entry in entries_of(path)]
    return [f'The file path "{name}" contains a backslash.' for name in names if "\\" in name]
