"""A unit of FMI 3.0: Co-Simulation, without event mode and early return, and Model Exchange."""

from __future__ import annotations

import ctypes
import math
import os
from pathlib import Path
from typing import Any

from ...cosim.plan.unit_plan import FmuSteps
from ..unit import UnitError
from .exchange import ModelExchange
from .instance import Instance
from .log import receive_3
from .transfer import Call, StepCall

_FALSE, _TRUE = ctypes.c_bool(False), ctypes.c_bool(True)


class Fmi3Unit(Instance):
    """An `Instance` of FMI 3.0."""

    fmi = "fmi3"
    _true = _TRUE
    _statuses = 5

    def _instantiate(self, folder: Path) -> int | None:
        description = self.fmu.description
        component: int | None = self.function("fmi3InstantiateCoSimulation", ctypes.c_void_p)(
            *self._about(folder, description.instantiationToken or ""),
            _FALSE,  # no event mode
            _FALSE,  # no early return
            ctypes.c_void_p(),
            ctypes.c_size_t(0),  # no variable is looked at within a step
            ctypes.c_void_p(self.log.id),
            receive_3,
            ctypes.c_void_p(),
        )
        return component

    def _about(self, folder: Path, token: str) -> tuple[Any, ...]:
        """Return the arguments that all kinds of FMI 3.0 have: name, token, resources, invisible, logging."""
        return (
            ctypes.c_char_p(self.name.encode()),
            ctypes.c_char_p(token.encode()),
            ctypes.c_char_p(resources_path(folder)),
            _FALSE,
            _TRUE,
        )

    def arguments(self, references: Any, count: int, values: Any) -> tuple[Any, ...]:
        """Return the arguments of a get or set function: the values have a count of their own."""
        return self._component, references, ctypes.c_size_t(count), values, ctypes.c_size_t(count)

    def _set_up(self, start_time: float, stop_time: float | None) -> None:
        stop = ctypes.c_bool(stop_time is not None), ctypes.c_double(stop_time or 0.0)
        start = ctypes.c_double(start_time)
        tolerance = ctypes.c_bool(self.tolerance is not None), ctypes.c_double(self.tolerance or 0.0)
        self._experiment: Any = *tolerance, start, *stop

    def _enter(self) -> None:
        self._call("fmi3EnterInitializationMode", self._component, *self._experiment)

    def exit_initialization(self) -> None:
        self._call("fmi3ExitInitializationMode", self._component)
        self._initialized = True
        self._prepare_steps()

    def _prepare_steps(self) -> None:
        self._do_step = self.function("fmi3DoStep")
        self._time, self._step_size = ctypes.c_double(), ctypes.c_double()
        self._event, self._ending, self._early = (ctypes.c_bool() for _ in range(3))
        self._reached = ctypes.c_double(math.nan)  # an FMU that does not write it has done the step
        self.step_call = StepCall(self._do_step, (self._event, self._ending, self._early, self._reached))
        self._step_arguments = (
            self._component, self._time, self._step_size, _TRUE, ctypes.byref(self._event),
            ctypes.byref(self._ending), ctypes.byref(self._early), ctypes.byref(self._reached),
        )  # fmt: skip # the step writes the last four

    def start_step(self, steps: FmuSteps) -> None:
        for self._time.value, self._step_size.value in steps.each():
            status = self._do_step(*self._step_arguments)
            if status or self._ending or self._early:
                self.judge_step(status)
                if self.asked_end is not None:
                    break

    def judge_step(self, status: int) -> None:
        """Judge a step. It may ask to end the simulation, but not end early, since that is not allowed."""
        if status:
            self._judge("fmi3DoStep", status)
        if self._ending:
            self.asked_end = math.inf if math.isnan(self._reached.value) else self._reached.value
        elif self._early:
            raise UnitError(
                f"unit '{self.name}': fmi3DoStep returned early, at t = {self._reached.value:g} s, though "
                f"early return is not allowed{self._said()}"
            )


def resources_path(folder: Path) -> bytes:
    """Return FMI 3.0's resourcePath: the path of the resources with a separator behind it."""
    return os.fsencode(folder / "resources") + os.sep.encode()


class _DiscreteStates(ctypes.Structure):
    """The results of fmi3UpdateDiscreteStates, in its order, under the names of FMI 2.0."""

    _fields_ = [
        ("newDiscreteStatesNeeded", ctypes.c_bool),
        ("terminateSimulation", ctypes.c_bool),
        ("nominalsOfContinuousStatesChanged", ctypes.c_bool),
        ("valuesOfContinuousStatesChanged", ctypes.c_bool),
        ("nextEventTimeDefined", ctypes.c_bool),
        ("nextEventTime", ctypes.c_double),
    ]


class Fmi3ModelExchange(ModelExchange, Fmi3Unit):
    """A `ModelExchange` of FMI 3.0."""

    _flag = ctypes.c_bool
    _derivatives = "GetContinuousStateDerivatives"

    def _instantiate(self, folder: Path) -> int | None:
        component: int | None = self.function("fmi3InstantiateModelExchange", ctypes.c_void_p)(
            *self._about(folder, self.fmu.description.instantiationToken or ""),
            ctypes.c_void_p(self.log.id),
            receive_3,
        )
        return component

    def _discrete_states(self) -> Call:
        self._answer = answer = _DiscreteStates()
        offsets = [getattr(_DiscreteStates, field[0]).offset for field in _DiscreteStates._fields_]
        return self._bound("UpdateDiscreteStates", *(ctypes.byref(answer, offset) for offset in offsets))
