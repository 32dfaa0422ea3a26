"""An FMU in this process: its life from loading to freeing, single values, and the statuses of its calls.

FMI 1.0, 2.0 and 3.0 differ in the names of types, in the order of the calls before the first step, and in
what a step returns. In a step we call function pointers with arguments made once (`binding`).

A class for a version or a kind (Co-Simulation, Model Exchange) defines, described there:
  `fmi`               the first part of the names of its C functions; `_prefix`: the text before that
  `_instantiate`      the one call that makes the component
  `arguments`         those of a function that gets or sets values, where they are not those of FMI 2.0
  `_set_up`, `_enter`    the two parts of `enter_initialization`
  `exit_initialization`, `start_step`; `_free_instance`, where it has another name
and has for its own C functions `_call` (once or seldom), `function` with `_judge` (in a step) and `_fail`.
A class that does more around a transfer wraps the calls that `bind` makes: `set_inputs`, `get_feedthrough`,
`get_outputs`.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ...cosim.interface import UnitInterface, Value, VariableInfo
from ...cosim.plan.unit_plan import UnitPlan
from ...cosim.visible import on_one_line
from ..unit import NO_VALUES, UnitError
from . import crash, folders
from .binding import Binding
from .fmu import Fmu, FmuError, check_runnable
from .library import Library, load_library
from .log import STATUS, UnitLog
from .refusal import why_refused
from .state import States
from .tolerance import tolerance_of
from .transfer import Call, Copy, StepCall, Transfer, fits, one_after_the_other, rule
from .types import REAL, FmiType, fmi_type

_WARNING = 1
_TROUBLE = ("warn", "discard", "error", "fatal", "pending")


class Instance:
    """An instance of an FMU in this process: a `unit.Unit`, which describes the calls and their order.

    `interface` is the system's view of the unit, where that is not as the FMU declares it.
    Raises FmuError when the FMU cannot be run here or instantiated, UnitError when a call fails.
    """

    apart = False
    fmi: str
    """The first part of the names of the C functions."""
    _true: Any = ctypes.c_int(1)
    """True as an argument of a C function."""
    _takes_inputs = "within it"
    """The time when an FMU that refuses inputs before the initialization gets them."""
    _statuses = 6
    """The number of statuses of the version."""
    step_call: StepCall | None = None
    """The C step function with its arguments; None before `exit_initialization`."""
    asked_end: float | None = None

    def __init__(
        self,
        fmu: Fmu,
        name: str,
        interface: UnitInterface | None = None,
        tolerance: float | None = None,
    ) -> None:
        check_runnable(fmu)
        self.tolerance, _ = tolerance_of(fmu, tolerance)
        """The relative tolerance that the FMU, or the solver, gets; None: none."""
        self.name = name
        self.fmu = fmu
        self.interface = interface or fmu.interface
        self.log = UnitLog()
        self._declared = {v.name: v for v in fmu.description.modelVariables}
        self._component: Any = None
        self._library: Any = None
        self._initialized = False
        self.told_texts: dict[str, str] = {}  # by variable
        self._bound_to: tuple[NDArray[np.float64], UnitPlan] | None = None
        self._folder: Path | None = None
        self._crash_note = self._joined_crash_report()
        try:
            self._folder = folders.take(fmu, name)
            self._open(self._folder)
        except BaseException:
            self.free()
            raise
        # made by `bind`: the transfers of a turn, and the calls of `unit.Unit` that do them
        self.inputs: list[Transfer] = []
        self.through: list[Transfer | Copy] = []
        self.outputs: list[Transfer] = []
        self.set_inputs: Call = one_after_the_other()
        self.get_feedthrough: Call = one_after_the_other()
        self.get_outputs: Call = one_after_the_other()

    def _open(self, folder: Path) -> None:
        """Load the library from the extracted FMU and instantiate."""
        self._library = load_library(self.fmu, folder, self._prefix())
        with self.log.instantiating():
            component = self._instantiate(folder)
        if not component:
            reason = why_refused(self.fmu, folder / self.fmu.binary, self.log.last())
            clause, *said = reason.split("\n")
            raise FmuError(f"{self.fmu.path}: cannot be instantiated{clause}", *said)
        self._component = ctypes.c_void_p(component)
        self._listen_to_trouble()

    def _open_anew(self) -> None:
        """Free the instance and its library, load and instantiate it again, and bind it as it was."""
        self._close()
        assert self._folder is not None  # it is taken before the first instance, and given back with the last
        self._open(self._folder)
        if self._bound_to is not None:
            self.bind(*self._bound_to)

    def _joined_crash_report(self) -> Call:
        """Return a call that notes that this unit is called now; without a report it does nothing."""
        report = crash.report()
        if report is None:
            return one_after_the_other()
        note = report.add(self, self.name, self.fmu.path.name, self.fmu.holds_python)
        note()
        return note

    def _noting(self, call: Call) -> Call:
        """Return a call of a turn; where there is a crash report, it notes first that this unit is called."""
        return call if crash.report() is None else one_after_the_other(self._crash_note, call)

    def _listen_to_trouble(self) -> None:
        """Choose the log categories of trouble. Those that log each call cost more than steps, and drown the
        reason of a failure. An FMU that declares no category of trouble goes on logging all."""
        names = [c.name or "" for c in self.fmu.description.logCategories]
        chosen = [name for name in names if any(word in name.lower() for word in _TROUBLE)]
        function = f"{self.fmi}SetDebugLogging"
        if chosen and len(chosen) < len(names) and self._library.has(function):
            texts = (ctypes.c_char_p * len(chosen))(*(name.encode() for name in chosen))
            # an FMU that refuses goes on logging all
            self.function(function)(self._component, self._true, ctypes.c_size_t(len(chosen)), texts)

    # ---- what differs between the versions

    def _instantiate(self, folder: Path) -> int | None:
        """Call the version's function and return the component, or None (0) when the FMU refuses."""
        raise NotImplementedError

    def arguments(self, references: Any, count: int, values: Any) -> tuple[Any, ...]:
        """Return the arguments of a function that gets or sets `count` values."""
        return self._component, references, ctypes.c_size_t(count), values

    def _prefix(self) -> str:
        return ""

    def function(self, name: str, result: Any = ctypes.c_int) -> Any:
        """Return a C function of the FMU. Raises FmuError when its library lacks it."""
        try:
            return self._library.function(name, result)
        except AttributeError as error:
            raise FmuError(f"{self.fmu.path}: {self.fmu.binary} lacks the function {name}") from error

    @property
    def warnings(self) -> int:
        return self.log.warnings

    @property
    def warned(self) -> Mapping[str, int]:
        return self.log.kinds.counts

    # ---- before the steps

    def enter_initialization(
        self,
        start_time: float,
        stop_time: float | None,
        values: Mapping[str, Value] = NO_VALUES,
        inputs: Mapping[str, Value] = NO_VALUES,
    ) -> str:
        """Set up the experiment, then values and inputs, and enter initialization mode.

        FMI 2.0 lets an FMU refuse inputs before it, and after an error nothing but a new instance goes on.
        """
        self._prepare(start_time, stop_time, values)
        refusal = self._refusal_of(inputs)
        if refusal:
            self._open_anew()
            self._prepare(start_time, stop_time, values)
        self._enter()
        return refusal

    def _prepare(self, start_time: float, stop_time: float | None, values: Mapping[str, Value]) -> None:
        """Set up the experiment first: some FMUs compute their parameters there."""
        self._set_up(start_time, stop_time)
        for name, value in values.items():
            self.set(name, value)

    def _refusal_of(self, inputs: Mapping[str, Value]) -> str:
        """Set inputs, and return a sentence if the FMU takes one not yet; "" if it took all."""
        try:
            for name, value in inputs.items():
                self.set(name, value)
        except UnitError as error:
            said = f"{str(error).splitlines()[0]} before the initialization"
            return f"{said}; instantiated anew, it gets its inputs {self._takes_inputs} only"
        return ""

    def _set_up(self, start_time: float, stop_time: float | None) -> None:
        """Set up the experiment (times in s), or note it where the version has no call of its own for it."""
        raise NotImplementedError

    def _enter(self) -> None:
        """Enter initialization mode."""
        raise NotImplementedError

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        """Make the calls of a turn, with all their arguments. `memory` has the shape (size,)."""
        self._bound_to = memory, plan
        self.told_texts = {}
        binding = self.binding = Binding(self, memory, plan.texts)
        self.inputs, self.through, self.outputs = [], [], []
        for group in plan.groups:
            if group.kind == "input":
                self.inputs += binding.transfers("Set", plan.set_in_steps(group))
            elif group.kind == "sampled":
                self.outputs += binding.transfers("Get", enumerate(group.variables, group.slot))
            else:
                self.outputs += binding.transfers("Get", enumerate(group.variables, group.latest))
                self.through += binding.feedthrough(group)
        self.set_inputs = self._noting(binding.calls(self.inputs))  # with which the turn of a unit begins
        self.get_feedthrough = binding.calls(self.through)
        self.get_outputs = self._noting(binding.calls(self.outputs))

    def judge_transfer(self, transfer: Transfer, status: int) -> None:
        """Count a warning, or raise UnitError, for the status of a transfer."""
        self._judge(transfer.function, status)

    def judge_step(self, status: int) -> None:
        """Count a warning, or raise UnitError, for the status of a step, or for one that was the last."""
        raise NotImplementedError

    @property
    def component(self) -> int:
        """The address of the instance in the library."""
        return int(self._component.value)

    def refuse(self, transfer: Transfer, place: int, value: float) -> NoReturn:
        """Raise UnitError for a value of a transfer that its type, or a double, does not hold."""
        self._refuse(transfer.items[place].variable, value, transfer.function)

    def _refuse(self, variable: VariableInfo, value: float, function: str) -> NoReturn:
        name = on_one_line(variable.name)
        if "Get" in function:
            raise UnitError(f"unit '{self.name}': {name} = {value} is more than a double holds (2^53)")
        kind = self.type_of(variable)
        raise UnitError(
            f"unit '{self.name}': {name} cannot be set to {value:.17g}: {rule(value, kind, variable)}"
        )

    def type_of(self, variable: VariableInfo) -> FmiType:
        """Return the FMI type of a variable of the unit's interface."""
        kind = fmi_type(self.fmu.description.fmiVersion, self._declared[variable.declared_name].type)
        assert kind is not None  # the interface has no other variables
        return kind

    def reference(self, name: str) -> int:
        """Return the value reference of a variable, by the name that the system uses."""
        return int(self._declared[self.interface.variables[name].declared_name].valueReference)

    # ---- single values

    def get(self, name: str) -> Value:
        variable = self.interface.variables[name]
        kind = self.type_of(variable)
        buffer = (kind.c_type * 1)()
        self._access("Get", kind, name, buffer)
        value = kind.kind.from_c(buffer[0])
        if isinstance(value, bool | str):
            return value
        if not variable.scaling.identity:
            return variable.from_fmu(value)
        return -value if variable.inverted else value

    def set(self, name: str, value: Value) -> None:
        variable = self.interface.variables[name]
        kind = self.type_of(variable)
        if isinstance(value, str):
            buffer = (kind.c_type * 1)(value.encode())
            self.told_texts[name] = value
        else:
            number = -value if variable.inverted else value
            if not variable.scaling.identity:
                number = variable.to_fmu(value)
            if not fits(number, kind, variable):
                self._refuse(variable, number, "Set")
            buffer = (kind.c_type * 1)(number if kind.kind is REAL else int(number))
        self._access("Set", kind, name, buffer)

    def _access(self, direction: str, kind: FmiType, name: str, buffer: Any) -> None:
        """Get or set the value of one variable in a buffer."""
        arguments = self.arguments((ctypes.c_uint * 1)(self.reference(name)), 1, buffer)
        self._call(f"{self.fmi}{direction}{kind.accessed}", *arguments, of=name)

    # ---- its state (see `state.States`)

    @functools.cached_property
    def _states(self) -> States:
        return States(self)

    def save_state(self) -> int:
        """Save the state and return its number."""
        return self._states.save()

    def restore_state(self, number: int) -> None:
        """Go back to a saved state."""
        self._states.restore(number)

    def free_state(self, number: int) -> None:
        """Forget a saved state."""
        self._states.free(number)

    def call(self, name: str, *arguments: Any) -> None:
        """Call a C function on the component and judge its status. Raises FmuError where it is missing."""
        self._call(name, self._component, *arguments)

    # ---- the end

    def finish_step(self) -> None:
        """Return at once: `start_step` has done the steps."""

    def terminate(self) -> None:
        if self._initialized:
            self._initialized = False
            self._end(f"{self.fmi}Terminate")

    def _end(self, name: str) -> None:
        """Call the function that terminates; a library that lacks it ends without."""
        if self._library.has(name):
            self._call(name, self._component)
        else:
            self.log.add(_WARNING, f"the library lacks the function {name}")

    def free(self) -> None:
        self._close()
        self.log.close()
        if (report := crash.report()) is not None:
            report.remove(self)
        folder, self._folder = self._folder, None
        if folder is not None:
            folders.give_back(self.fmu, self.name)

    def _close(self) -> None:
        """Free the instance and unload its library."""
        component, self._component = self._component, None
        library, self._library = self._library, None
        self._crash_note()
        if library is not None:
            if component is not None and component.value:
                with contextlib.suppress(AttributeError):  # a library that lacks the function frees nothing
                    self._free_instance(library, component)
            library.close()

    def _free_instance(self, library: Library, component: Any) -> None:
        library.function(f"{self.fmi}FreeInstance", None)(component)

    # ---- statuses

    def _call(self, name: str, *arguments: Any, of: str = "") -> None:
        """Call a C function and judge its status; `of` is the variable of the call."""
        self._crash_note()
        status = self.function(name)(*arguments)
        if status:
            self._judge(f"{name} of {on_one_line(of)}" if of else name, status)

    def _judge(self, what: str, status: int, also: str = "") -> None:
        if status > _WARNING or status < 0:
            self._fail(what, status, also)
        self.log.warnings += 1

    def _fail(self, what: str, status: int, also: str = "") -> NoReturn:
        """Raise UnitError; `also` is a clause that follows the status, with its punctuation."""
        if self.fmu.holds_python and "KeyboardInterrupt" in self.log.last(1):
            raise KeyboardInterrupt  # Ctrl-C reached the interpreter while it was inside the model
        word = STATUS[status] if 0 <= status < self._statuses else "no FMI status"
        raise UnitError(f"unit '{self.name}': {what} returned {word} ({status}){also}{self._said()}")

    def _said(self) -> str:
        """Return the unit's last messages on lines of their own; "" where there are none."""
        said = self.log.last()
        return f"\n{said}" if said else ""
