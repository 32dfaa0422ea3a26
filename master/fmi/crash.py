"""The lines about units that this process writes on stderr when it crashes; the command line enables them.

A signal such as SIGSEGV ends the process without a return to Python. `faulthandler` writes the Python stack
then, but no name of a unit stands in it. So on Linux a signal handler in machine code, which faulthandler
calls after its own, writes two texts that stand ready in memory: which unit was called last, and which units
run in this process. It is made as soon as an FMU without Python is loaded into the process, since one in
Python crashes with a stack that shows where.
"""

from __future__ import annotations

import ctypes
import faulthandler
import signal
import sys
from collections.abc import Callable

from ...cosim.visible import on_one_line
from .crash_code import Addresses, Handler, handler

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
    """Return the report that units take part in; None where it is not enabled."""
    return _report


class _Text:
    """A text in memory: `row` are two int64, its address and its length in bytes."""

    def __init__(self, text: str) -> None:
        self._content = ctypes.create_string_buffer(text.encode("ascii", "backslashreplace"))
        self.row = (ctypes.c_int64 * 2)(ctypes.addressof(self._content), len(self._content) - 1)
        self.address = ctypes.addressof(self.row)


class CrashReport:
    """The texts for the handler: that of the unit called last, and that of all units in this process.

    The handler finds the row of the first text in a table, at the place that stands in a cell. It begins at
    `_root`: the addresses of the table, of the cell and of the row of the second text.
    """

    def __init__(self) -> None:
        self._root = (ctypes.c_int64 * 3)()
        self._first = ctypes.c_int64(0)  # the cell for a table of one row
        self._nothing = self._all = _Text("")
        self._units: dict[object, tuple[str, _Text]] = {}  # name and file of each, and the text about it
        self._kept: list[_Text] = []
        self._handler: Handler | None = None
        self._list()
        self.rest()

    def add(self, unit: object, name: str, file: str, in_python: bool) -> Callable[[], None]:
        """Take up a unit in this process, and return a call that notes that it is called now."""
        shown = on_one_line(f"{name} ({file})")
        text = _Text(f"\nevcosim: this process crashed; the unit called last was {shown}\n")
        self._units[unit] = shown, text
        self._kept.append(text)  # the note may be called once more when the unit was removed
        self._list()
        if not in_python and self._handler is None:
            self._install()
        root, address = self._root, text.address

        def note() -> None:
            if not self._follows:
                root[0] = address

        return note

    def remove(self, unit: object) -> None:
        """Leave out a unit that is freed."""
        self.rest()
        if self._units.pop(unit, None) is not None:
            self._list()

    def _list(self) -> None:
        """Make the text about all units."""
        shown = ", ".join(shown for shown, _ in self._units.values())
        text = _Text(f"evcosim: units in this process: {shown}\n{_ADVICE}\n" if shown else "")
        self._root[2] = text.address
        self._all = text

    def row(self, unit: object) -> tuple[int, int]:
        """Return the row of the text about a unit, for a table; that of no text for anything else."""
        _, text = self._units.get(unit, ("", self._nothing))
        return text.row[0], text.row[1]

    def follow(self, table: int, cell: int) -> None:
        """Let the int64 at the address `cell` choose the row in the table at the address `table`.

        `rest` ends it; until then the notes of units count for nothing.
        """
        self._follows = True
        self._root[0], self._root[1] = table, cell

    def last(self) -> str:
        """Return the unit that was called last, with its file; "" where none was."""
        table, cell = self._root[0], self._root[1]
        place = ctypes.c_int64.from_address(cell).value
        address = ctypes.c_int64.from_address(table + 16 * place).value
        return next((shown for shown, text in self._units.values() if text.row[0] == address), "")

    def rest(self) -> None:
        """Note that no unit is called."""
        self._follows = False
        self._root[0], self._root[1] = self._nothing.address, ctypes.addressof(self._first)

    def _install(self) -> None:
        library = ctypes.CDLL(None)
        write, handle, again = (
            ctypes.cast(library[name], ctypes.c_void_p).value or 0 for name in ("write", "signal", "raise")
        )
        try:
            self._handler = handler(Addresses(ctypes.addressof(self._root), write, handle, again))
        except OSError:  # the system lets no such code run, and a crash is reported by faulthandler alone
            return
        address = ctypes.c_void_p(self._handler.address)
        faulthandler.disable()
        for name in _SIGNALS:
            library.signal(ctypes.c_int(getattr(signal, name)), address)
        faulthandler.enable(_STDERR, all_threads=False)  # after ours, so that it is called before


_report: CrashReport | None = None
