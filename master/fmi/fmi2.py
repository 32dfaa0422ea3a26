"""A unit of FMI 2.0: Co-Simulation, and Model Exchange."""

from __future__ import annotations

import ctypes
from pathlib import Path

from ...cosim.plan.unit_plan import FmuSteps
from .exchange import ModelExchange
from .instance import Instance
from .step_status import asked_end, beside
from .transfer import Call, StepCall

_INVISIBLE, _LOGGING = ctypes.c_int(0), ctypes.c_int(1)  # fmi2Boolean
_MODEL_EXCHANGE, _CO_SIMULATION = ctypes.c_int(0), ctypes.c_int(1)


class _EventInfo(ctypes.Structure):
    """fmi2EventInfo."""

    _fields_ = [
        ("newDiscreteStatesNeeded", ctypes.c_int),
        ("terminateSimulation", ctypes.c_int),
        ("nominalsOfContinuousStatesChanged", ctypes.c_int),
        ("valuesOfContinuousStatesChanged", ctypes.c_int),
        ("nextEventTimeDefined", ctypes.c_int),
        ("nextEventTime", ctypes.c_double),
    ]


class Fmi2Unit(Instance):
    """An `Instance` of FMI 2.0."""

    fmi = "fmi2"
    _kind = _CO_SIMULATION

    def _instantiate(self, folder: Path) -> int | None:
        self._callbacks = self.log.callbacks()
        component: int | None = self.function("fmi2Instantiate", ctypes.c_void_p)(
            ctypes.c_char_p(self.name.encode()),
            self._kind,
            ctypes.c_char_p((self.fmu.description.guid or "").encode()),
            ctypes.c_char_p(self.fmu.resources_uri(folder)),
            ctypes.byref(self._callbacks),
            _INVISIBLE,
            _LOGGING,
        )
        return component

    def _set_up(self, start_time: float, stop_time: float | None) -> None:
        known = stop_time is not None
        self._call(
            "fmi2SetupExperiment", self._component,
            ctypes.c_int(self.tolerance is not None), ctypes.c_double(self.tolerance or 0.0),
            ctypes.c_double(start_time), ctypes.c_int(known), ctypes.c_double(stop_time or 0.0),
        )  # fmt: skip # tolerance, start, stop

    def _enter(self) -> None:
        self._call("fmi2EnterInitializationMode", self._component)

    def exit_initialization(self) -> None:
        self._call("fmi2ExitInitializationMode", self._component)
        self._initialized = True
        self._prepare_steps()

    def _prepare_steps(self) -> None:
        self._do_step = self.function("fmi2DoStep")
        self.step_call = StepCall(self._do_step)
        self._time, self._step_size = ctypes.c_double(), ctypes.c_double()
        self._no_set_state = ctypes.c_int(1)

    def start_step(self, steps: FmuSteps) -> None:
        for self._time.value, self._step_size.value in steps.each():
            status = self._do_step(self._component, self._time, self._step_size, self._no_set_state)
            if status:
                self.judge_step(status)
                if self.asked_end is not None:
                    break

    def judge_step(self, status: int) -> None:
        # pythonfmu says of each discarded step that the unit asks to end; one that failed has logged why
        if not self.log.ends_in_error():
            self.asked_end = asked_end(status, self._library, self._component)
        if self.asked_end is None:
            self._judge("fmi2DoStep", status, beside(status, self.fmi, self._library, self._component))


class Fmi2ModelExchange(ModelExchange, Fmi2Unit):
    """A `ModelExchange` of FMI 2.0."""

    _kind = _MODEL_EXCHANGE
    _flag = ctypes.c_int
    _derivatives = "GetDerivatives"

    def _discrete_states(self) -> Call:
        self._answer = _EventInfo()
        return self._bound("NewDiscreteStates", ctypes.byref(self._answer))
