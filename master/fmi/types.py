"""The types of FMI 1.0, 2.0 and 3.0, one row each: their values, the C type of those, and their functions.

All that depends on a type stands here or follows from its row: the reader of descriptions, the transfers of
both engines and single values look types up by version and name. A type without a row is not supported.
"""

from __future__ import annotations

import ctypes
import dataclasses
import math
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...cosim.interface import Value

LARGEST_WHOLE = 2**53
"""Beyond it a double does not hold every whole number."""

_WHOLE = re.compile(r"[+-]?\d+")


@dataclasses.dataclass(frozen=True)
class Kind:
    """A type of the system, which is one of several FMI types: `name` as in `VariableInfo.type`.

    `reads` is true of a text from which `parse` makes a value; `parse` raises ValueError for any other.
    `from_c` makes a value of what ctypes gives; `zero` is the value of a variable without a start value.
    """

    name: str
    reads: Callable[[str], bool]
    parse: Callable[[Any], Value]
    from_c: Callable[[Any], Value]
    zero: Value


def _is_float(text: str) -> bool:
    try:
        return not math.isnan(float(text))
    except ValueError:
        return False


def _is_whole(text: str) -> bool:
    return _WHOLE.fullmatch(text.strip()) is not None


def _is_truth(text: str) -> bool:
    return text.strip().lower() in ("true", "false", "1", "0")


def _truth(text: Any) -> bool:
    return str(text).strip().lower() in ("true", "1")


def _decoded(text: bytes | None) -> str:
    return (text or b"").decode("utf-8", "replace")


REAL = Kind("Real", _is_float, float, float, 0.0)
INTEGER = Kind("Integer", _is_whole, int, int, 0)
ENUMERATION = Kind("Enumeration", _is_whole, int, int, 0)
BOOLEAN = Kind("Boolean", _is_truth, _truth, bool, False)
STRING = Kind("String", lambda _: True, str, _decoded, "")


@dataclasses.dataclass(frozen=True)
class FmiType:
    """A type of one or more versions of FMI.

    `versions` are their first digits; `accessed` is what the names of its get and set functions end with.
    `low` and `high` are the least and the greatest number that `c_type` holds.
    `code` stands for the C type in a buffer of the compiled kernel; 0: no step passes its values on.
    """

    name: str
    versions: str
    kind: Kind
    c_type: Any
    accessed: str
    low: float
    high: float
    code: int

    @property
    def wide(self) -> bool:
        """True of a type of whole numbers that a double does not all hold."""
        return self.kind is not REAL and self.high > LARGEST_WHOLE

    @property
    def doubles(self) -> tuple[float, float]:
        """The least and the greatest double that the type holds."""
        largest = float(self.high)
        return float(self.low), math.nextafter(largest, 0.0) if largest > self.high else largest


_codes: dict[tuple[Any, bool], int] = {}


def _type(name: str, versions: str, kind: Kind, c_type: Any, accessed: str = "") -> FmiType:
    low, high = _range(kind, c_type)
    code = 0 if kind is STRING else _codes.setdefault((c_type, kind is BOOLEAN), len(_codes) + 1)
    return FmiType(name, versions, kind, c_type, accessed or name, low, high, code)


def _range(kind: Kind, c_type: Any) -> tuple[float, float]:
    if kind in (BOOLEAN, STRING):
        return 0, 1
    if c_type is ctypes.c_double:
        return -math.inf, math.inf
    if c_type is ctypes.c_float:
        largest = (2.0 - 2.0**-23) * 2.0**127
        return -largest, largest
    bits = 8 * ctypes.sizeof(c_type)
    signed = c_type(-1).value < 0
    return (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)


TYPES = (
    _type("Real", "12", REAL, ctypes.c_double),
    _type("Integer", "12", INTEGER, ctypes.c_int),
    _type("Enumeration", "12", ENUMERATION, ctypes.c_int, "Integer"),
    _type("Boolean", "1", BOOLEAN, ctypes.c_byte),
    _type("Boolean", "2", BOOLEAN, ctypes.c_int),
    _type("String", "12", STRING, ctypes.c_char_p),
    _type("Float64", "3", REAL, ctypes.c_double),
    _type("Float32", "3", REAL, ctypes.c_float),
    _type("Int8", "3", INTEGER, ctypes.c_int8),
    _type("UInt8", "3", INTEGER, ctypes.c_uint8),
    _type("Int16", "3", INTEGER, ctypes.c_int16),
    _type("UInt16", "3", INTEGER, ctypes.c_uint16),
    _type("Int32", "3", INTEGER, ctypes.c_int32),
    _type("UInt32", "3", INTEGER, ctypes.c_uint32),
    _type("Int64", "3", INTEGER, ctypes.c_int64),
    _type("UInt64", "3", INTEGER, ctypes.c_uint64),
    _type("Enumeration", "3", ENUMERATION, ctypes.c_int64, "Int64"),
    _type("Boolean", "3", BOOLEAN, ctypes.c_bool),
    _type("String", "3", STRING, ctypes.c_char_p),
)
"""All types that are supported (FMI 2.0, section 2.1.2; FMI 3.0, section 2.2.2)."""

_by_name = {(version, t.name): t for t in TYPES for version in t.versions}


def fmi_type(version: str, name: str) -> FmiType | None:
    """Return the type of a name in a version of FMI ("2.0"); None: there is none, or it is not supported."""
    return _by_name.get((version[0], name))


BUFFERS = {t.code: t for t in TYPES if t.code}
"""A type for each code: those of one code differ in nothing that a buffer shows."""

REAL_CODES = tuple(sorted({t.code for t in TYPES if t.code and t.kind is REAL}))
WIDE_CODES = tuple(sorted({t.code for t in TYPES if t.code and t.wide}))
"""Codes for the compiled kernel: of real numbers, and of whole numbers that a double does not all hold."""
