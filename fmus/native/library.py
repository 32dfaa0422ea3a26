"""A native FMU's library, called through the functions of FMI 2.0: as much of it as a comparison needs."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Self

from ...models.base import Model
from ..interface import exposed

_LOGGER = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
)
_ALLOCATE = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t)
_FREE = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
_FINISHED = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int)
_CO_SIMULATION = 1
_OK, _WARNING = 0, 1
_STORAGE = {"Real": ctypes.c_double, "Integer": ctypes.c_int32, "Boolean": ctypes.c_int32}


class _Callbacks(ctypes.Structure):
    _fields_ = [
        ("logger", _LOGGER),
        ("allocate", _ALLOCATE),
        ("free", _FREE),
        ("finished", _FINISHED),
        ("environment", ctypes.c_void_p),
    ]


class NativeUnit:
    """One instance of a native FMU in its library; `messages` are those that it has logged.

    Raises OSError for a file that is no library, RuntimeError where it makes no instance.
    """

    def __init__(self, library: Path, model: type[Model], token: str) -> None:
        self.messages: list[str] = []
        self._library = ctypes.CDLL(str(library))
        self._kinds = [_storage(v.type) for _, _, v in exposed(model)]
        functions = _LOGGER(self._log), _ALLOCATE(), _FREE(), _FINISHED()
        self._callbacks = _Callbacks(*functions, None)
        make = self._library.fmi2Instantiate
        make.restype = ctypes.c_void_p
        self._saved = ctypes.c_void_p()
        self._unit = ctypes.c_void_p(
            make(
                model.__name__.encode(),
                _CO_SIMULATION,
                token.encode(),
                b"",
                ctypes.byref(self._callbacks),
                0,
                1,
            )
        )
        if not self._unit:
            raise RuntimeError("; ".join(self.messages) or "fmi2Instantiate returned no instance")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._call("FreeFMUstate", ctypes.byref(self._saved))
        self._library.fmi2FreeInstance(self._unit)

    def start(self, time: float, values: dict[int, Any]) -> bool:
        """Set the start time [s] and values by reference, and initialize; False where it is refused."""
        arguments = (0, ctypes.c_double(0.0), ctypes.c_double(time), 0, ctypes.c_double(0.0))
        return (
            self._call("SetupExperiment", *arguments)
            and self.set(values)
            and self._call("EnterInitializationMode")
            and self._call("ExitInitializationMode")
        )

    def reset(self) -> bool:
        """Go back to the start values (fmi2Reset)."""
        return self._call("Reset")

    def step(self, time: float, dt: float) -> bool:
        """Take a step of dt at a time, both in s; False where it is discarded."""
        return self._call("DoStep", ctypes.c_double(time), ctypes.c_double(dt), 1)

    def save(self) -> bool:
        """Save the state, in place of an earlier one (fmi2GetFMUstate); False where that is refused."""
        return self._call("GetFMUstate", ctypes.byref(self._saved))

    def restore(self, through_bytes: bool) -> bool:
        """Go back to the saved state, or to what its bytes make of it; False where that is refused."""
        if not through_bytes:
            return self._call("SetFMUstate", self._saved)
        size, other = ctypes.c_size_t(), ctypes.c_void_p()
        if not self._call("SerializedFMUstateSize", self._saved, ctypes.byref(size)):
            return False
        data = ctypes.create_string_buffer(size.value)
        restored = (
            self._call("SerializeFMUstate", self._saved, data, size)
            and self._call("DeSerializeFMUstate", data, size, ctypes.byref(other))
            and self._call("SetFMUstate", other)
        )
        return self._call("FreeFMUstate", ctypes.byref(other)) and restored

    def set(self, values: dict[int, Any]) -> bool:
        """Set values by reference; False where one is refused."""
        for kind, c_type in _STORAGE.items():
            references = [r for r in values if self._kinds[r] == kind]
            if references and not self._values(
                f"Set{kind}", c_type, references, [values[r] for r in references]
            ):
                return False
        return True

    def get(self, references: Sequence[int]) -> list[Any]:
        """Return the values of references, in their order. Raises RuntimeError that says why it fails."""
        found: dict[int, Any] = {}
        for kind, c_type in _STORAGE.items():
            wanted = [r for r in references if self._kinds[r] == kind]
            if wanted:
                values = self._values(f"Get{kind}", c_type, wanted, [0] * len(wanted))
                if not values:
                    raise RuntimeError(self.messages[-1] if self.messages else f"fmi2Get{kind} failed")
                found.update(zip(wanted, values, strict=True))
        return [bool(found[r]) if self._kinds[r] == "Boolean" else found[r] for r in references]

    def _values(self, call: str, c_type: Any, references: list[int], values: list[Any]) -> list[Any]:
        count = len(references)
        numbers = (c_type * count)(*values)
        if not self._call(call, (ctypes.c_uint32 * count)(*references), ctypes.c_size_t(count), numbers):
            return []
        return list(numbers)

    def _call(self, name: str, *arguments: Any) -> bool:
        return getattr(self._library, f"fmi2{name}")(self._unit, *arguments) in (_OK, _WARNING)

    def _log(self, environment: int, name: bytes, status: int, category: bytes, message: bytes) -> None:
        # a message is a format of printf, and no arguments are passed
        self.messages.append(message.decode("utf-8", "replace").replace("%%", "%"))


def _storage(kind: str) -> str:
    return "Integer" if kind == "Enumeration" else kind
