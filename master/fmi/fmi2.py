"""A loaded FMI 2.0 Co-Simulation unit: FMPy loads the library, the calls of a step go to it directly.

FMPy's wrappers build lists and look functions up by name in every call. In a step we call the function
pointers with arguments made once: value references, counts, and buffers that are parts of the run's memory.
"""

from __future__ import annotations

import ctypes
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from fmpy.fmi2 import FMU2Slave, fmi2CoSimulation
from numpy.typing import NDArray

from ...cosim.interface import UnitInterface, VariableInfo
from ...cosim.plan import Block, UnitPlan
from ..unit import UnitError, Value, floats
from .fmu import Fmu, FmuError, check_runnable
from .log import STATUS, UnitLog

_WARNING = 1
_INVISIBLE, _LOGGING = 0, 1  # fmi2Boolean
_C_TYPES: dict[str, Any] = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int}
_FMI_TYPE = {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean"}
Call = Callable[[], None]


class Fmi2Unit:
    """An instance of an FMU in this process. See `unit.Unit` for the order of the calls.

    `interface` is how the system sees it, where that is not as the FMU declares it.
    Raises FmuError when the FMU cannot be run here or instantiated, UnitError when a call fails.
    """

    def __init__(self, fmu: Fmu, name: str, interface: UnitInterface | None = None) -> None:
        check_runnable(fmu)
        self.name = name
        self.fmu = fmu
        self.interface = interface or fmu.interface
        self.log = UnitLog()
        references = {v.name: int(v.valueReference) for v in fmu.description.modelVariables}
        self._references = {v.name: references[v.declared_name] for v in self.interface.variables.values()}
        folder = fmu.extract()
        self._folder: Path | None = folder
        self._slave: Any = None
        self._initialized = False
        try:
            self._instantiate(folder)
        except BaseException:
            self.free()
            raise
        # the calls of a step (see `unit.Unit`), which `bind` makes
        self.set_inputs: Call = _one_after_the_other()
        self.get_feedthrough: Call = _one_after_the_other()
        self.get_outputs: Call = _one_after_the_other()

    def _instantiate(self, folder: Path) -> None:
        md = self.fmu.description
        try:
            self._slave = FMU2Slave(
                guid=md.guid,
                unzipDirectory=str(folder),
                modelIdentifier=md.coSimulation.modelIdentifier,
                instanceName=self.name,
            )
        except Exception as error:  # FMPy raises plain Exception when the library does not load
            raise FmuError(f"{self.fmu.path}: {error}") from error
        self._callbacks = self.log.callbacks()
        # not by FMPy's `instantiate`, which gives the resources' URI in a form that pythonfmu cannot read
        self._slave.component = self._slave.fmi2Instantiate(
            self.name.encode(),
            fmi2CoSimulation,
            md.guid.encode(),
            self.fmu.resources_uri(folder),
            ctypes.byref(self._callbacks),
            _INVISIBLE,
            _LOGGING,
        )
        if self._slave.component is None:
            said = self.log.last()
            raise FmuError(f"{self.fmu.path}: cannot be instantiated" + (f":\n{said}" if said else ""))
        self._component = ctypes.c_void_p(self._slave.component)
        self._do_step = self._function("fmi2DoStep")
        self._time, self._step_size, self._no_set_state = (
            ctypes.c_double(),
            ctypes.c_double(),
            ctypes.c_int(1),
        )

    def _function(self, name: str) -> Any:
        """A function of the library without argument types: what is passed must be ctypes objects, which are
        then passed on as they are, in a third of the time (FMPy's own function objects have types).

        The calls into a pythonfmu FMU come back into this interpreter at once: keeping the interpreter
        lock over them saves handing it over twice. Any other library is called without the lock.
        """
        handle = self._slave.dll._handle
        library = (
            ctypes.PyDLL(None, handle=handle) if self.fmu.holds_python else ctypes.CDLL(None, handle=handle)
        )
        function = library[name]
        function.restype = ctypes.c_int
        return function

    @property
    def warnings(self) -> int:
        """See `unit.Unit`."""
        return self.log.warnings

    # ---- before the steps

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        """See `unit.Unit`. Makes the calls of a step, with all their arguments."""
        inputs, through, outputs = [], [], []
        for block in plan.blocks:
            if block.kind == "input":
                inputs.append(self._transfer("Set", memory, block, block.slot))
            elif block.kind == "discrete":
                outputs.append(self._transfer("Get", memory, block, block.slot))
            else:
                outputs.append(self._transfer("Get", memory, block, block.latest))
                if block.feedthrough:
                    through.append(self._transfer("Get", memory, block, block.latest, block.feedthrough))
                    through.append(_copy(memory, block.latest, block.slot, block.feedthrough))
        self.set_inputs = _one_after_the_other(*inputs)
        self.get_feedthrough = _one_after_the_other(*through)
        self.get_outputs = _one_after_the_other(*outputs)

    def _transfer(
        self, direction: str, memory: NDArray[np.float64], block: Block, slot: int, count: int | None = None
    ) -> Call:
        """A call without arguments that moves the first `count` values of a block between unit and memory."""
        variables = block.variables[:count]
        n = len(variables)
        references = (ctypes.c_uint * n)(*(self._references[v.name] for v in variables))
        signs = _signs(variables)
        c_type = _C_TYPES[block.type]
        name = f"fmi2{direction}{block.type}"
        function = self._function(name)
        part = memory[slot : slot + n]
        in_place = block.type == "Real" and signs is None
        values = (c_type * n).from_buffer(part.data) if in_place else (c_type * n)()
        component, size = self._component, ctypes.c_size_t(n)

        def call() -> None:
            status = function(component, references, size, values)
            if status:
                self._judge(name, status)

        if in_place:
            return call

        own = np.frombuffer(values, dtype=c_type)
        factors = 1 if signs is None else signs

        def set_own() -> None:
            np.multiply(part, factors, out=own, casting="unsafe")
            call()

        def get_own() -> None:
            call()
            np.multiply(own, factors, out=part)

        return set_own if direction == "Set" else get_own

    def enter_initialization(self, start_time: float, stop_time: float | None) -> None:
        """See `unit.Unit`."""
        self._checked(
            "fmi2SetupExperiment", self._slave.setupExperiment, startTime=start_time, stopTime=stop_time
        )
        self._checked("fmi2EnterInitializationMode", self._slave.enterInitializationMode)

    def exit_initialization(self) -> None:
        """See `unit.Unit`."""
        self._checked("fmi2ExitInitializationMode", self._slave.exitInitializationMode)
        self._initialized = True

    def get(self, name: str) -> Value:
        """See `unit.Unit`."""
        kind, reference = self._typed(name)
        value = self._checked(f"fmi2Get{kind} of {name}", getattr(self._slave, f"get{kind}"), [reference])[0]
        if self.interface.variables[name].inverted:
            value = -value
        if kind == "String":
            return str(value.decode("utf-8", "replace"))
        if kind == "Boolean":
            return bool(value)
        return float(value) if kind == "Real" else int(value)

    def set(self, name: str, value: Value) -> None:
        """See `unit.Unit`."""
        kind, reference = self._typed(name)
        if self.interface.variables[name].inverted:
            value = -value  # type: ignore[operator] # a String is never inverted
        self._checked(f"fmi2Set{kind} of {name}", getattr(self._slave, f"set{kind}"), [reference], [value])

    def _typed(self, name: str) -> tuple[str, int]:
        return _FMI_TYPE.get(self.interface.variables[name].type, "String"), self._references[name]

    # ---- the step

    def start_step(self, time: float, step_size: float, count: int) -> None:
        """See `unit.Unit`."""
        self._step_size.value = step_size
        for i in range(count):
            self._time.value = time + i * step_size
            status = self._do_step(self._component, self._time, self._step_size, self._no_set_state)
            if status:
                self._judge("fmi2DoStep", status)

    def finish_step(self) -> None:
        """See `unit.Unit`: nothing is left to do."""

    # ---- after the steps

    def terminate(self) -> None:
        """See `unit.Unit`."""
        if self._initialized:
            self._initialized = False
            self._checked("fmi2Terminate", self._slave.terminate)

    def free(self) -> None:
        """See `unit.Unit`."""
        slave, self._slave = self._slave, None
        if slave is not None:
            if slave.component is not None:
                slave.freeInstance()
            else:
                slave.freeLibrary()
        self.log.close()
        folder, self._folder = self._folder, None
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)

    # ---- what a call answers

    def _checked(self, what: str, function: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        """Call a wrapper of FMPy, which raises on a status worse than Warning."""
        from fmpy.fmi1 import FMICallException

        try:
            return function(*arguments, **options)
        except FMICallException as error:
            self._fail(what, error.status)

    def _judge(self, what: str, status: int) -> None:
        if status > _WARNING or status < 0:
            self._fail(what, status)
        self.log.warnings += 1

    def _fail(self, what: str, status: int) -> NoReturn:
        if self.fmu.holds_python and "KeyboardInterrupt" in self.log.last(1):
            raise KeyboardInterrupt  # Ctrl-C reached the interpreter while it was inside the model
        word = STATUS[status] if 0 <= status < len(STATUS) else "no FMI status"
        said = self.log.last()
        raise UnitError(
            f"unit '{self.name}': {what} returned {word} ({status})" + (f"\n{said}" if said else "")
        )


def _one_after_the_other(*calls: Call) -> Call:
    if len(calls) == 1:
        return calls[0]

    def all_of_them() -> None:
        for call in calls:
            call()

    return all_of_them


def _signs(variables: tuple[VariableInfo, ...]) -> NDArray[np.float64] | None:
    """-1 for each inverted variable, 1 for the others; None where none is inverted."""
    if not any(v.inverted for v in variables):
        return None
    return np.array([-1.0 if v.inverted else 1.0 for v in variables])


def _copy(memory: NDArray[np.float64], source: int, target: int, count: int) -> Call:
    view = floats(memory)
    values, place = view[source : source + count], slice(target, target + count)

    def copy() -> None:
        view[place] = values

    return copy
