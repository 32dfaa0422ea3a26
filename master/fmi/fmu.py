"""FMU files: reading the description, extracting the archive, and the interface that a plan is made of."""

from __future__ import annotations

import contextlib
import contextvars
import dataclasses
import functools
import hashlib
import math
import os
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...cosim.archive import archive_limits
from ...cosim.errors import counted, nearest
from ...cosim.interface import InterfaceType, UnitInterface, VariableInfo
from ...cosim.units.measure import BASE_UNITS, UnitOfMeasure
from ..builtin import held_digest, looking_once, state_of
from .archive import FmuError, entries_of, extract, read_entry
from .binary import SUFFIX, folder_of_libraries
from .description import read_description
from .stored import Said, store, stored
from .types import BOOLEAN, ENUMERATION, INTEGER, REAL, STRING, FmiType, fmi_type

__all__ = ["Fmu", "FmuError", "check_runnable", "is_true", "read_fmu"]

_DESCRIPTION = "modelDescription.xml"
_SHOWN_DEFECTS = 5
_MOST_STATES, _MOST_INDICATORS = 20_000, 1_000_000  # a Jacobian of 3 GB


@dataclasses.dataclass(frozen=True)
class Fmu:
    """An FMU file that was read: `description` is FMPy's ModelDescription.

    `entries` are the names in the archive, `unpacked` their bytes in all; `defects` are those of the
    description that were tolerated, one sentence each with what was assumed;
    `negated` are the variables of FMI 1.0 whose value is that of their reference with the other sign;
    `sampled` are the outputs that evcosim's annotation calls so (None: there is none);
    `wanted` is the interface to use, where it is not the default (see `using`); `sha256` is that of a
    file of the cache, which is as its record says; "": it is read to be known.
    """

    path: Path
    description: Any
    entries: tuple[str, ...]
    unpacked: int = 0
    defects: tuple[str, ...] = ()
    negated: frozenset[str] = frozenset()
    sampled: frozenset[str] | None = None
    wanted: InterfaceType | None = None
    sha256: str = ""

    def using(self, interface: InterfaceType | None) -> Fmu:
        """Return the FMU by this interface (None: Co-Simulation where there is one, else Model Exchange).

        Raises FmuError when it does not have it.
        """
        md = self.description
        kind = {"co_simulation": md.coSimulation, "model_exchange": md.modelExchange}
        if interface is not None and kind[interface] is None:
            raise FmuError(f'{self.path}: interface = "{interface}": it has no such interface')
        return self if interface == self.wanted else dataclasses.replace(self, wanted=interface)

    @functools.cached_property
    def digest(self) -> str:
        """SHA-256 of the file."""
        return self.sha256 or hashlib.sha256(self.path.read_bytes()).hexdigest()

    @functools.cached_property
    def interface(self) -> UnitInterface:
        """The variables and units of measure, as a plan needs them. Raises FmuError for malformed numbers."""
        try:
            return _interface(self)
        except ValueError as error:
            raise FmuError(f"{self.path}: modelDescription.xml: {error}") from error

    @property
    def platforms(self) -> tuple[str, ...]:
        """The platforms that the FMU has binaries for, in FMI 2.0 names (linux64, win64, ...)."""
        found = {e.split("/")[1] for e in self.entries if e.startswith("binaries/") and e.count("/") == 2}
        return tuple(sorted(found - {""}))

    @property
    def binary(self) -> str:
        """The entry of the library for this machine, which need not be there."""
        folder = folder_of_libraries(self.description.fmiVersion)
        return f"binaries/{folder}/{self.kind.modelIdentifier}{SUFFIX}"

    @property
    def interface_type(self) -> InterfaceType:
        """The interface that is used. Raises FmuError for an FMU that has none of the two."""
        md = self.description
        if md.coSimulation is None and md.modelExchange is None:
            raise FmuError(f"{self.path}: has neither a Co-Simulation nor a Model Exchange interface")
        return self.wanted or ("model_exchange" if md.coSimulation is None else "co_simulation")

    @property
    def kind(self) -> Any:
        """FMPy's CoSimulation or ModelExchange of the interface that is used. Raises FmuError."""
        md = self.description
        return md.coSimulation if self.interface_type == "co_simulation" else md.modelExchange

    @property
    def c_sources(self) -> tuple[str, ...]:
        """The entries that are C sources."""
        return tuple(e for e in self.entries if e.startswith("sources/") and e.endswith(".c"))

    @property
    def holds_python(self) -> bool:
        """True of an FMU made with pythonfmu, whose steps run in this process's interpreter."""
        return "resources/slavemodule.txt" in self.entries

    def extract(self) -> Path:
        """Extract into a new temporary folder, which the caller removes."""
        return extract(self.path)

    def resources_uri(self, folder: Path) -> bytes:
        """Return the URI of the resources in an extracted folder, as the library takes it.

        That of pythonfmu decodes %20 and nothing else, and without its resources it ends the process: it gets
        the other characters as they are. Raises FmuError for a folder that no such URI names.
        """
        resources = folder / "resources"
        if not self.holds_python or sys.platform == "win32":
            return resources.as_uri().encode()
        path = os.fsencode(resources)
        try:
            problem = "'%20' in its name is read as a space" if "%20" in path.decode() else ""
        except UnicodeDecodeError:
            problem = "its name is not UTF-8"
        if problem:
            raise FmuError(
                f"{self.path}: cannot run from the temporary folder {folder}: {problem}; set TMPDIR"
            )
        return b"file://" + path.replace(b" ", b"%20")


