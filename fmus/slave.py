"""A model as an FMI 2.0 co-simulation slave, run by pythonfmu's native library.

    instantiated, initialization    parameters and inputs can be set; outputs are those of the current ones:
                                    x_0 = initial(p, u), y = outputs(p, x_0[, u])
    exit of initialization          parameters outside their ranges are refused; then only inputs can be set
    do_step(t, dt)                  u.time = t; x = step(p, x, u, dt); y = outputs(p, x[, u])
    between steps                   outputs of a continuous model that feed through follow a changed input,
                                    at time t + dt; those of a sampled model hold

Errors. Every entry point catches whatever the model raises. pythonfmu can return three statuses only:
- do_step that fails logs a message of status Error (category `logStatusError`) with type and text of the
  exception and the place it was raised, leaves state and outputs as they were, and returns Discard; the
  native library then also answers fmi2Terminated = true. A step that is not finite and longer than 0, and one
  after fmi2Terminate, fail.
- any other call that fails ends Fatal, and the native library writes the message. A message in the queue
  would reach the importer's logger while the exception is still set: an importer in Python loses it ("unknown
  error", measured), and any call of the logger may fail because of it.
- a step whose result is NaN or infinite is no error here: the importer checks what it receives.
A sentence of the model's `notice` is a message of status Warning (category `logStatusWarning`), once for each
instance; the step returns OK.

`repairs` mends defects of pythonfmu's library, so that a failing FMU never kills its importer. Messages are
printf formats (FMI 2.0, fmi2CallbackLogger) to which the library passes no arguments: "%" is doubled. Four
defects cannot be repaired from here. A KeyboardInterrupt that arrives before an entry point's first line is a
failed call that nothing holds; an importer in Python should handle SIGINT itself. fmi2Reset does not clear
fmi2Terminated. Messages of status Fatal carry no category. fmi2FreeFMUstate does not null the pointer.

Relative imports only: this file also runs inside FMUs, in a package of another name.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from ..models.base import Model, violations
from .accessors import Accessors, misfit
from .messages import Refused, SlaveError, message, told
from .repairs import give_back_interrupts, hold, leave_search_path, settle_at_exit
from .snapshot import Snapshot, from_bytes, to_bytes

_WARNING, _ERROR = 1, 3  # fmi2Status


class ModelSlave:
    """Mixin before pythonfmu's Fmi2Slave. A subclass sets its `model` and the `identity` of its FMU.

    Every failed call but do_step raises SlaveError.
    """

    # Python finds slots and attributes of the instance ten times faster than those of its class
    __slots__ = (
        "_access",
        "_ended",
        "_feeds_through",
        "_follows_inputs",
        "_given",
        "_inputs",
        "_listed",
        "_notice",
        "_noticed",
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
        "_time",
        "_timed",
    )  # fmt: skip # words, not lines

    model: ClassVar[type[Model]]
    identity: ClassVar[str]
    log_categories: ClassVar[dict[str, str]] = {
        "logStatusWarning": "What a user must know of though nothing failed",
        "logStatusError": "Exceptions that the model raised",
    }

    _accessors: ClassVar[Accessors]
    _living: ClassVar[weakref.WeakSet[ModelSlave]]

    instance_name: str
    resources: str
    log_queue: list[Any]
    log: Callable[[str, int, str], None]

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        cls._accessors = Accessors(cls.model)
        cls._living = weakref.WeakSet()

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        leave_search_path(self.resources)
        settle_at_exit(self.resources, type(self).__name__)
        give_back_interrupts()
        self._access = access = self._accessors
        self._step, self._outputs = self.model.step, self.model.outputs
        self._notice, self._noticed = self.model.notice, set[str]()
        self._record, self._listed = access.record, access.listed
        self._timed, self._feeds_through = access.timed, access.feeds_through
        self._follows_inputs = access.follows_inputs
        self._real_inputs, self._real_outputs = access.real_inputs, access.real_outputs
        self._settings, self._given = access.starts("parameter"), access.starts("input")
        self._shown, self._time = access.starts("output"), 0.0
        self._parameters: Any = None
        self._inputs: Any = None
        self._state: Any = None
        self._started = self._ended = False
        self._stale = True  # outputs (and before the start the state) do not belong to the inputs
        self._living.add(self)

    # -- time ----------------------------------------------------------------------------------------------

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Set the start time [s], which `initial` sees as time (fmi2SetupExperiment)."""
        self._set_time(start_time)

    def exit_initialization_mode(self) -> None:
        """Check the parameters, compute x_0, and fix the parameters (fmi2ExitInitializationMode)."""
        try:
            self._initialize()
            self._started = True
        except BaseException as error:
            raise self._failure("fmi2ExitInitializationMode", error) from None

    def terminate(self) -> None:
        """Take no step any more (fmi2Terminate)."""
        self._ended = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance by step_size [s] (fmi2DoStep); return True for OK, False for Discard."""
        try:
            if not self._started:
                raise Refused("the initialization mode has not been left")
            if self._ended:
                raise Refused("it was terminated")
            if not 0.0 < step_size < math.inf:
                raise Refused(f"the step is {step_size} s: it must be finite and longer than 0")
            if self._timed:
                self._set_time(current_time)
            u = self._inputs
            if u is None:
                u = self._inputs = self._record(self._given, self._time)
            state = self._step(self._parameters, self._state, u, step_size)
            notice = self._notice
            said = "" if notice is None else notice(self._parameters, self._state, state, u)
            if self._timed and self._follows_inputs:
                self._set_time(current_time + step_size)
                u = None
            self._show(state, u)
            self._state = state
            if said and said not in self._noticed:
                self._noticed.add(said)
                text = told(f"first at t = {current_time + step_size:.9g} s: {said}")
                self.log(text, _WARNING, "logStatusWarning")
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
        """Compute x_0 and its outputs from the current parameters and inputs."""
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
        """Store the outputs of a state at the inputs u; None stands for the inputs that are set now."""
        if self._feeds_through:
            if u is None:
                u = self._inputs = self._record(self._given, self._time)
            y = self._outputs(self._parameters, state, u)
        else:
            y = self._outputs(self._parameters, state)
        try:
            self._shown = self._listed(y)
        except (TypeError, ValueError, OverflowError):
            raise misfit(self._access.outputs, y) from None
        self._stale = False

    def _refresh(self) -> None:
        if self._started:
            self._show(self._state, self._inputs)
        else:
            self._initialize()

    # -- values --------------------------------------------------------------------------------------------

    def get_real(self, references: Sequence[int]) -> list[float]:
        """Return the values of Real variables (fmi2GetReal)."""
        try:
            if self._stale:
                self._refresh()
            if references == self._real_outputs:
                return self._shown
            return self._access.read_real[tuple(references)](self)
        except BaseException as error:
            raise self._failure("fmi2GetReal", error) from None

    def get_integer(self, references: Sequence[int]) -> list[int]:
        """Return the values of Integer and Enumeration variables (fmi2GetInteger)."""
        try:
            if self._stale:
                self._refresh()
            return self._access.read_integer[tuple(references)](self)
        except BaseException as error:
            raise self._failure("fmi2GetInteger", error) from None

    def get_boolean(self, references: Sequence[int]) -> list[bool]:
        """Return the values of Boolean variables (fmi2GetBoolean)."""
        try:
            if self._stale:
                self._refresh()
            return self._access.read_boolean[tuple(references)](self)
        except BaseException as error:
            raise self._failure("fmi2GetBoolean", error) from None

    def get_string(self, references: Sequence[int]) -> list[str]:
        """Return an empty list for no references (fmi2GetString): a model has no String variable."""
        try:
            if self._stale:
                self._refresh()
            return self._access.read_string[tuple(references)](self)
        except BaseException as error:
            raise self._failure("fmi2GetString", error) from None

    def set_real(self, references: Sequence[int], values: list[float]) -> None:
        """Set Real variables (fmi2SetReal)."""
        try:
            if references == self._real_inputs:
                self._given = values  # the native library has made this list for this call alone
                self._is_set()
            else:
                self._set("Real", references, values)
        except BaseException as error:
            raise self._failure("fmi2SetReal", error) from None

    def set_integer(self, references: Sequence[int], values: Sequence[int]) -> None:
        """Set Integer and Enumeration variables (fmi2SetInteger); a number that is no item fails."""
        try:
            self._set(
                "Integer", references, [self._member(r, v) for r, v in zip(references, values, strict=True)]
            )
        except BaseException as error:
            raise self._failure("fmi2SetInteger", error) from None

    def set_boolean(self, references: Sequence[int], values: Sequence[bool]) -> None:
        """Set Boolean variables (fmi2SetBoolean)."""
        try:
            self._set("Boolean", references, values)
        except BaseException as error:
            raise self._failure("fmi2SetBoolean", error) from None

    def set_string(self, references: Sequence[int], values: Sequence[str]) -> None:
        """Set nothing for no references (fmi2SetString): a model has no String variable."""
        try:
            self._set("String", references, values)
        except BaseException as error:
            raise self._failure("fmi2SetString", error) from None

    def _set(self, kind: str, references: Sequence[int], values: Sequence[Any]) -> None:
        access = self._access
        settable = (access.settable_later if self._started else access.settable_first)[kind]
        if not settable.issuperset(references):
            raise access.refusal(kind, references, settable)
        for r, value in zip(references, values, strict=True):
            kept = self._settings if r < access.first_input else self._given
            kept[access.index[r]] = value
        self._is_set()

    def _is_set(self) -> None:
        self._inputs = None
        if self._follows_inputs or not self._started:
            self._stale = True

    def _member(self, reference: int, value: int) -> int:
        enumeration = self._access.enumerations.get(reference)
        if enumeration is None:
            return value
        try:
            return enumeration(value)
        except ValueError:
            items = ", ".join(f"{int(item)} {item.name.lower()}" for item in enumeration)
            name = self._access.variables[reference].name
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
            self._started, self._ended = snapshot.started, False
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
        """Return the exception of a call of the class, which does not know the instance that called.

        All living instances are held; those that did not call leak, the lesser evil.
        """
        hold(cls)
        for instance in list(cls._living):
            hold(instance, instance.log_queue)
        return SlaveError(message(call, error))
