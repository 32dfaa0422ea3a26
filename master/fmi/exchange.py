"""Units of Model Exchange, of any version of FMI: the FMU gives equations, and we solve them.

Between two communication points the inputs are held and the states follow their derivatives (`cvode`) until
an event: a state event (an event indicator z passes between z > 0 and z <= 0), a time event (the FMU named
the time), or a step event (it wants one after a step of the solver). Discrete inputs that change at a
communication point are an event too, and so are continuous ones that change the sign of an indicator. In an
event the FMU computes new discrete states until it needs no more, and the solver begins anew; so it does
after any change of an input, which bends the solution. An event at the end of a step is part of that step:
the outputs there are those after it.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import math
import sys
from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ...cosim.interface import UnitInterface, Value, VariableInfo
from ...cosim.plan.unit_plan import FmuSteps, UnitPlan
from ..unit import UnitError
from .binding import Place
from .cvode import Cvode, Function, SolverError
from .fmu import Fmu
from .instance import Instance
from .transfer import Call, one_after_the_other

_ABSOLUTE = 0.01  # of the relative tolerance times the nominal value (FMI 2.0, section 2.2.7)
_ITERATIONS = 1000  # for new discrete states, in one event
_EVENTS = 10_000  # in one step
_SOLVER_STEPS = 100_000  # from one event, or the start of a step, to the next
_DISCARD = 2
_SHOWN = 3
_CLOSE = 16 * sys.float_info.epsilon  # of a time: what the solver cannot step over


class _Ending(Exception):
    """The FMU asks to end the simulation; `asked_end` has the time."""


class ModelExchange(Instance):
    """An `Instance` with a solver. A class for a version of FMI defines, beside what stands there:

    `_flag`             the type of a C Boolean that the FMU writes
    `_derivatives`      the name of the function that gives the derivatives
    `_discrete_states`  makes the call for new discrete states, which is then made many times
    `_answer`           the structure that this call writes, with the members of fmi2EventInfo

    and what differs from FMI 2.0 of `_nominals`, the name of the function that gives the nominal values,
    `_entering`, `_completion_arguments`, `_first_update` and `_derivative_names`.
    """

    _flag: Any
    _derivatives: str
    _nominals = "GetNominalsOfContinuousStates"
    _answer: Any
    _discrete_states: Callable[[], Call]

    def __init__(
        self,
        fmu: Fmu,
        name: str,
        interface: UnitInterface | None = None,
        tolerance: float | None = None,
    ) -> None:
        self._solver: Cvode | None = None
        self._stepping = False  # its first discrete states are known
        self._begins_anew = self._nominals_changed = True
        self._inputs: dict[bool, list[Place]] = {True: [], False: []}  # continuous ones, discrete ones
        self._held: dict[bool, list[float]] = {True: [], False: []}  # their values, as last given to the FMU
        super().__init__(fmu, name, interface, tolerance)
        assert self.tolerance is not None  # in Model Exchange there is one
        self._relative: float = self.tolerance

    # ---- before the steps

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        """Make the calls of a turn. Discrete inputs, which only events may set, have calls of their own."""
        super().bind(memory, plan)
        self._inputs = {True: [], False: []}
        for group in plan.groups:
            for slot, variable in plan.set_in_steps(group):
                self._inputs[_is_continuous(variable)].append((slot, variable))
        binding, self._view = self.binding, self.binding.view
        self._set_continuous, self._set_discrete = (
            binding.calls(binding.transfers("Set", self._inputs[kind])) for kind in (True, False)
        )
        self.set_inputs = self._noting(self._take_inputs)

    def _set_up(self, start_time: float, stop_time: float | None) -> None:
        self._time = ctypes.c_double(start_time)
        super()._set_up(start_time, stop_time)

    def _prepare_steps(self) -> None:
        """Continue `exit_initialization`: the FMU is in event mode now."""
        description = self.fmu.description
        self._nx = int(description.numberOfContinuousStates)
        self._nz = int(description.numberOfEventIndicators)
        self._z = (ctypes.c_double * self._nz)()
        self._move = self._bound("SetTime", self._time)
        self._enter_event_mode = self._entering("EventMode")
        self._enter_continuous_time = self._entering("ContinuousTimeMode")
        self._get_indicators = self._of_all("GetEventIndicators", self._z)
        self._wants_event, self._wants_end = self._flag(), self._flag()
        self._complete = self._completed()
        self._update = self._discrete_states()
        if self._nx or self._nz:
            self._make_solver()
        self._iterate(self._first_update())
        self._settle()
        self._held[False] = [self._number(self.get(v.name)) for _, v in self._inputs[False]]
        self._stepping = True

    def _number(self, value: Value) -> float:
        assert self._bound_to is not None  # steps follow `bind`
        return self._bound_to[1].texts.number(value) if isinstance(value, str) else float(value)

    def _entering(self, mode: str) -> Call:
        """Return the call that enters a mode."""
        return self._bound(f"Enter{mode}")

    def _first_update(self) -> Call:
        """Return the call that gives the first answer about discrete states."""
        return self._update

    def _bound(self, what: str, *arguments: Any) -> Call:
        """Return a call of a function of the FMU with these arguments behind the component, judged."""
        name, component = f"{self.fmi}{what}", self._component
        function = self.function(name)

        def call() -> None:
            if status := function(component, *arguments):
                self._judge(name, status)

        return call

    def _of_all(self, what: str, buffer: Any) -> Call:
        """Return a call that moves all states or indicators, and does nothing where there are none."""
        count = self._nz if what == "GetEventIndicators" else self._nx
        return self._bound(what, buffer, ctypes.c_size_t(count)) if count else one_after_the_other()

    def _make_solver(self) -> None:
        derivatives = self._evaluating(self._derivatives, self._nx)
        roots = self._evaluating("GetEventIndicators", self._nz)
        self._solver = solver = Cvode(self._nx, self._nz, derivatives, roots, self._relative)
        self._get_states = self._of_all("GetContinuousStates", solver.x)
        self._put_states = self._of_all("SetContinuousStates", solver.x)
        self._get_nominals = one_after_the_other()
        if self._library.has(f"{self.fmi}{self._nominals}"):
            self._get_nominals = self._of_all(self._nominals, solver.absolute)

    def _completed(self) -> Call | None:
        """Return the call that reports a step of the solver to the FMU; None where it needs none."""
        what = "CompletedIntegratorStep"
        if not self.fmu.kind.needsCompletedIntegratorStep or not self._library.has(self.fmi + what):
            return None
        return self._bound(what, *self._completion_arguments())

    def _completion_arguments(self) -> tuple[Any, ...]:
        """Return what the report of a step passes: there is no return to a time before it; two answers."""
        return self._flag(True), ctypes.byref(self._wants_event), ctypes.byref(self._wants_end)

    # ---- for the solver

    def _evaluating(self, what: str, count: int) -> Function | None:
        """Return a function that sets time and states and gets `count` values; None for no values."""
        if not count:
            return None
        component, time = self._component, self._time
        n, m = ctypes.c_size_t(self._nx), ctypes.c_size_t(count)
        names = [f"{self.fmi}{w}" for w in ("SetTime", "SetContinuousStates", what)]
        set_time, evaluate = self.function(names[0]), self.function(names[2])
        set_states = self.function(names[1]) if self._nx else _nothing

        def evaluated(at: float, states: ctypes.c_void_p, answer: ctypes.c_void_p) -> int:
            time.value = at
            if (status := set_time(component, time)) and self._rejects(names[0], status):
                return 1
            if (status := set_states(component, states, n)) and self._rejects(names[1], status):
                return 1
            if (status := evaluate(component, answer, m)) and self._rejects(names[2], status):
                return 1
            return 0

        return evaluated

    def _rejects(self, what: str, status: int) -> bool:
        """Return True if the FMU cannot be evaluated there, so that a smaller step may help; else judge."""
        if status != _DISCARD:
            self._judge(what, status)
        return status == _DISCARD

    def _scale(self, solver: Cvode) -> None:
        """Set the absolute tolerances, which follow from the nominal values of the states."""
        solver.absolute[:] = [1.0] * len(solver.absolute)
        self._get_nominals()
        factor = _ABSOLUTE * self._relative
        solver.absolute[:] = [factor * (abs(x) if math.isfinite(x) and x else 1.0) for x in solver.absolute]

    def _why_not(self) -> str:
        """Return a clause with the derivatives that were no finite numbers where the solver was last."""
        solver, names = self._solver, self._derivative_names()
        if solver is None or len(names) != self._nx:
            return ""
        found = zip(names, solver.last_derivatives(), strict=True)
        bad = [f"{name} = {x}" for name, x in found if not math.isfinite(x)]
        return f"; there {', '.join(bad[:_SHOWN])}" if bad else ""

    def _derivative_names(self) -> list[str]:
        return [unknown.variable.name for unknown in self.fmu.description.derivatives]

    # ---- events

    def _iterate(self, first: Call | None = None) -> None:
        """Compute new discrete states until there are no more, and enter continuous-time mode.

        `first` is the first call that does it (None: as every other).
        """
        update = first or self._update
        for _ in range(_ITERATIONS):
            update()
            update, answer = self._update, self._answer
            if answer.terminateSimulation:
                self._ask_to_end()
            self._nominals_changed |= bool(answer.nominalsOfContinuousStatesChanged)
            if not answer.newDiscreteStatesNeeded:
                break
        else:
            self._give_up(f"needs new discrete states without end ({_ITERATIONS} times)")
        self._next_event = answer.nextEventTime if answer.nextEventTimeDefined else math.inf
        self._enter_continuous_time()
        self._begins_anew = True

    def _handle_event(self, change: Call | None = None) -> None:
        """Handle an event now; `change` is the call that changes the FMU in it."""
        self._enter_event_mode()
        if change is not None:
            change()
        self._iterate()
        self._settle()

    def _handle_change(self, change: Call | None = None) -> None:
        """Handle an event that a change of an input makes, before a step; the FMU may ask to end there."""
        with contextlib.suppress(_Ending):
            self._handle_event(change)

    def _settle(self) -> None:
        """Take over nominal values and domains after an event."""
        if self._nominals_changed and self._solver is not None:
            self._scale(self._solver)
        self._nominals_changed = False
        self._domains = self._domains_now()

    def _domains_now(self) -> list[bool]:
        """Return the domains of the event indicators: True for z > 0."""
        self._get_indicators()
        return [z > 0.0 for z in self._z]

    def _give_up(self, why: str) -> NoReturn:
        raise UnitError(f"unit '{self.name}': {why}, at t = {self._time.value:.12g} s{self._said()}")

    def _ask_to_end(self) -> NoReturn:
        """Note that the FMU asks to end the simulation now, and leave what is under way."""
        if not self._stepping:
            self._give_up("asks to end the simulation before the first step")
        self.asked_end = self._time.value
        raise _Ending

    # ---- the calls of `unit.Unit`

    def _take_inputs(self) -> None:
        """Set the inputs that have changed since the last call; a discrete one is an event."""
        view, held = self._view, self._held
        continuous, discrete = ([view[slot] for slot, _ in self._inputs[kind]] for kind in (True, False))
        if continuous == held[True] and discrete == held[False]:
            return
        held[True] = continuous
        if discrete != held[False]:
            held[False] = discrete
            self._handle_change(one_after_the_other(self._set_discrete, self._set_continuous))
        else:
            self._set_continuous()
            self._begins_anew = True
            if self._domains_now() != self._domains:
                self._handle_change()

    def set(self, name: str, value: Value) -> None:
        """Set a variable; after the initialization this is an event."""
        change = functools.partial(super().set, name, value)
        if self._initialized:
            self._handle_change(change)
        else:
            change()

    def start_step(self, steps: FmuSteps) -> None:
        """Integrate over the steps. No step of the solver is longer than one of them."""
        if self.asked_end is not None:  # as it got its inputs
            return
        try:
            for end in steps.ends():
                self._advance(end)
        except _Ending:
            return
        except SolverError as error:
            self._give_up(f"CVODE cannot go on: {error}{self._why_not()}")

    def _advance(self, stop: float) -> None:
        """Integrate to `stop` [s], through all events up to it and at it."""
        time = self._time
        for _ in range(_EVENTS):
            event = self._integrate(min(stop, self._next_event))
            if not event and self._next_event - time.value <= _close(time.value):
                event, time.value = True, max(time.value, self._next_event)
                self._move()
            if event:
                self._handle_event()
            elif stop - time.value <= _close(stop):
                return
        self._give_up(f"has more than {_EVENTS} events in one step")

    def _integrate(self, target: float) -> bool:
        """Integrate to `target` [s] or to an event before it, and return True for an event.

        A time event is not looked for.
        """
        time, solver = self._time, self._solver
        if target - time.value <= _close(target):
            return False
        if solver is None:
            time.value = target
            self._move()
            return self._completes()
        if self._begins_anew:
            self._get_states()
            solver.restart(time.value)
            self._begins_anew = False
        for _ in range(_SOLVER_STEPS):
            crossed = solver.step(target)
            time.value = solver.time
            self._move()
            self._put_states()
            wanted = self._completes()
            if crossed or wanted or (self._nz and self._domains_now() != self._domains):
                return True
            if not solver.time < target:
                return False
        return self._give_up(f"CVODE needs more than {_SOLVER_STEPS} steps to get to t = {target:.12g} s")

    def _completes(self) -> bool:
        """Report a completed step to the FMU, and return True if it needs an event."""
        if self._complete is None:
            return False
        self._complete()
        if self._wants_end:
            self._ask_to_end()
        return bool(self._wants_event)

    def free(self) -> None:
        solver, self._solver = self._solver, None
        if solver is not None:
            solver.close()
        super().free()


def _nothing(*_: Any) -> int:
    return 0


def _close(time: float) -> float:
    """Return the interval [s] before a time that counts as nothing."""
    return _CLOSE * abs(time)


def _is_continuous(variable: VariableInfo) -> bool:
    return variable.type == "Real" and variable.variability == "continuous"
