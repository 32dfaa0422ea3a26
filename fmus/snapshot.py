"""The state of an FMU, and its form as bytes: the FMU's identity on one line, then a pickle.

A pickle is lossless for every float and for whatever a State record holds. The bytes may come from anywhere,
so only data can be loaded: records and enumerations of this FMU's own package, and numpy arrays.
"""

from __future__ import annotations

import enum
import io
import pickle
from typing import Any, ClassVar, NamedTuple

from .messages import Refused

_PACKAGE = __name__.partition(".")[0]


class Snapshot(NamedTuple):
    """Everything that distinguishes two instances of one FMU.

    `values` are those of the parameters (from which their record is rebuilt), inputs and outputs, and the
    time. `started` and `stale` are the flags of the slave.
    """

    values: tuple[tuple[Any, ...], tuple[Any, ...], tuple[Any, ...], float]
    state: Any
    started: bool
    stale: bool


def to_bytes(snapshot: Snapshot, identity: str) -> bytes:
    """Return a snapshot as bytes, equal for equal snapshots. Raises the errors of pickle."""
    stream = io.BytesIO()
    _Pickler(stream, protocol=4).dump(tuple(snapshot))
    return _stamp(identity) + stream.getvalue()


def from_bytes(data: bytes, identity: str) -> Snapshot:
    """Return the snapshot from bytes of `to_bytes`. Raises Refused for bytes of another FMU or of code."""
    stamp = _stamp(identity)
    if not data.startswith(stamp):
        found = data[: len(stamp)].partition(b"\n")[0].decode("ascii", "replace")
        raise Refused(f"these bytes are a state of {found!r}, this FMU is {identity!r}")
    return Snapshot(*_Unpickler(io.BytesIO(data[len(stamp) :])).load())


def _stamp(identity: str) -> bytes:
    return f"{identity}\n".encode("ascii")


class _Pickler(pickle.Pickler):
    """Writes an item of an enumeration as a call of its class, in every version of Python.

    3.11.0 to 3.11.3 would write a call of `getattr`, which is not loaded.
    """

    def reducer_override(self, obj: Any) -> Any:
        """Return class and value of an item of an enumeration; leave any other object to pickle."""
        return (type(obj), (obj.value,)) if isinstance(obj, enum.Enum) else NotImplemented


class _Unpickler(pickle.Unpickler):
    """Loads records and enumerations of this FMU's own package and numpy arrays, nothing that could act."""

    _NUMPY: ClassVar = {"_reconstruct", "_frombuffer", "scalar", "ndarray", "dtype"}

    def find_class(self, module: str, name: str) -> Any:
        """Return a class that may be loaded. Raises Refused for any other."""
        if module.split(".")[0] == "numpy" and name in self._NUMPY:
            return super().find_class(module, name)
        if module.split(".")[0] == _PACKAGE:
            found = super().find_class(module, name)
            if isinstance(found, type) and found.__module__ == module and _is_data(found):
                return found
        raise Refused(f"a state of this FMU does not contain {module}.{name}")


def _is_data(cls: type) -> bool:
    return hasattr(cls, "__dataclass_fields__") or issubclass(cls, enum.Enum)
