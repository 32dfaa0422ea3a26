"""A unit of FMI 1.0: Co-Simulation, and Model Exchange.

It has no initialization mode: values are set on the instance, and fmiInitializeSlave or fmiInitialize fixes
them. Before that the instance gives no values; the unit returns the one that was set, else the start value.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from ...cosim.interface import UnitInterface, Value
from ...cosim.plan.unit_plan import FmuSteps
from .exchange import ModelExchange
from .fmu import Fmu, FmuError
from .instance import Instance
from .library import Library
from .step_status import beside
from .transfer import Call, StepCall, one_after_the_other

_FALSE, _TRUE = ctypes.c_char(0), ctypes.c_char(1)  # fmiBoolean
_PLATFORM = b"standard32"  # the sizes of the types, of which FMI 1.0 defines no other
_DISCARD = 2


class Fmi1Instance(Instance):
    """An `Instance` of FMI 1.0.

    A class for one of its kinds defines, beside what stands there, `_initialize` and `_prepare_steps`.
    """

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
        self._given: dict[str, Value] = {}
        self._late = False  # inputs are set after the initialization
        super().__init__(fmu, name, interface, tolerance)

    def _prefix(self) -> str:
        return f"{self.fmu.kind.modelIdentifier}_"

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
        self._initialize()
        self._initialized = True
        for name, value in self._given.items() if self._late else ():
            if self.interface.variables[name].causality == "input":
                super().set(name, value)
        self._prepare_steps()

    def _initialize(self) -> None:
        """Call the function that initializes the instance."""
        raise NotImplementedError

    def _prepare_steps(self) -> None:
        """Make what the steps need."""
        raise NotImplementedError

    def _listen_to_trouble(self) -> None:
        """FMI 1.0 has no log categories to choose from."""


class Fmi1Unit(Fmi1Instance):
    """An `Instance` of FMI 1.0 Co-Simulation, which is told no tolerance."""

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

    def _initialize(self) -> None:
        self._call("fmiInitializeSlave", self._component, *self._experiment)

    def _prepare_steps(self) -> None:
        self._do_step = self.function("fmiDoStep")
        self.step_call = StepCall(self._do_step)
        self._time, self._step_size = ctypes.c_double(), ctypes.c_double()

    def start_step(self, steps: FmuSteps) -> None:
        for self._time.value, self._step_size.value in steps.each():
            status = self._do_step(self._component, self._time, self._step_size, _TRUE)
            if status:
                self.judge_step(status)

    def judge_step(self, status: int) -> None:
        self._judge("fmiDoStep", status, beside(status, self.fmi, self._library, self._component))

    def terminate(self) -> None:
        if self._initialized:
            self._initialized = False
            self._end("fmiTerminateSlave")

    def _free_instance(self, library: Library, component: Any) -> None:
        library.function("fmiFreeSlaveInstance", None)(component)


class _EventInfo(ctypes.Structure):
    """fmiEventInfo, with the names that FMI 2.0 has for its members."""

    _fields_ = [
        ("iterationConverged", ctypes.c_byte),
        ("nominalsOfContinuousStatesChanged", ctypes.c_byte),  # stateValueReferencesChanged
        ("valuesOfContinuousStatesChanged", ctypes.c_byte),
        ("terminateSimulation", ctypes.c_byte),
        ("nextEventTimeDefined", ctypes.c_byte),  # upcomingTimeEvent
        ("nextEventTime", ctypes.c_double),
    ]

    @property
    def newDiscreteStatesNeeded(self) -> bool:
        return not self.iterationConverged


class Fmi1ModelExchange(ModelExchange, Fmi1Instance):
    """A `ModelExchange` of FMI 1.0: it has no modes, is told no stop time, and may ask for its end only in an
    event."""

    _flag = ctypes.c_byte
    _derivatives = "GetDerivatives"
    _nominals = "GetNominalContinuousStates"

    def _instantiate(self, folder: Path) -> int | None:
        self._check_platform()
        self._callbacks = self.log.callbacks_1(steps=False)
        component: int | None = self.function("fmiInstantiateModel", ctypes.c_void_p)(
            ctypes.c_char_p(self.name.encode()),
            ctypes.c_char_p((self.fmu.description.guid or "").encode()),
            self._callbacks,
            _TRUE,  # logging
        )
        if component:
            self.log.belongs_to(component)
        return component

    def _check_platform(self) -> None:
        """Raise FmuError for a library whose types have other sizes; one that does not say has these."""
        name = "fmiGetModelTypesPlatform"
        found = self.function(name, ctypes.c_char_p)() if self._library.has(name) else None
        if found not in (None, _PLATFORM):
            raise FmuError(
                f"{self.fmu.path}: the types of its library are those of the platform "
                f"'{found.decode('utf-8', 'replace')}', and FMI 1.0 has '{_PLATFORM.decode()}' only"
            )

    def _set_up(self, start_time: float, stop_time: float | None) -> None:
        super()._set_up(start_time, stop_time)
        self._call("fmiSetTime", self._component, self._time)

    def _initialize(self) -> None:
        self._answer = _EventInfo(iterationConverged=1)  # for an FMU that leaves it as it is
        tolerance = ctypes.c_double(self._relative)
        self._call("fmiInitialize", self._component, _TRUE, tolerance, ctypes.byref(self._answer))

    def _first_update(self) -> Call:
        """Return a call that does nothing, as fmiInitialize has answered; inputs after it are an event."""
        return self._update if self._late else one_after_the_other()

    def _discrete_states(self) -> Call:
        return self._bound("EventUpdate", _FALSE, ctypes.byref(self._answer))  # no intermediate results

    def _entering(self, mode: str) -> Call:
        return one_after_the_other()

    def _completion_arguments(self) -> tuple[Any, ...]:
        return (ctypes.byref(self._wants_event),)

    def _derivative_names(self) -> list[str]:
        """Return those of the states, which the FMU knows by value reference; it need not know all."""
        name, found = "fmiGetStateValueReferences", (ctypes.c_uint * self._nx)()
        if not self._library.has(name):
            return []
        if self.function(name)(self._component, found, ctypes.c_size_t(self._nx)) >= _DISCARD:
            return []
        reals = [v for v in reversed(self.fmu.description.modelVariables) if v.type == "Real"]
        states = {int(v.valueReference): v.name for v in reals if v.name not in self.fmu.negated}
        return [f"der({states.get(reference, f'state {i}')})" for i, reference in enumerate(found, 1)]

    def _free_instance(self, library: Library, component: Any) -> None:
        library.function("fmiFreeModelInstance", None)(component)
