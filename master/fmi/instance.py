"""What the units of all FMI versions share: the transfers of a step, single values, statuses, the end.

A subclass names the library and its C functions: FMI 1.0, 2.0 and 3.0 differ in the names of types, in the
order of the calls before the first step, and in what a step answers. In a step we call the function pointers
with arguments made once: value references, counts, and buffers that are parts of the run's memory where the
FMI type is that of the memory.
"""

from __future__ import annotations

import ctypes
import os
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ...cosim.interface import UnitInterface, VariableInfo
from ...cosim.plan import Block, UnitPlan
from ..unit import UnitError, Value, floats
from .fmu import Fmu, FmuError, check_runnable
from .library import Library
from .log import STATUS, UnitLog

_WARNING = 1
_WHOLE = 2.0**53  # beyond it a double does not hold every whole number
Call = Callable[[], None]


class Instance:
    """An instance of an FMU in this process. See `unit.Unit` for the order of the calls.

    `interface` is how the system sees it, where that is not as the FMU declares it.
    Raises FmuError when the FMU cannot be run here or instantiated, UnitError when a call fails.
    """

    fmi: str
    """What the names of the C functions begin with."""

    def __init__(self, fmu: Fmu, name: str, interface: UnitInterface | None = None) -> None:
        check_runnable(fmu)
        self.name = name
        self.fmu = fmu
        self.interface = interface or fmu.interface
        self.log = UnitLog()
        self._declared = {v.name: v for v in fmu.description.modelVariables}
        self._component: Any = None
        self._library: Any = None
        self._initialized = False
        self._single: dict[tuple[str, str], Any] = {}
        folder = fmu.extract()
        self._folder: Path | None = folder
        try:
            self._library = self._load(folder)
            with self.log.instantiating():
                component = self._instantiate(folder)
            if not component:
                said = self.log.last()
                raise FmuError(f"{fmu.path}: cannot be instantiated{_because(said)}")
            self._component = ctypes.c_void_p(component)
        except BaseException:
            self.free()
            raise
        # the calls of a turn (see `unit.Unit`), which `bind` makes
        self.set_inputs: Call = _one_after_the_other()
        self.get_feedthrough: Call = _one_after_the_other()
        self.get_outputs: Call = _one_after_the_other()

    # ---- what differs between the versions

    def _instantiate(self, folder: Path) -> int | None:
        """Call the version's function; the component, or None (0) when the FMU refuses."""
        raise NotImplementedError

    def _access(self, direction: str, variable: VariableInfo) -> tuple[str, Any]:
        """The name of the function that gets or sets a variable, and the ctypes type of its values."""
        raise NotImplementedError

    def _arguments(self, references: Any, count: int, values: Any) -> tuple[Any, ...]:
        """The arguments of a function that gets or sets values."""
        return self._component, references, ctypes.c_size_t(count), values

    def _load(self, folder: Path) -> Library:
        path = folder / self.fmu.binary
        try:
            return Library(path, self._prefix(), keeps_lock=self.fmu.holds_python)
        except OSError as error:
            reason = str(error).replace(str(path), self.fmu.binary)
            raise FmuError(f"{self.fmu.path}: its library cannot be loaded: {reason}") from error

    def _prefix(self) -> str:
        return ""

    def function(self, name: str, result: Any = ctypes.c_int) -> Any:
        """A C function of the FMU. Raises FmuError when its library lacks it."""
        try:
            return self._library.function(name, result)
        except AttributeError as error:
            raise FmuError(f"{self.fmu.path}: {self.fmu.binary} lacks the function {name}") from error

    @property
    def warnings(self) -> int:
        """See `unit.Unit`."""
        return self.log.warnings

    # ---- before the steps

    def bind(self, memory: NDArray[np.float64], plan: UnitPlan) -> None:
        """See `unit.Unit`. Makes the calls of a turn, with all their arguments."""
        inputs: list[Call] = []
        through: list[Call] = []
        outputs: list[Call] = []
        for block in plan.blocks:
            if block.kind == "input":
                inputs += self._transfers("Set", memory, block.variables, block.slot)
            elif block.kind == "discrete":
                outputs += self._transfers("Get", memory, block.variables, block.slot)
            else:
                outputs += self._transfers("Get", memory, block.variables, block.latest)
                through += self._feedthrough(memory, block)
        self.set_inputs = _one_after_the_other(*inputs)
        self.get_feedthrough = _one_after_the_other(*through)
        self.get_outputs = _one_after_the_other(*outputs)

    def _feedthrough(self, memory: NDArray[np.float64], block: Block) -> list[Call]:
        if not block.feedthrough:
            return []
        transfers = self._transfers("Get", memory, block.variables[: block.feedthrough], block.latest)
        return [*transfers, _copy(memory, block.latest, block.slot, block.feedthrough)]

    def _transfers(
        self, direction: str, memory: NDArray[np.float64], variables: Sequence[VariableInfo], slot: int
    ) -> list[Call]:
        """Calls without arguments that move values between unit and memory, from `slot` on.

        One for each function: what is one type in a plan may be several in FMI 3.0.
        """
        groups: dict[tuple[str, Any], list[int]] = {}
        for i, variable in enumerate(variables):
            groups.setdefault(self._access(direction, variable), []).append(i)
        return [
            self._transfer(direction, name, c_type, memory, slot, [(i, variables[i]) for i in members])
            for (name, c_type), members in groups.items()
        ]

    def _transfer(
        self,
        direction: str,
        name: str,
        c_type: Any,
        memory: NDArray[np.float64],
        slot: int,
        members: list[tuple[int, VariableInfo]],
    ) -> Call:
        n = len(members)
        references = (ctypes.c_uint * n)(*(self._reference(v.name) for _, v in members))
        places = [slot + i for i, _ in members]
        first = places[0]
        together = places == list(range(first, first + n))
        in_place = c_type is ctypes.c_double and together and not any(v.inverted for _, v in members)
        part = memory[first : first + n] if together else memory
        values = (c_type * n).from_buffer(part.data) if in_place else (c_type * n)()
        function, arguments = self.function(name), self._arguments(references, n, values)

        def call() -> None:
            status = function(*arguments)
            if status:
                self._judge(name, status)

        if in_place:
            return call
        at: Any = slice(None) if together else np.array(places)
        signs = np.array([-1.0 if v.inverted else 1.0 for _, v in members])
        own = np.frombuffer(values, dtype=c_type)
        return _through_buffer(direction, call, part, at, own, signs, self._whole(direction, name, members))

    def _whole(
        self, direction: str, name: str, members: list[tuple[int, VariableInfo]]
    ) -> Callable[[NDArray[Any]], None] | None:
        """What checks 64-bit integers: those that a double does not hold would come out as others."""
        if direction != "Get" or not name.endswith("Int64"):
            return None

        def check(values: NDArray[Any]) -> None:
            for (_, variable), value in zip(members, values.tolist(), strict=True):
                if abs(value) > _WHOLE:
                    raise UnitError(
                        f"unit '{self.name}': {variable.name} = {value} is more than a double holds (2^53)"
                    )

        return check

    def _reference(self, name: str) -> int:
        """The value reference of a variable, by the name that the system uses."""
        return int(self._declared[self.interface.variables[name].declared_name].valueReference)

    # ---- single values

    def get(self, name: str) -> Value:
        """See `unit.Unit`."""
        variable = self.interface.variables[name]
        function, c_type = self._access("Get", variable)
        buffer = (c_type * 1)()
        self._call(function, *self._arguments((ctypes.c_uint * 1)(self._reference(name)), 1, buffer), of=name)
        if c_type is ctypes.c_char_p:
            return str((buffer[0] or b"").decode("utf-8", "replace"))
        value = buffer[0]
        if variable.type == "Boolean":
            return bool(value if not isinstance(value, bytes) else value[0])
        number = float(value) if variable.type == "Real" else int(value)
        return -number if variable.inverted else number

    def set(self, name: str, value: Value) -> None:
        """See `unit.Unit`."""
        variable = self.interface.variables[name]
        function, c_type = self._access("Set", variable)
        if isinstance(value, str):
            buffer = (c_type * 1)(value.encode())
        else:
            number = -value if variable.inverted else value
            buffer = (c_type * 1)(number)
        self._call(function, *self._arguments((ctypes.c_uint * 1)(self._reference(name)), 1, buffer), of=name)

    # ---- the end

    def finish_step(self) -> None:
        """See `unit.Unit`: nothing is left to do."""

    def terminate(self) -> None:
        """See `unit.Unit`."""
        if self._initialized:
            self._initialized = False
            self._call(f"{self.fmi}Terminate", self._component)

    def free(self) -> None:
        """See `unit.Unit`."""
        component, self._component = self._component, None
        library, self._library = self._library, None
        if library is not None:
            if component is not None and component.value:
                self._free_instance(library, component)
            library.close()
        self.log.close()
        folder, self._folder = self._folder, None
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)

    def _free_instance(self, library: Library, component: Any) -> None:
        library.function(f"{self.fmi}FreeInstance", None)(component)

    # ---- what a call answers

    def _call(self, name: str, *arguments: Any, of: str = "") -> None:
        """Call a C function and judge its status; `of` is the variable that it is about."""
        status = self.function(name)(*arguments)
        if status:
            self._judge(f"{name} of {of}" if of else name, status)

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


