"""CVODE of SUNDIALS (BSD-3-Clause), the solver of the Model Exchange units, as FMPy ships its library.

Backward differentiation formulas of order 1 to 5 with Newton's iteration and a dense Jacobian by differences:
stiff systems are its purpose. Sign changes of the event indicators are located to rounding. FMPy's own class
over the same library sets no stop time, so that it steps beyond the points at which inputs and events change
the equations, prints its errors, and releases nothing; that is why we call the library ourselves.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from .archive import FmuError

Function = Callable[[float, ctypes.c_void_p, ctypes.c_void_p], int]
"""(time [s], states, address of the answer) -> 0; 1: not possible here, a smaller step may be; -1: failed."""

_BDF, _ONE_STEP, _ROOT = 2, 2, 2
_CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
_NO_COMMUNICATOR = ctypes.c_int(0)
_REASONS = {
    -3: "the tolerance is not reached with the smallest step there is",
    -4: "Newton's iteration does not converge with the smallest step there is",
    -9: "the derivatives cannot be computed at the first point",
    -8: "the derivatives cannot be computed",
    -12: "the event indicators cannot be computed",
    -10: "the derivatives cannot be computed, however small the step",
}


class SolverError(Exception):
    """The solver cannot go on. The message is the reason, without place."""


class Cvode:
    """A solver for `states` differential equations that stops where one of `indicators` changes its sign.

    `x`, shape (states,), holds the states; `absolute` their absolute tolerances; both are the caller's to
    write before `restart`. Without states it follows the indicators over time alone.
    Raises FmuError where FMPy has no library for this machine.
    """

    def __init__(
        self,
        states: int,
        indicators: int,
        derivatives: Function | None,
        roots: Function | None,
        tolerance: float,
    ) -> None:
        self._library = _library()
        n = max(1, states)  # CVODE needs a state: that of none is constant
        self.x, self.absolute = (ctypes.c_double * n)(), (ctypes.c_double * n)(*[1.0] * n)
        self.time = 0.0
        self._error: BaseException | None = None
        self._started = False
        self._tolerance = ctypes.c_double(tolerance)
        self._reached, self._stop = ctypes.c_double(), ctypes.c_double()
        self._views: dict[int, ctypes.c_void_p] = {}
        self._derivatives, self._last = derivatives or _nothing, (0.0, 0)
        self._callbacks = (
            _CALLBACK(self._guarded(self._derivatives, self._data)),
            _CALLBACK(self._guarded(roots or _nothing, ctypes.c_void_p)),
        )
        self._make(n, indicators)

    def _make(self, n: int, indicators: int) -> None:
        call = self._library
        size = ctypes.c_int64(n)
        self._context = ctypes.c_void_p()
        call("core", "SUNContext_Create")(_NO_COMMUNICATOR, ctypes.byref(self._context))
        call("core", "SUNContext_ClearErrHandlers")(self._context)  # which print; we have the flags

        def made(library: str, name: str, *arguments: Any) -> ctypes.c_void_p:
            return ctypes.c_void_p(call(library, name, ctypes.c_void_p)(*arguments))

        self._y = made("nvecserial", "N_VMake_Serial", size, self.x, self._context)
        self._allowed = made("nvecserial", "N_VMake_Serial", size, self.absolute, self._context)
        self._matrix = made("sunmatrixdense", "SUNDenseMatrix", size, size, self._context)
        self._linear = made("sunlinsoldense", "SUNLinSol_Dense", self._y, self._matrix, self._context)
        self._memory = made("cvode", "CVodeCreate", ctypes.c_int(_BDF), self._context)
        self._indicators = ctypes.c_int(indicators)
        self._cvode = call("cvode", "CVode")
        self._set_stop_time = call("cvode", "CVodeSetStopTime")

    def _call(self, name: str, *arguments: Any) -> None:
        if flag := self._library("cvode", name)(self._memory, *arguments):
            raise SolverError(f"{name} gave {flag}")

    def _guarded(self, function: Function, answer: Callable[[int], ctypes.c_void_p]) -> Callable[..., int]:
        """Return `function` as CVODE calls it: an exception waits for the return, since C passes none on."""

        def guarded(time: float, states: int, target: int, _: Any) -> int:
            self._last = time, states
            try:
                return function(time, self._data(states), answer(target))
            except BaseException as error:
                self._error = error
                return -1

        return guarded

    def _data(self, vector: int) -> ctypes.c_void_p:
        """Return a view of the pointer to a vector's values: a view, since CVODE exchanges pointers."""
        if (view := self._views.get(vector)) is None:
            from fmpy.sundials.nvector_serial import _N_VectorContent_Serial as Content

            content = ctypes.c_void_p.from_address(vector).value or 0  # the first member of an N_Vector
            view = ctypes.c_void_p.from_address(content + Content.data.offset)
            self._views[vector] = view
        return view

    def restart(self, time: float) -> None:
        """Begin at `time` [s] from `x`, without a memory of the steps before."""
        at = ctypes.c_double(time)
        if self._started:
            self._call("CVodeReInit", at, self._y)
        else:
            self._call("CVodeInit", self._callbacks[0], at, self._y)
            self._call("CVodeSetLinearSolver", self._linear, self._matrix)
            if self._indicators.value:
                self._call("CVodeRootInit", self._indicators, self._callbacks[1])
                self._call("CVodeSetNoInactiveRootWarn")
            self._started = True
        self._call("CVodeSVtolerances", self._tolerance, self._allowed)
        self.time = time

    def step(self, stop: float) -> bool:
        """Do one step of the solver's own size, to `stop` [s] at the most; `time` and `x` are then its end.

        Returns True if it ended where an indicator changed its sign. Raises SolverError, and the errors of
        the functions.
        """
        self._stop.value, before = stop, self.time
        self._set_stop_time(self._memory, self._stop)
        flag: int = self._cvode(
            self._memory, self._stop, self._y, ctypes.byref(self._reached), ctypes.c_int(_ONE_STEP)
        )
        if flag < 0:
            self._fail(flag)
        self.time = self._reached.value
        if not self.time > before and flag != _ROOT:
            raise SolverError("its step size is below the rounding of time")
        return flag == _ROOT

    def _fail(self, flag: int) -> None:
        error, self._error = self._error, None
        if error is not None:
            raise error
        raise SolverError(_REASONS.get(flag, f"CVODE gave {flag}"))

    def last_derivatives(self) -> list[float]:
        """Evaluate the derivatives once more where the functions were called last, and return them.

        They are zeros where the functions were not called yet.
        """
        (time, states), answer = self._last, (ctypes.c_double * len(self.x))()
        if states:
            self._derivatives(time, self._data(states), ctypes.cast(answer, ctypes.c_void_p))
        return list(answer)

    def close(self) -> None:
        """Release everything."""
        call = self._library
        call("cvode", "CVodeFree", None)(ctypes.byref(self._memory))
        call("core", "SUNLinSolFree")(self._linear)
        call("core", "SUNMatDestroy", None)(self._matrix)
        for vector in (self._y, self._allowed):
            call("core", "N_VDestroy", None)(vector)
        call("core", "SUNContext_Free")(ctypes.byref(self._context))


def _nothing(_time: float, _states: ctypes.c_void_p, answer: ctypes.c_void_p) -> int:
    ctypes.memset(answer, 0, ctypes.sizeof(ctypes.c_double))
    return 0


def _library() -> Callable[..., Any]:
    """Return (library, function, result) -> the C function, which keeps Python's lock for the callbacks."""
    try:
        from fmpy.sundials import libraries
    except Exception as error:  # OSError; FMPy raises a plain Exception for another version
        raise FmuError(f"Model Exchange needs the solver CVODE, which FMPy lacks here: {error}") from error

    def function(library: str, name: str, result: Any = ctypes.c_int) -> Any:
        handle = getattr(libraries, f"sundials_{library}")._handle
        found = ctypes.PyDLL(None, handle=handle)[name]
        found.restype = result
        return found

    return function
