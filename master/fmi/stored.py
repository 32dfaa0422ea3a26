"""The descriptions of built-in FMUs, kept in the user's cache as JSON by the digest of the FMU's file.

FMPy, and the libraries with which it reads XML, take longer to be imported than a short run takes; of an FMU
that evcosim built, and read once, what they said is known. The entry is by the digests of what read it, too.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

from ..builtin import keep, kept

_READERS = ("archive", "attributes", "description", "fmu", "stored", "structure", "supplement", "types")
_REFERENCE = ""
"""The key of a table in JSON that stands for an object: its number."""


class Said(NamedTuple):
    """All that was read in an FMU's file, but for its path: the fields of `Fmu` have the same names."""

    description: Any
    entries: tuple[str, ...]
    unpacked: int
    defects: tuple[str, ...]
    negated: frozenset[str]
    sampled: frozenset[str] | None


def stored(digest: str) -> Said | None:
    """Return what was read in the FMU of a SHA-256, with plain objects in the place of FMPy's; None: nothing.

    They have the attributes that FMPy's had, but for its private ones.
    """
    content = kept(_entry(digest))
    return None if content is None else unpacked(content)


def store(digest: str, said: Said) -> Said:
    """Keep what was read, and return it as `stored` will; what JSON does not have is returned as it is.

    A cache that keeps nothing is told with the FMU.
    """
    try:
        content = packed(said)
    except TypeError:  # another FMPy's, which is read each time
        return said
    keep(_entry(digest), content)
    return unpacked(content)


def _entry(digest: str) -> str:
    return f"description-{digest[:32]}-{_of_readers()}"


@functools.cache
def _of_readers() -> str:
    """Return a digest of the modules that read descriptions: FMPy's, and those around it."""
    digest, found = hashlib.sha256(), importlib.util.find_spec("fmpy")  # which is not imported by it
    files = [Path(__file__).with_name(f"{name}.py") for name in _READERS]
    if found is not None and found.origin is not None:
        files.append(Path(found.origin).with_name("model_description.py"))
    for file in files:
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()[:16]


def packed(said: Said) -> bytes:
    """Return JSON: each object is a kind, of which the first one's texts and numbers are given, and changes.

    Raises TypeError for a value that JSON does not have.
    """
    objects: list[list[Any]] = []
    numbers: dict[int, int] = {}
    kinds: dict[str, int] = {}
    common: list[dict[str, Any]] = []

    def reference(value: Any) -> Any:
        if value is None or isinstance(value, bool | int | float | str):
            return value
        if isinstance(value, list | tuple):
            return [reference(each) for each in value]
        if id(value) not in numbers:
            numbers[id(value)] = len(objects)
            objects.append(place := [])
            place += changes(value)
        return {_REFERENCE: numbers[id(value)]}

    def changes(value: Any) -> list[Any]:
        fields = {name: reference(each) for name, each in _attributes(value).items()}
        kind = kinds.setdefault(type(value).__name__ + repr(list(fields)), len(kinds))
        if kind == len(common):
            common.append({name: each for name, each in fields.items() if not isinstance(each, list | dict)})
        same = common[kind]
        return [kind, {n: each for n, each in fields.items() if n not in same or not _is(each, same[n])}]

    root = reference(said.description)
    sets = [None if names is None else sorted(names) for names in (said.negated, said.sampled)]
    whole = [common, objects, root, said.entries, said.unpacked, said.defects, *sets]
    return json.dumps(whole, separators=(",", ":")).encode()


def _attributes(value: Any) -> dict[str, Any]:
    """Return the attributes of an object of FMPy's, or of one that stands in its place."""
    if isinstance(value, SimpleNamespace):
        return vars(value)
    if not hasattr(value, "__attrs_attrs__"):
        raise TypeError(f"{type(value).__name__} is no part of a description")
    kind = type(value)
    names = [field.name for field in value.__attrs_attrs__]
    names += [name for name in vars(kind) if isinstance(getattr(kind, name), property)]
    return {name: getattr(value, name) for name in names if not name.startswith("_")}


def _is(value: Any, other: Any) -> bool:
    """Return True for the same value of the same type: 1 is not True, and -0.0 is not 0.0."""
    return type(value) is type(other) and repr(value) == repr(other)


def unpacked(content: bytes) -> Said:
    """Return what `packed` packed."""
    common, objects, root, entries, size, defects, negated, sampled = json.loads(content)
    made = [SimpleNamespace() for _ in objects]

    def value(of: Any) -> Any:
        if isinstance(of, list):
            return [value(each) for each in of]
        return made[of[_REFERENCE]] if isinstance(of, dict) else of

    for each, (kind, changes) in zip(made, objects, strict=True):
        fields = vars(each)
        fields.update(common[kind])
        for name, of in changes.items():
            fields[name] = value(of)
    names = None if sampled is None else frozenset(sampled)
    return Said(value(root), tuple(entries), size, tuple(defects), frozenset(negated), names)