def resources_path(folder: Path) -> bytes:
    """FMI 3.0's resourcePath: the path of the resources with a separator behind it."""
    return os.fsencode(folder / "resources") + os.sep.encode()


def _because(said: str) -> str:
    return f":\n{said}" if said else ": its instantiate function returned nothing and no message"


def _one_after_the_other(*calls: Call) -> Call:
    if len(calls) == 1:
        return calls[0]

    def all_of_them() -> None:
        for call in calls:
            call()

    return all_of_them


def _through_buffer(
    direction: str,
    call: Call,
    part: NDArray[np.float64],
    at: Any,
    own: NDArray[Any],
    signs: NDArray[np.float64],
    check: Callable[[NDArray[Any]], None] | None,
) -> Call:
    """The call between values of another type or sign, `own`, and those of the memory, `part[at]`."""

    def set_own() -> None:
        np.multiply(part[at], signs, out=own, casting="unsafe")
        call()

    def get_own() -> None:
        call()
        if check is not None:
            check(own)
        part[at] = own * signs

    return set_own if direction == "Set" else get_own


def _copy(memory: NDArray[np.float64], source: int, target: int, count: int) -> Call:
    view = floats(memory)
    values, place = view[source : source + count], slice(target, target + count)

    def copy() -> None:
        view[place] = values

    return copy
