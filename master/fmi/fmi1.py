"""A unit of FMI 1.0 Co-Simulation.

It has no initialization mode: values are set on the instantiated slave, and fmiInitializeSlave fixes them.
Before that the slave gives no values; the unit returns the value that was set, else the start value.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from ...cosim.interface import UnitInterface, Value
from ...cosim.plan.unit_plan import FmuSteps
from .fmu import Fmu, FmuError
from .instance import Instance
from .library import Library
from .transfer import StepCall

_FALSE, _TRUE = ctypes.c_char(0), ctypes.c_char(1)  # fmiBoolean


class Fmi1Unit(Instance):
    """An `Instance` of FMI 1.0; it takes no tolerance."""

    fmi = "fmi"
    _true = _TRUE
    _takes_inputs = "after it"

    def __init__(
        self,
        fmu: Fmu,
        name: str,
        interface: UnitInterface | None = None,
        tolerance: float | None = None,
    ) -> None:
        if tolerance is not None:
            raise FmuError(f"{fmu.path}: unit '{name}': a unit of FMI 1.0 Co-Simulation takes no tolerance")
        self._given: dict[str, Value] = {}
        self._late = False  # inputs are set after the initialization
        super().__init__(fmu, name, interface, tolerance)

    def _prefix(self) -> str:
        return f"{self.fmu.kind.modelIdentifier}_"

    def _instantiate(self, folder: Path) -> int | None:
        self._callbacks = self.log.callbacks_1()
        component: int | None = self.function("fmiInstantiateSlave", ctypes.c_void_p)(
            ctypes.c_char_p(self.name.encode()),
            ctypes.c_char_p((self.fmu.description.guid or "").encode()),
            ctypes.c_char_p(folder.as_uri().encode()),
            ctypes.c_char_p(b"application/x-fmu-sharedlibrary"),
            ctypes.c_double(0.0),
            _FALSE,  # invisible
            _FALSE,  # not interactive
            self._callbacks,
            _TRUE,  # logging
        )
        if component:
            self.log.belongs_to(component)
        return component

    def get(self, name: str) -> Value:
        """Return the value of a variable; before the initialization the one set, else the start value."""
        if self._initialized:
            return super().get(name)
        if name in self._given:
            return self._given[name]
        variable = self.interface.variables[name]
        return self.type_of(variable).kind.zero if variable.start is None else variable.start

    def set(self, name: str, value: Value) -> None:
        """Set a variable; before the initialization an input only where the FMU takes one then."""
        if self._initialized or not (self._late and self.interface.variables[name].causality == "input"):
            super().set(name, value)
        if not self._initialized:
            self._given[name] = value

    def _open_anew(self) -> None:
        super()._open_anew()
        self._late = True
        self._given.clear()

    def _set_up(self, start_time: float, stop_time: float | None) -> None:
        known = _FALSE if stop_time is None else _TRUE
        self._experiment: Any = ctypes.c_double(start_time), known, ctypes.c_double(stop_time or 0.0)

    def _enter(self) -> None:
        """FMI 1.0 has no initialization mode."""

    def exit_initialization(self) -> None:
        self._call("fmiInitializeSlave", self._component, *self._experiment)
        self._initialized = True
        for name, value in self._given.items() if self._late else ():
            if self.interface.variables[name].causality == "input":
                self.set(name, value)
        self._do_step = self.function("fmiDoStep")
        self.step_call = StepCall(self._do_step)
        self._time, self._step_size = ctypes.c_double(), ctypes.c_double()

    def start_step(self, steps: FmuSteps) -> None:
        for self._time.value, self._step_size.value in steps.each():
            status = self._do_step(self._component, self._time, self._step_size, _TRUE)
            if status:
                self.judge_step(status)

    def judge_step(self, status: int) -> None:
        self._judge_step("fmiDoStep", status)

    def _listen_to_trouble(self) -> None:
        """FMI 1.0 has no log categories to choose from."""

    def terminate(self) -> None:
        if self._initialized:
            self._initialized = False
            self._end("fmiTerminateSlave")

    def _free_instance(self, library: Library, component: Any) -> None:
        library.function("fmiFreeSlaveInstance", None)(component)
