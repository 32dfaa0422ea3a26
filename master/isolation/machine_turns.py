"""The turns of a unit in its process, in machine code that the master has sent (see `machine.serving`)."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable

import numpy as np

from ..fmi.instance import Instance
from ..fmi.transfer import Call, Copy, Transfer
from ..fmi.types import STRING
from ..machine import tables as L
from ..machine.loaded import Loaded
from ..machine.rows import CallRows, Cells, collect_warnings, table
from ..machine.surroundings import Surroundings, address
from ..unit import floats
from .shared import Shared

_Python = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_int64)
_RELEASING = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)  # gives up Python's lock while it runs
_HOLDING = ctypes.PYFUNCTYPE(ctypes.c_int64, ctypes.c_int64)


class MachineTurns:
    """The tables of one unit, which is initialized, and its code. Raises OSError where no such may run."""

    def __init__(self, code: bytes, instance: Instance, memory: Shared, socket: int) -> None:
        locked = instance.fmu.holds_python  # else each call of the FMU takes the lock and gives it back
        self._code = Loaded(code)
        self._run = (_HOLDING if locked else _RELEASING)(self._code.address)
        self._instance = instance
        self._rows = rows = CallRows(floats(memory.values))
        self._acts: list[Call] = []
        self._raised: BaseException | None = None
        self._python = _Python(self._act)
        parts = [self._operations(instance, part) for part in _parts(instance)]
        self._recheck_step = rows.add_unit(instance, {})
        self._state = np.zeros(L.STATE_SIZE, dtype=np.int64)
        self._state[L.PYTHON] = address(self._python)
        numbers, self._turn = np.zeros(L.NUMBERS_SIZE), np.zeros(L.TURN_SIZE)
        self._surroundings = Surroundings(self._state, numbers, locked)
        hand: Cells = {
            L.SLOTS: memory.address, L.SOCKET: socket, L.TURN: self._turn.ctypes.data,
            L.INPUTS: len(parts[0]), L.SHOWN: len(parts[1]), L.BACK: len(parts[2]),
        }  # fmt: skip # a row
        self._calls, self._units = table(rows.calls, L.CALL_WIDTH), table(rows.units, L.UNIT)
        tables = self._surroundings.tables | {
            L.STATE: self._state, L.NUMBERS: numbers, L.MEMORY: memory.values, L.CALLS: self._calls,
            L.OPS: table([row for part in parts for row in part], L.OPERATION), L.UNITS: self._units,
            L.ITEMS: table(rows.items, L.ITEM), L.HANDS: table([hand], L.HAND),
        }  # fmt: skip # what a turn needs
        self._tables = tables
        self._addresses = np.zeros(L.TABLES, dtype=np.int64)
        for place, array in tables.items():
            self._addresses[place] = array.ctypes.data

    def _operations(self, instance: Instance, transfers: Iterable[Transfer | Copy]) -> list[Cells]:
        found: list[Cells] = []
        for each in transfers:
            if isinstance(each, Transfer) and each.type.kind is STRING:
                found.append({L.KIND: L.PYTHON_ACT, L.C: len(self._acts)})
                self._acts.append(instance.binding.calls([each]))
            elif isinstance(each, Copy):
                found.append({L.KIND: L.COPY, L.A: each.source, L.B: each.target, L.C: each.count})
            else:
                found.append({L.KIND: L.CALL, L.A: len(self._rows.calls)})
                self._rows.add_call(instance, each)
        return found

    def _act(self, number: int, _: int) -> int:
        """Make a call with texts; return 1 if an error was raised, else 0."""
        try:
            self._acts[number]()
            return 0
        except BaseException as error:  # no exception can pass through machine code
            self._raised = error
            return 1

    def do(self, number: float) -> tuple[float, bool]:
        """Do and answer the turns after request `number` as long as they come.

        Return the number of the last one, and False if that is not answered yet. Raises what a turn raises,
        whose number stands in `number` then.
        """
        self._turn[L.REQUESTS] = number
        result = self._run(self._addresses.ctypes.data)
        if result in (L.NOTHING_CAME, L.OTHER_REQUEST):
            return self.number, True
        self._collect_warnings()
        if result != L.WARNED:
            self._recheck(result)
            self._instance.get_outputs()  # it asked for the end of the run
        return self.number, False

    @property
    def number(self) -> float:
        """The number of the last request that was seen."""
        return float(self._turn[L.REQUESTS])

    def _collect_warnings(self) -> None:
        self._state[L.NOTED] = 0
        collect_warnings(self._calls, self._rows.called)
        collect_warnings(self._units, self._rows.stepped)

    def _recheck(self, result: int) -> None:
        """Raise what the turn raises that ended with `result`; return for one that asked for the end."""
        if result == L.RAISED and self._raised is not None:
            raise self._raised
        called, detail = int(self._state[L.CALLED]), int(self._state[L.DETAIL])
        recheck = self._recheck_step if called < 0 else self._rows.rechecks[called]
        recheck(result, detail)
        if self._instance.asked_end is None:
            raise AssertionError(f"a turn ended with {result}, and nothing is wrong with it")


def _parts(instance: Instance) -> tuple[Iterable[Transfer | Copy], ...]:
    return instance.inputs, instance.through, instance.outputs
