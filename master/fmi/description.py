"""Reading modelDescription.xml: nothing is expanded or fetched, and small defects are mended and reported.

FMPy reads the description of every FMI version, but raises unrelated errors for the small defects that the
descriptions of real tools have. A defect that has one sensible reading is mended before, and becomes a
sentence that says what was assumed; any other is a FmuError.
"""

from __future__ import annotations

import contextlib
import gc
import io
import os
import re
import zipfile
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

from ...cosim.errors import short
from .archive import FmuError
from .attributes import mend_attributes, wrong_counts
from .structure import mend_structure
from .supplement import negated_aliases, sampled_outputs, supplement
from .types import INTEGER, REAL, FmiType, Kind, fmi_type

_VERSIONS = ("1.0", "2.0", "3.0")
_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def read_description(
    path: Path, xml: bytes
) -> tuple[Any, tuple[str, ...], frozenset[str], frozenset[str] | None]:
    """Return FMPy's ModelDescription, the defects that were mended, the negated aliases, the sampled outputs.

    Raises FmuError that names the place.
    """
    from fmpy.model_description import read_model_description

    root = _parsed(path, xml)
    with no_collection():
        defects = _mend(path, root)
        from lxml import etree

        packed = io.BytesIO()  # FMPy reads from archives
        with zipfile.ZipFile(packed, "w") as archive:
            archive.writestr("modelDescription.xml", etree.tostring(root))
        try:
            with from_a_readable_folder():
                description = read_model_description(packed, validate=False)
        except Exception as error:  # FMPy raises five unrelated types for broken descriptions
            raise FmuError(f"{path}: modelDescription.xml cannot be read: {error}") from error
    supplement(description, root)
    return description, tuple(defects), negated_aliases(root), sampled_outputs(root)


@contextlib.contextmanager
def no_collection() -> Iterator[None]:
    """Hold the garbage collector, which takes a third of the time to make 100,000 variables that stay."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@contextlib.contextmanager
def from_a_readable_folder() -> Iterator[None]:
    """Leave a working folder whose name is no UTF-8: lxml refuses to parse there whatever it is given."""
    here = os.getcwd()
    try:
        here.encode()
    except UnicodeEncodeError:
        os.chdir("/")
        try:
            yield
        finally:
            os.chdir(here)
    else:
        yield


def parsed_xml(place: str, xml: bytes) -> Any:
    """Return the root of a document of an FMU. Raises FmuError that begins with `place`."""
    from lxml import etree

    # in UTF-16 too: no description needs a document type, and entities are how XML reads files and explodes
    if b"<!DOCTYPE" in xml.replace(b"\0", b"") or b"<!ENTITY" in xml.replace(b"\0", b""):
        raise FmuError(
            f"{place} has a document type (<!DOCTYPE), which may read files and expand without end"
        )
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        return etree.fromstring(xml, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        raise FmuError(f"{place} is no well-formed XML: {error}") from error


def _parsed(path: Path, xml: bytes) -> Any:
    place = f"{path}: modelDescription.xml"
    root = parsed_xml(place, xml)
    if root.tag != "fmiModelDescription":
        raise FmuError(f"{place} begins with <{root.tag}>, not with <fmiModelDescription>")
    version = root.get("fmiVersion")
    if version not in _VERSIONS and not (version or "").startswith("3."):
        raise FmuError(f"{place}: fmiVersion is {version!r}; {', '.join(_VERSIONS)} are supported")
    if root.find("ModelVariables") is None:
        raise FmuError(f"{place} has no <ModelVariables>")
    _check_identifiers(place, root)
    _check_counts(place, root)
    return root


def _check_identifiers(place: str, root: Any) -> None:
    """Raise FmuError for a modelIdentifier that can name no file beside others: it names the library."""
    for kind in _identified(root):
        name = kind.get("modelIdentifier")
        if name is None and (kind is not root or root.get("fmiVersion") == "1.0"):
            raise FmuError(f"{place}: <{kind.tag}> has no modelIdentifier")
        if name is not None and not (_PLAIN.fullmatch(name) or _names_a_file(name)):
            raise FmuError(
                f"{place}: modelIdentifier is {name!r}, which is no plain name (letters, digits, _)"
            )


def _identified(root: Any) -> list[Any]:
    """Return the elements that have a modelIdentifier: the root in FMI 1.0, else those of the interfaces."""
    kinds = (root.find(kind) for kind in ("CoSimulation", "ModelExchange", "ScheduledExecution"))
    return [root, *(kind for kind in kinds if kind is not None)]


def _names_a_file(identifier: str) -> bool:
    """Return True for what names a file in the folder of libraries and no other place, in every system."""
    odd = set('/\\:*?"<>|')
    return identifier.isprintable() and identifier[:1].isalnum() and not odd.intersection(identifier)


def _odd_identifiers(root: Any) -> list[str]:
    """Return what is said of each modelIdentifier that is no name in C; tools that need none take any."""
    names = dict.fromkeys(element.get("modelIdentifier") for element in _identified(root))
    return [
        f"modelIdentifier is '{name}', which is no plain name (letters, digits, _); it is taken as it is"
        for name in names
        if name is not None and not _PLAIN.fullmatch(name)
    ]


def _check_counts(place: str, root: Any) -> None:
    """Raise FmuError for a wrong count of states or event indicators where there is Model Exchange alone."""
    if root.find("CoSimulation" if root.get("fmiVersion") != "1.0" else "Implementation") is not None:
        return
    for name in wrong_counts(root):
        raise FmuError(f"{place}: {name} = {root.get(name)!r} is no number, and Model Exchange needs it")
    if root.get("fmiVersion") == "1.0" and root.get("numberOfContinuousStates") is None:
        raise FmuError(f"{place} has no numberOfContinuousStates, and Model Exchange needs it")


def _mend(path: Path, root: Any) -> list[str]:
    defects: list[str] = []
    variables = [v for v in root.find("ModelVariables") if isinstance(v.tag, str)]
    places: dict[int, int] = {}
    version = root.get("fmiVersion")
    scalar = version[0] in "12"
    types = {t.get("name") for t in root.iter("SimpleType", "Type")}
    types |= {t.get("name") for t in root.findall("TypeDefinitions/*")}
    seen: dict[str, tuple[int, Any]] = {}
    for index, v in enumerate(variables, 1):
        value = next((c for c in v if fmi_type(version, c.tag) is not None), None) if scalar else v
        name = v.get("name")
        if name is None or value is None:
            v.getparent().remove(v)
            defects.append(
                f"line {v.sourceline}: a variable without {'a type' if name else 'a name'} is left out"
            )
            continue
        if name in seen and _alike(v, seen[name][1]):
            places[index] = places[seen[name][0]]
            v.getparent().remove(v)
            defects.append(_said_twice(v, seen[name][1]))
            continue
        places[index] = len(seen) + 1
        _require(path, v, name, seen)
        seen[name] = index, v
        defects += _mend_variable(v, value, name, types, fmi_type(version, value.tag))
    return _odd_identifiers(root) + defects + mend_attributes(root) + mend_structure(root, places)


def _alike(v: Any, first: Any) -> bool:
    """Return True if two declarations of one name differ in their value references at most."""

    def content(element: Any, *without: str) -> Any:
        own = {key: value for key, value in element.attrib.items() if key not in without}
        return element.tag, own, (element.text or "").strip(), [content(child) for child in element]

    return bool(content(v, "valueReference") == content(first, "valueReference"))


def _said_twice(v: Any, first: Any) -> str:
    one, other = (element.get("valueReference") for element in (first, v))
    taken = "" if one == other else f"; that with valueReference {one} is taken, {other} is left out"
    lines = f"lines {first.sourceline} and {v.sourceline}"
    return f"{v.get('name')}: declared twice alike, in {lines}{taken}"


def _require(path: Path, v: Any, name: str, seen: Collection[str]) -> None:
    place = f"{path}: modelDescription.xml: variable '{name}' (line {v.sourceline})"
    if name in seen:
        raise FmuError(f"{place} is declared twice")
    reference = (v.get("valueReference") or "").strip()
    if not re.fullmatch(r"\d{1,100}", reference) or int(reference) >= 2**32:
        given = short(v.get("valueReference"))
        raise FmuError(f"{place} has valueReference {given}; a whole number from 0 to 2^32 - 1 is needed")


def _mend_variable(v: Any, value: Any, name: str, types: set[str | None], kind: FmiType | None) -> list[str]:
    """Mend the attributes of a variable `v` and of its type's element `value`, which in FMI 3.0 are one."""
    defects = []
    v.set("valueReference", v.get("valueReference").strip())
    declared = value.get("declaredType")
    if declared is not None and declared not in types:
        del value.attrib["declaredType"]
        defects.append(f"{name}: declaredType '{declared}' is not defined; it is ignored")
    if kind is not None and not v.findall("Dimension"):
        defects += _mend_values(value, name, kind.kind)
    if (wrong := _illegal_variability(v)) is not None:
        causality = v.get("causality", "local")
        assumed = _ALLOWED[causality][0]
        v.set("variability", assumed)
        defects.append(
            f"{name}: a {causality} of variability '{wrong}' is not allowed; '{assumed}' is assumed"
        )
    return defects