_once: contextvars.ContextVar[dict[str, Fmu] | None] = contextvars.ContextVar("read FMUs", default=None)


@contextlib.contextmanager
def reading_once() -> Iterator[None]:
    """Within the `with` block each FMU is looked for and read once, however many units have it."""
    token = _once.set({} if (known := _once.get()) is None else known)
    try:
        with looking_once():
            yield
    finally:
        _once.reset(token)


def read_fmu(path: Path, strict: bool = False) -> Fmu:
    """Read an FMU's description. Raises FmuError when it is none, or is damaged.

    A tolerable defect is kept in `Fmu.defects`; with `strict` it is a FmuError too.
    """
    known, place = _once.get(), os.path.realpath(path)
    fmu = (known or {}).get(place)
    if fmu is None:
        fmu = _unless_written(path, place)
        if known is not None:
            known[place] = fmu
    if strict and fmu.defects:
        said = "; ".join(fmu.defects[:_SHOWN_DEFECTS])
        raise FmuError(f"{path}: strict: {counted(len(fmu.defects), 'defect')}: {said}")
    return fmu if fmu.path == path else dataclasses.replace(fmu, path=path)


_kept: dict[str, tuple[object, Fmu]] = {}
"""FMUs that this process has read, with the states of their files and the limits then; the last one last."""
_MOST_KEPT = 32
_keeping = threading.Lock()


def _unless_written(path: Path, place: str) -> Fmu:
    """Read an FMU, unless its file is as it was when it was read; `place` is its path without links."""
    try:
        settled_in = state_of(place)
    except OSError:  # reading says what is wrong
        settled_in = None
    state, (before, fmu) = (settled_in, archive_limits()), _kept.pop(place, (None, None))
    if fmu is None or settled_in is None or before != state:
        fmu = _read(path)
    if settled_in is not None:
        with _keeping:
            _kept[place] = state, fmu
            if len(_kept) > _MOST_KEPT:
                del _kept[next(iter(_kept))]
    return fmu


def _read(path: Path) -> Fmu:
    """Read an FMU; one that evcosim built and has read before is known by its digest."""
    digest = held_digest(path)
    said = stored(digest) if digest else None
    if said is None:
        said = _said(path)
        if digest:
            said = store(digest, said)
    return Fmu(path, *said, sha256=digest)


def _said(path: Path) -> Said:
    entries = entries_of(path)
    names = tuple(entry.filename for entry in entries)
    if _DESCRIPTION not in names:
        raise FmuError(f"{path}: is not an FMU: it has no {_DESCRIPTION}{_elsewhere(names)}")
    description, defects, negated, sampled = read_description(path, read_entry(path, _DESCRIPTION))
    if any("\\" in entry.orig_filename for entry in entries):
        defects = ("the archive separates folders with '\\'; they are taken as folders", *defects)
    size = sum(entry.file_size for entry in entries)
    return Said(description, names, size, defects, negated, sampled)


def _elsewhere(names: tuple[str, ...]) -> str:
    """Return a clause that names the place where the description stands instead."""
    deeper = next((n for n in names if n.endswith(f"/{_DESCRIPTION}")), None)
    if deeper is not None:
        folder = deeper.removesuffix(_DESCRIPTION)
        return f"; there is one in '{folder}': zip the content of that folder, not the folder"
    return nearest(_DESCRIPTION, names)


def check_runnable(fmu: Fmu) -> None:
    """Raise FmuError unless this master can run the FMU on this machine."""
    if fmu.interface_type == "model_exchange":
        _check_size(fmu)
    if fmu.binary not in fmu.entries:
        compile_it = f"; it has its sources: evcosim compile {fmu.path}" if fmu.c_sources else ""
        raise FmuError(
            f"{fmu.path}: has no binary for this machine: {fmu.binary} is missing; it has binaries for "
            f"{', '.join(fmu.platforms) or 'no platform'}{compile_it}"
        )


def _check_size(fmu: Fmu) -> None:
    """Raise FmuError for more states than the solver has room for: its Jacobian holds their square."""
    md = fmu.description
    for what, count, most in (
        ("continuous states", md.numberOfContinuousStates, _MOST_STATES),
        ("event indicators", md.numberOfEventIndicators, _MOST_INDICATORS),
    ):
        if int(count or 0) > most:
            raise FmuError(f"{fmu.path}: has {count} {what}; Model Exchange solves {most:,} at most")


