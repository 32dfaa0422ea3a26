"""The lines about units that this process writes on stderr when it crashes; the command line asks for them.

A signal such as SIGSEGV ends the process without a return to Python. `faulthandler` writes the Python stack
then, but no name of a unit stands in it. So on Linux a signal handler in machine code, which faulthandler
calls after its own, writes two texts that stand ready in memory: which unit was called last, and which units
run in this process. It is made as soon as an FMU without Python is loaded into the process, since one in
Python crashes with a stack that shows where.
"""

from __future__ import annotations

import faulthandler
import signal
import sys
from collections.abc import Callable
from typing import Any

_SIGNALS = ("SIGSEGV", "SIGABRT", "SIGBUS", "SIGFPE", "SIGILL")
_STDERR = 2
_ADVICE = """Run again with --isolation process: then the run says which unit ended, in which step and how,
and keeps the rows before."""


def enable() -> None:
    """Let this process write the Python stack and the lines about units when it crashes.

    A program that uses evcosim as a library is not to be surprised: it enables faulthandler by itself.
    """
    global _report
    faulthandler.enable(_STDERR, all_threads=False)
    if sys.platform == "linux":
        _report = CrashReport()


def report() -> CrashReport | None:
    """Return the report that units take part in; None where nobody asked for one."""
    return _report


class CrashReport:
    """The texts for the handler: that of the unit called last, and that of all units in this process.

    In memory a text is a row of two int64: address and length in bytes. The handler finds the row of the unit
    in a table, at the place that stands in a cell; what it reads first is `_root`: the addresses of the
    table, of the cell and of the row about all units.
    """

    def __init__(self) -> None:
        import ctypes  # here, since `evcosim --help` needs none

        self._ctypes: Any = ctypes
        self._first_place = ctypes.c_int64(0)
        self._nothing, self._all = self._row(""), self._row("")
        self._units: dict[object, tuple[str, Any]] = {}  # what is shown of each, and its row
        self._root = (ctypes.c_int64 * 3)()
        self._handler: Any = None
        self._tell()
        self.rest()

    def _row(self, text: str) -> Any:
        """A text in memory with its row; the row keeps the text alive."""
        content = self._ctypes.create_string_buffer(text.encode("ascii", "backslashreplace"))
        row = (self._ctypes.c_int64 * 2)(self._ctypes.addressof(content), len(content) - 1)
        row.content = content
        return row

    def add(self, unit: object, name: str, file: str, in_python: bool) -> Callable[[], None]:
        """Take up a unit in this process, and return a call that notes that it is called now."""
        shown = f"{name} ({file})"
        row = self._row(f"\nevcosim: this process crashed; the unit called last was {shown}\n")
        self._units[unit] = shown, row
        self._tell()
        if not in_python and self._handler is None:
            self._install()
        root, address = self._root, self._ctypes.addressof(row)

        def note() -> None:
            root[0] = address

        return note

    def remove(self, unit: object) -> None:
        """Leave out a unit that is freed."""
        self.rest()
        if self._units.pop(unit, None) is not None:
            self._tell()

    def _tell(self) -> None:
        """Make the text about all units."""
        shown = ", ".join(shown for shown, _ in self._units.values())
        self._all = self._row(f"evcosim: units in this process: {shown}\n{_ADVICE}\n" if shown else "")
        self._root[2] = self._ctypes.addressof(self._all)

    def row(self, unit: object) -> tuple[int, int]:
        """The row of a unit, for a table; that of no text for anything else."""
        _, row = self._units.get(unit, ("", self._nothing))
        return row[0], row[1]

    def follow(self, table: int, place: int) -> None:
        """From now on the row at the int64 at address `place` counts, in the table at address `table`.

        `rest` ends it.
        """
        self._root[0], self._root[1] = table, place

    def rest(self) -> None:
        """No unit is called."""
        self._root[0] = self._ctypes.addressof(self._nothing)
        self._root[1] = self._ctypes.addressof(self._first_place)

    def _install(self) -> None:
        library = self._ctypes.CDLL(None)
        functions = [
            self._ctypes.cast(library[name], self._ctypes.c_void_p).value
            for name in ("write", "signal", "raise")
        ]
        self._handler = _machine_code(self._ctypes.addressof(self._root), *functions)
        address = self._ctypes.c_void_p(self._handler.get_function_address("crashed"))
        faulthandler.disable()
        for name in _SIGNALS:
            library.signal(self._ctypes.c_int(getattr(signal, name)), address)
        faulthandler.enable(_STDERR, all_threads=False)  # after ours, so that it is called before


_report: CrashReport | None = None


def _machine_code(root: int, write: int, handle: int, again: int) -> Any:
    """Compile void crashed(int signal): write both texts, then let the same signal end the process.

    The arguments are the addresses of `_root` and of the C functions write, signal and raise, which are
    among the few that a signal handler may call.
    """
    from llvmlite import binding, ir

    integer, long = ir.IntType(32), ir.IntType(64)
    module = ir.Module()
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), [integer]), "crashed")
    builder = ir.IRBuilder(function.append_basic_block())

    def at(address: Any) -> Any:
        return builder.load(builder.inttoptr(address, long.as_pointer()))

    def call(address: int, *arguments: Any) -> None:
        kind = ir.FunctionType(long, [a.type for a in arguments])
        builder.call(builder.inttoptr(long(address), kind.as_pointer()), arguments)

    place = builder.mul(at(at(long(root + 8))), long(16))
    for row in (builder.add(at(long(root)), place), at(long(root + 16))):
        call(write, integer(_STDERR), at(row), at(builder.add(row, long(8))))
    call(handle, function.args[0], long(0))  # the default, which ends the process
    call(again, function.args[0])
    builder.ret_void()
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine()
    made = binding.create_mcjit_compiler(binding.parse_assembly(str(module)), machine)
    made.finalize_object()
    return made