def _mend_values(value: Any, name: str, kind: Kind) -> list[str]:
    """Leave out what is no value of a type; a start value outside of its limits is reported, and stays."""
    defects = []
    for attribute in ("start", "min", "max"):
        given = value.get(attribute)
        if given is not None and not kind.reads(given):
            del value.attrib[attribute]
            defects.append(f"{name}: {attribute} = {given!r} is no {value.tag}; it is ignored")
    return defects + (_contradictions(value, name) if kind in (REAL, INTEGER) else [])


def _contradictions(value: Any, name: str) -> list[str]:
    """Leave out limits where the minimum is above the maximum, and report a start value beyond one."""
    low, high, start = (None if (x := value.get(a)) is None else float(x) for a in ("min", "max", "start"))
    if low is not None and high is not None and low > high:
        del value.attrib["min"], value.attrib["max"]
        return [f"{name}: min = {low:g} is above max = {high:g}; both are ignored"]
    if start is not None and low is not None and start < low:
        return [f"{name}: start = {start:g} is below min = {low:g}"]
    if start is not None and high is not None and start > high:
        return [f"{name}: start = {start:g} is above max = {high:g}"]
    return []


_ALLOWED = {
    "parameter": ("fixed", "tunable"), "calculatedParameter": ("fixed", "tunable"),
    "structuralParameter": ("fixed", "tunable"), "input": ("discrete", "continuous"),
    "output": ("constant", "discrete", "continuous"), "independent": ("continuous",),
}  # fmt: skip # a table: section 2.2.7 of FMI 2.0, 2.4.7.4 of FMI 3.0


def _illegal_variability(v: Any) -> str | None:
    """Return a variability, given or by default, that this causality cannot have; None where all is well."""
    version = v.getroottree().getroot().get("fmiVersion")
    variability: str | None = v.get("variability", "continuous" if version == "2.0" else None)
    allowed = _ALLOWED.get(v.get("causality", "local"))
    if version == "1.0" or variability is None or allowed is None or variability in allowed:
        return None
    return variability
