"""The functions of fmus/native/c/python_arithmetic.h, compiled, and called from Python.

They are inline: a function that can be called is written for each of them, from what the headers declare. A
failure raises Python's exception of the name that it gives.
"""

from __future__ import annotations

import builtins
import ctypes
import functools
import re
import subprocess
import sys
import tempfile
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from support.needs import need_c_compiler

HEADERS = Path(__file__).parents[2] / "fmus" / "native" / "c"
PARTS = [HEADERS / f"python_{part}.h" for part in ("float", "integer", "math", "complex", "cmath", "text")]
_FUNCTION = re.compile(
    r"/\*(?P<comment>(?:(?!\*/).)*?)\*/\n(?:static inline|PY_COLD) (?P<returns>[\w ]+?[ *]+)(?P<name>py_\w+)"
    r"\((?P<arguments>[^)]*)\)\n\{",
    re.DOTALL,
)
TEXT_SIZE = 4096


class Complex(ctypes.Structure):
    """py_complex."""

    _fields_ = [("re", ctypes.c_double), ("im", ctypes.c_double)]


class Failure(ctypes.Structure):
    """py_failure."""

    _fields_ = [("code", ctypes.c_int), ("text", ctypes.c_char * 80)]


_TYPES: dict[str, Any] = {
    "double": ctypes.c_double,
    "int64_t": ctypes.c_int64,
    "int": ctypes.c_int,
    "bool": ctypes.c_bool,
    "size_t": ctypes.c_size_t,
    "const char *": ctypes.c_char_p,
    "char *": ctypes.c_char_p,
    "const double *": ctypes.POINTER(ctypes.c_double),
    "py_complex": Complex,
    "py_failure *": ctypes.POINTER(Failure),
}
_RESULTS = ("double *", "int64_t *", "bool *", "py_complex *")


class Function(NamedTuple):
    """A function as its header declares it."""

    name: str
    returns: str
    arguments: tuple[tuple[str, str], ...]
    comment: str


@functools.cache
def declared() -> dict[str, Function]:
    """Return all functions of the headers by name."""
    found = {}
    for path in PARTS:
        for match in _FUNCTION.finditer(path.read_text(encoding="utf-8")):
            arguments = tuple(
                (re.sub(r"\w+$", "", part).strip(), re.findall(r"\w+$", part)[0])
                for part in (" ".join(part.split()) for part in match["arguments"].split(","))
            )
            name = match["name"]
            found[name] = Function(name, match["returns"].strip(), arguments, match["comment"].strip())
    return found


def compile_source(source: str, output: Path, flags: Sequence[str] = (), compiler: str = "cc") -> None:
    """Compile a C source that includes the headers; the compiler's messages are an AssertionError."""
    command = [compiler, "-std=c99", "-ffp-contract=off", f"-I{HEADERS}", *flags, "-x", "c", "-"]
    command += ["-o", str(output), *([] if "-c" in flags else ["-lm"])]
    done = subprocess.run(command, input=source, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def _library(names: Collection[str], minor: int) -> ctypes.CDLL:
    """Return the functions of these names, under their names with `c` before them."""
    need_c_compiler()
    lines = ['#include "python_arithmetic.h"']
    for function in (declared()[name] for name in names):
        taken = ", ".join(f"{kind} {word}" for kind, word in function.arguments)
        head = f"{function.returns} c{function.name}({taken})"
        given = ", ".join(word for _, word in function.arguments)
        lines += [f"{head};", f"{head} {{ return {function.name}({given}); }}"]
    lines.append("const char *cpy_exception(int code) { return py_exception((py_failure_code)code); }")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "arithmetic.so")
        flags = ("-O2", "-fPIC", "-shared", f"-DPY_VERSION_MINOR={minor}")
        compile_source("\n".join(lines), path, flags)
        loaded = ctypes.CDLL(str(path))
    loaded.cpy_exception.restype = ctypes.c_char_p
    for function in (declared()[name] for name in names):
        called = getattr(loaded, f"c{function.name}")
        called.restype = _TYPES[function.returns]
        called.argtypes = [
            ctypes.POINTER(_TYPES[kind.removesuffix(" *")]) if kind in _RESULTS else _TYPES[kind]
            for kind, _ in function.arguments
        ]
    return loaded


def _given(kind: str, value: Any) -> Any:
    """Return a value as an argument of C."""
    if kind == "py_complex":
        return Complex(value.real, value.imag)
    if kind == "const double *":
        return (ctypes.c_double * max(1, len(value)))(*value)
    return value.encode() if kind == "const char *" else value


def _taken(value: Any) -> Any:
    """Return a result of C as a value of Python."""
    if isinstance(value, Complex):
        return complex(value.re, value.im)
    if isinstance(value, bytes):
        return value.decode()
    return value.value if isinstance(value, ctypes._SimpleCData) else value


class Arithmetic:
    """The functions of these names, compiled for Python 3.`minor`."""

    def __init__(self, names: Collection[str], minor: int = sys.version_info.minor) -> None:
        self._library = _library(names, minor)

    def __call__(self, name: str, *values: Any, size: int = TEXT_SIZE) -> Any:
        """Return the result of a function, a tuple of several; raise the exception that Python would raise.

        The length of an array follows from it; the buffer of a text is made, `size` is what it is told of it.
        """
        function = declared()[name]
        left, arguments, results, failure = list(values), [], [], Failure()
        for kind, word in function.arguments:
            if kind in _RESULTS:
                results.append(_TYPES[kind.removesuffix(" *")]())
                arguments.append(ctypes.byref(results[-1]))
            elif kind == "py_failure *":
                arguments.append(ctypes.byref(failure))
            elif word == "buffer":
                arguments.append(ctypes.create_string_buffer(TEXT_SIZE))
            elif kind == "size_t":
                arguments.append(size)
            else:
                arguments.append(_given(kind, left.pop(0)))
                if kind == "const double *":
                    left.insert(0, len(values[0]))
        value = getattr(self._library, f"c{name}")(*arguments)
        if not results:
            return _taken(value)
        if not value:
            exception = self._library.cpy_exception(failure.code).decode()
            raise getattr(builtins, exception)(failure.text.decode())
        return _taken(results[0]) if len(results) == 1 else tuple(map(_taken, results))