def is_true(kind: Any, capability: str) -> bool:
    """Return True if an interface (`Fmu.kind`) declares a capability; FMPy leaves some as text."""
    return str(getattr(kind, capability, None)).strip().lower() in ("true", "1")


def declared_number(part: Any, name: str) -> float | None:
    """Return a number that a part of a description declares; None for none, and for one that is not finite.

    FMPy leaves most of them as text.
    """
    try:
        value = float(str(getattr(part, name, None)))
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def declared_step(part: Any, name: str) -> float | None:
    """Return a step size [s] that a part of a description declares; None for none, and for what is none."""
    step = declared_number(part, name)
    return step if step is not None and step > 0.0 else None


def _interface(fmu: Fmu) -> UnitInterface:
    md = fmu.description
    depends = {u.variable.name: _names(u.dependencies) for u in md.outputs}
    initially = {u.variable.name: _names(u.dependencies) for u in md.initialUnknowns}
    unusable = _unusable(fmu)
    variables = {
        v.name: _variable(v, kind, depends, initially, v.name in fmu.negated)
        for v in md.modelVariables
        if v.name not in unusable and (kind := fmi_type(md.fmiVersion, str(v.type))) is not None
    }
    units = {u.name: _unit_of_measure(u) for u in md.unitDefinitions}
    for name in (fmu.sampled or frozenset()) & variables.keys():
        variables[name] = dataclasses.replace(variables[name], sampled=True)
    ours = str(md.generationTool or "").startswith("evcosim ")
    return UnitInterface(str(fmu.path), variables, units, unusable, fmu.sampled is not None, ours)


def _names(variables: Any) -> tuple[str, ...] | None:
    return None if variables is None else tuple(v.name for v in variables)


def _unusable(fmu: Fmu) -> dict[str, str]:
    """Return the variables that cannot be used, with the reason."""
    found: dict[str, str] = {}
    inputs: dict[tuple[str, int], str] = {}
    version = fmu.description.fmiVersion
    shared = version.startswith("3")  # all types share the value references
    for v in fmu.description.modelVariables:
        kind = fmi_type(version, str(v.type))
        reason = _why_unusable(v, kind, v.name in fmu.negated)
        if kind is not None and not reason and v.causality == "input":
            of = "" if shared else kind.accessed
            first = inputs.setdefault((of, int(v.valueReference)), v.name)
            reason = f"is an alias of the input {first}: connect that one" if first != v.name else ""
        if reason:
            found[v.name] = reason
    return found


def _why_unusable(v: Any, kind: FmiType | None, negated: bool) -> str:
    """Return the reason why a variable cannot be used; "" for one that can."""
    if negated and (kind is None or kind.kind not in (REAL, INTEGER)):
        return f"is a negated alias of type {v.type}, which is not supported"
    if v.clocks:
        return "belongs to a clock; clocks are not supported"
    if v.dimensions:
        size = ", ".join(str(n) for n in v.shape or ())
        return f"is an array, {v.type}[{size}]; arrays are not supported"
    return "" if kind is not None else f"is of type {v.type}, which is not supported"


def _variable(
    v: Any, fmi: FmiType, depends: dict[str, Any], initially: dict[str, Any], negated: bool
) -> VariableInfo:
    declared, kind = v.declaredType, fmi.kind
    items = (
        tuple((int(i.value), i.name) for i in (declared.items or ()))
        if kind is ENUMERATION and declared
        else ()
    )
    variability = v.variability or ("continuous" if kind is REAL else "discrete")
    if kind is not REAL and variability == "continuous":  # the default of FMI 2.0, but only a Real can be
        variability = "discrete"
    return VariableInfo(
        name=v.name,
        type=kind.name,
        causality=v.causality or "local",
        variability=variability,
        unit=_inherited(v, "unit") or "",
        start=None if v.start is None else kind.parse(v.start),
        min=_limit(_inherited(v, "min")),
        max=_limit(_inherited(v, "max")),
        description=v.description or "",
        items=items,
        limits=None if kind in (BOOLEAN, STRING) or math.isinf(fmi.high) else (fmi.low, fmi.high),
        depends=depends.get((v.alias or v).name, ()),
        depends_initially=initially.get((v.alias or v).name, ()),
        initial=v.initial or "",
        inverted=negated,
        difference=bool(_inherited(v, "relativeQuantity")),
    )


def _inherited(v: Any, attribute: str) -> Any:
    """Return an attribute of a variable, else of its declared type (FMI 2.0, section 2.2.3)."""
    own = getattr(v, attribute, None)
    return own if own is not None else getattr(v.declaredType, attribute, None)


def _limit(text: Any) -> float | None:
    return None if text is None else float(text)


def _unit_of_measure(unit: Any) -> UnitOfMeasure:
    base = unit.baseUnit
    if base is None:
        return UnitOfMeasure(unit.name)
    exponents = tuple(int(getattr(base, name) or 0) for name in BASE_UNITS)
    return UnitOfMeasure(unit.name, exponents, float(base.factor), float(base.offset))
