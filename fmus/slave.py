"""A model as an FMI 2.0 co-simulation slave, run by pythonfmu's native library.

    instantiated, initialization    parameters and inputs can be set; outputs answer for the current ones:
                                    x_0 = initial(p, u), y = outputs(p, x_0[, u])
    exit of initialization          parameters outside their ranges are refused; then only inputs can be set
    do_step(t, dt)                  u.time = t; x = step(p, x, u, dt); y = outputs(p, x[, u])
    between steps                   outputs of a continuous model that feed through follow a changed input,
                                    at time t + dt; those of a sampled model hold

Errors. Every entry point catches whatever the model raises. pythonfmu can return three statuses only:
- do_step that fails logs a message of status Error (category `logStatusError`) with type and text of the
  exception and the place it was raised, leaves state and outputs as they were, and returns Discard; the
  native library then also answers fmi2Terminated = true.
- any other call that fails ends Fatal, and the native library writes the message. One of ours in the queue
  would reach the importer's logger while the exception is still set: in an importer in Python it gets lost
  ("unknown error", measured), and any call of the logger may trip over it.
- a step whose result is NaN or infinite is no error here: the importer checks what it receives.

What pythonfmu's library does wrong stands in `native`, which makes it good: a failing FMU never kills its
importer. Messages are printf formats (FMI 2.0, fmi2CallbackLogger) to which the library passes no arguments:
"%" is doubled. What nobody here can help: a KeyboardInterrupt that arrives before an entry point's first line
is a failed call that nothing holds; an importer in Python should handle SIGINT itself. fmi2Reset does not
clear fmi2Terminated. Messages of status Fatal carry no category. fmi2FreeFMUstate does not null the pointer.

Relative imports only: this file also runs inside FMUs, in a package of another name.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from ..models.base import Model, violations
from .layout import Layout, misfit
from .messages import Refused, SlaveError, message
from .native import hold, leave_search_path, settle_at_exit
from .snapshot import Snapshot, from_bytes, to_bytes

_ERROR = 3  # fmi2Error


class ModelSlave:
    """Mixin before pythonfmu's Fmi2Slave. A subclass names its `model` and the `identity` of its FMU."""

    # Python finds slots and what stands in the instance ten times faster than what its class has
    __slots__ = (
        "_feeds_through",
        "_follows_inputs",
        "_given",
        "_inputs",
        "_listed",
        "_outputs",
        "_parameters",
        "_real_inputs",
        "_real_outputs",
        "_record",
        "_settings",
        "_shown",
        "_stale",
        "_started",
        "_state",
        "_step",
        "_table",
        "_time",
        "_timed",
    )  # fmt: skip # words, not lines

    model: ClassVar[type[Model]]
    identity: ClassVar[str]
    log_categories: ClassVar[dict[str, str]] = {"logStatusError": "Exceptions that the model raised"}

    _layout: ClassVar[Layout]
    _living: ClassVar[weakref.WeakSet[ModelSlave]]

    instance_name: str
    resources: str
    log_queue: list[Any]
    log: Callable[[str, int, str], None]

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        cls._layout = Layout(cls.model)
        cls._living = weakref.WeakSet()

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        leave_search_path(self.resources)
        settle_at_exit(self.resources, type(self).__name__)
        self._table = layout = self._layout
        self._step, self._outputs = self.model.step, self.model.outputs
        self._record, self._listed = layout.record, layout.listed
        self._timed, self._feeds_through = layout.timed, layout.feeds_through
        self._follows_inputs = layout.follows_inputs
        self._real_inputs, self._real_outputs = layout.real_inputs, layout.real_outputs
        self._settings, self._given = layout.starts("parameter"), layout.starts("input")
        self._shown, self._time = layout.starts("output"), 0.0
        self._parameters: Any = None
        self._inputs: Any = None
        self._state: Any = None
        self._started = False
        self._stale = True  # outputs (and before the start the state) do not belong to the inputs
        self._living.add(self)

    # -- time ----------------------------------------------------------------------------------------------

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """fmi2SetupExperiment: the start time is what `initial` sees as time."""
        self._set_time(start_time)

    def exit_initialization_mode(self) -> None:
        """fmi2ExitInitializationMode: check the parameters, compute x_0, and fix the parameters."""
        try:
            self._initialize()
            self._started = True
        except BaseException as error:
            raise self._failure("fmi2ExitInitializationMode", error) from None

    def do_step(self, current_time: float, step_size: float) -> bool:
        """fmi2DoStep: True for OK, False for Discard."""
        try:
            if not self._started:
                raise Refused("the initialization mode has not been left")
            if self._timed:
                self._set_time(current_time)
            u = self._inputs
            if u is None:
                u = self._inputs = self._record(self._given, self._time)
            state = self._step(self._parameters, self._state, u, step_size)
            if self._timed and self._follows_inputs:
                self._set_time(current_time + step_size)
                u = None
            self._show(state, u)
            self._state = state
            return True
        except BaseException as error:
            self.log(message(f"fmi2DoStep at t = {current_time} s", error), _ERROR, "logStatusError")
            return False

    def _set_time(self, time: float) -> None:
        self._time = time
        if self._timed:
            self._inputs = None
            self._stale = self._stale or not self._started

    def _initialize(self) -> None:
        """x_0 and its outputs from the current parameters and inputs."""
        p = self._derive_parameters()
        if bad := violations(p):
            raise Refused("; ".join(bad))
        u = self._record(self._given, self._time)
        state = self.model.initial(p, u)
        self._parameters = p
        self._show(state, u)
        self._state = state

    def _derive_parameters(self) -> Any:
        return self.model.Parameters(*self._settings)

    def _show(self, state: Any, u: Any) -> None:
        """Store the outputs of a state; `u` None: of the inputs that are set now."""
        if self._feeds_through:
            if u is None:
                u = self._inputs = self._record(self._given, self._time)
            y = self._outputs(self._parameters, state, u)
        else:
            y = self._outputs(self._parameters, state)
        try:
            self._shown = self._listed(y)
        except (TypeError, ValueError, OverflowError):
            raise misfit(self._table, y) from None
        self._stale = False

    def _refresh(self) -> None:
        if self._started:
            self._show(self._state, self._inputs)
        else:
            self._initialize()

    # -- values --------------------------------------------------------------------------------------------

    def get_real(self, references: Sequence[int]) -> list[float]:
        """fmi2GetReal."""
        try:
            if self._stale:
                self._refresh()
            if references == self._real_outputs:
                return self._shown
            return self._table.read_real[tuple(references)](self)
        except BaseException as error:
            raise self._failure("fmi2GetReal", error) from None

    def get_integer(self, references: Sequence[int]) -> list[int]:
        """fmi2GetInteger, for Integer and Enumeration."""
        try:
            if self._stale:
                self._refresh()
            return self._table.read_integer[tuple(references)](self)
        except BaseException as error:
            raise self._failure("fmi2GetInteger", error) from None

    def get_boolean(self, references: Sequence[int]) -> list[bool]:
        """fmi2GetBoolean."""
        try:
            if self._stale:
                self._refresh()
            return self._table.read_boolean[tuple(references)](self)
        except BaseException as error:
            raise self._failure("fmi2GetBoolean", error) from None

    def get_string(self, references: Sequence[int]) -> list[str]:
        """fmi2GetString: there are no String variables."""
        try:
            if self._stale:
                self._refresh()
            return self._table.read_string[tuple(references)](self)
        except BaseException as error:
            raise self._failure("fmi2GetString", error) from None

    def set_real(self, references: Sequence[int], values: list[float]) -> None:
        """fmi2SetReal."""
        try:
            if references == self._real_inputs:
                self._given = values  # the native library has made this list for this call alone
                self._is_set()
            else:
                self._set("Real", references, values)
        except BaseException as error:
            raise self._failure("fmi2SetReal", error) from None

    def set_integer(self, references: Sequence[int], values: Sequence[int]) -> None:
        """fmi2SetInteger, for Integer and Enumeration; a number that is no item of the enumeration fails."""
        try:
            self._set(
                "Integer", references, [self._member(r, v) for r, v in zip(references, values, strict=True)]
            )
        except BaseException as error:
            raise self._failure("fmi2SetInteger", error) from None

    def set_boolean(self, references: Sequence[int], values: Sequence[bool]) -> None:
        """fmi2SetBoolean."""
        try:
            self._set("Boolean", references, values)
        except BaseException as error:
            raise self._failure("fmi2SetBoolean", error) from None

    def set_string(self, references: Sequence[int], values: Sequence[str]) -> None:
        """fmi2SetString: there are no String variables."""
        try:
            self._set("String", references, values)
        except BaseException as error:
            raise self._failure("fmi2SetString", error) from None

    def _set(self, kind: str, references: Sequence[int], values: Sequence[Any]) -> None:
        table = self._table
        settable = (table.settable_later if self._started else table.settable_first)[kind]
        if not settable.issuperset(references):
            raise table.refusal(kind, references, settable)
        for r, value in zip(references, values, strict=True):
            kept = self._settings if r < table.first_input else self._given
            kept[table.index[r]] = value
        self._is_set()

    def _is_set(self) -> None:
        self._inputs = None
        if self._follows_inputs or not self._started:
            self._stale = True

    def _member(self, reference: int, value: int) -> int:
        enumeration = self._table.enumerations.get(reference)
        if enumeration is None:
            return value
        try:
            return enumeration(value)
        except ValueError:
            items = ", ".join(f"{int(item)} {item.name.lower()}" for item in enumeration)
            name = self._table.variables[reference].name
            raise Refused(f"{name} = {value} is no item of its enumeration ({items})") from None

    # -- FMU state: pythonfmu calls the two conversions on the class -----------------------------------------

    def _get_fmu_state(self) -> Snapshot:
        values = (tuple(self._settings), tuple(self._given), tuple(self._shown), self._time)
        return Snapshot(values, self._state, self._started, self._stale)

    def _set_fmu_state(self, snapshot: Snapshot) -> None:
        try:
            if not isinstance(snapshot, Snapshot):
                raise Refused("this is no state of this FMU")
            settings, given, shown, self._time = snapshot.values
            self._settings, self._given, self._shown = list(settings), list(given), list(shown)
            self._state = snapshot.state
            self._started = snapshot.started
            self._stale = snapshot.stale
            self._inputs = None
            self._parameters = self._derive_parameters()
        except BaseException as error:
            raise self._failure("fmi2SetFMUstate", error) from None

    @classmethod
    def _fmu_state_to_bytes(cls, snapshot: Snapshot) -> bytes:
        try:
            return to_bytes(snapshot, cls.identity)
        except BaseException as error:
            raise cls._class_failure("fmi2SerializeFMUstate", error) from None

    @classmethod
    def _fmu_state_from_bytes(cls, data: bytes) -> Snapshot:
        try:
            return from_bytes(data, cls.identity)
        except BaseException as error:
            raise cls._class_failure("fmi2DeSerializeFMUstate", error) from None

    # -- failures ------------------------------------------------------------------------------------------

    def _failure(self, call: str, error: BaseException) -> SlaveError:
        hold(type(self), self, self.log_queue)
        return SlaveError(message(call, error))

    @classmethod
    def _class_failure(cls, call: str, error: BaseException) -> SlaveError:
        """Which instance made the call is unknown here: hold all. The others leak, the lesser evil."""
        hold(cls)
        for instance in list(cls._living):
            hold(instance, instance.log_queue)
        return SlaveError(message(call, error))
