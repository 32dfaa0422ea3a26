"""The channel: the way of a message's values from the sender to the receivers.

Of a signal let x[k] be the sender's value in communication step k, and y[k] what a receiver's mailbox holds
from the message's place in that step on:

    y[k] = D(Q(x[k])) if due(k) else y[k - 1],    y[-1] = initial
    due(k) = k >= first and (k - first) % every == 0

Q converts from the sender's unit to the signal's and makes a raw value of it, D makes a physical value of
that and converts it to the receiver's unit (`quantization` defines both). `first` and `every` come from the
DBC (`send_steps`), `every` times the `cycle` of the bus. A message that is due at k = 0 replaces `initial` in
row 0 of the results already. All signals of a message are sampled together. On a bus with a delay of d steps
the engine brings y[k - d] to the mailbox, and `initial` stays there until step first + d.

A MessageChannel writes its own `transmit` as straight-line Python with the constants folded in, since it runs
whenever the message is due: about 0.2 us a signal. `source` is that text. Values that saturate leave the line
for a function that counts them.
"""

from __future__ import annotations

import dataclasses
import functools
import struct
from collections.abc import Callable, Sequence
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from ..errors import ConfigError
from ..units.measure import Affine
from .bus_settings import BusSettings
from .database import Message, Signal
from .quantization import SignalOperation, decode, operation, quantize, reference
from .transmissions import RawLog, raw_store


@dataclasses.dataclass(frozen=True)
class SignalRoute:
    """The way of one signal through the engine's memory.

    `source` is the slot of the sender's value, `to_bus` the map from the sender's unit to the DBC signal's.
    `sinks` are the receivers' slots, each with the map from the DBC signal's unit to the receiver's.
    """

    signal: Signal
    source: int
    to_bus: Affine
    sinks: tuple[tuple[int, Affine], ...]


@dataclasses.dataclass(frozen=True)
class Saturation:
    """The number of values of a signal that were out of range, and the communication step of the first."""

    count: int
    first_step: int


class MessageChannel:
    """One message of a bus with the routes of its signals, under the bus' settings (default: BusSettings()).

    With `log_raw` (then `logs` is True) the raw values of each transmission are kept for `log`, in memory
    until `flush` adds them to the earlier ones, which are in a temporary file when they are many. Raises
    ConfigError when a route's signal is not of the message, is given twice, or cannot be carried.
    """

    def __init__(
        self,
        message: Message,
        routes: Sequence[SignalRoute],
        settings: BusSettings | None = None,
        log_raw: bool = False,
    ) -> None:
        _check(message, routes)
        self.message, self.routes, self.logs = message, tuple(routes), log_raw
        self.operations = tuple(operation(route.signal, settings or BusSettings()) for route in routes)
        self._counts = [[0, 0] for _ in routes]  # of each signal: values out of range, and the first step
        self._out = [
            _out_of_range(op, counter) for op, counter in zip(self.operations, self._counts, strict=True)
        ]
        self._log, self._logged = bytearray(), raw_store(len(routes))
        self._format = struct.Struct("<q" + "".join(_log_type(op)[0] for op in self.operations))

    @property
    def source(self) -> str:
        """The text of `transmit`."""
        return _source(self.routes, self.operations, self.logs)

    @functools.cached_property
    def transmit(self) -> Callable[[Any, int], None]:
        """Send the message: transmit(memory, k).

        `memory` is an indexable of floats (fastest: a memoryview of doubles); `k` is the communication step,
        for the records only, since the caller knows when the message is due. All signals are read and checked
        before any receiver's slot is written. Raises ChannelError for a value that cannot be sent.
        """
        names = self._names() | {"extend": self._log.extend, "pack": self._format.pack}
        exec(compile(self.source, f"<channel {self.message.name}>", "exec"), names)
        transmit: Callable[[Any, int], None] = names["transmit"]
        return transmit

    @property
    def saturations(self) -> dict[str, Saturation]:
        """The signals that had values out of range (under "wrap": values that wrapped), by name."""
        counted = zip(self.operations, self._counts, strict=True)
        return {op.signal.name: Saturation(count, first) for op, (count, first) in counted if count}

    @property
    def log(self) -> RawLog:
        """The transmissions so far; without `log_raw`, none. Raises RunError as `flush` does."""
        self.flush()
        types = {op.signal.name: _log_type(op)[1] for op in self.operations}
        return RawLog(self.message, types, self._logged.table())

    def flush(self) -> None:
        """Add what was logged since the last call to what is kept: after each chunk of steps.

        Raises RunError when the temporary file cannot be written.
        """
        rows = np.frombuffer(bytes(self._log), "<f8").reshape(-1, 1 + len(self.routes))
        self._log.clear()
        self._logged.append(rows)

    # ---- for an engine that does the transmissions itself, with the constants in `operations`

    def out_of_range(self, i: int, x: float, k: int) -> float:
        """Return the raw value of signal i for x, in the signal's unit, outside [low, high], and count it.

        Raises ChannelError where it cannot be sent.
        """
        return self._out[i](x, k)

    def count(self, i: int, times: int, first_step: int) -> None:
        """Count `times` values of signal i out of range, the first of them in step `first_step`."""
        counter = self._counts[i]
        if not counter[0]:
            counter[1] = first_step
        counter[0] += times

    def keep(self, steps: NDArray[np.int64], raws: NDArray[np.float64]) -> None:
        """Add n transmissions to the log: `steps` of shape (n,), `raws` of shape (n, signals)."""
        rows = np.empty((len(steps), 1 + raws.shape[1]), dtype="<f8")
        rows.view("<i8")[:, 0] = steps
        rows[:, 1:] = raws
        self._log.extend(rows.tobytes())

    def _names(self) -> dict[str, Any]:
        """Return the names that the source uses: for values out of range, and for what doubles cannot do."""
        names: dict[str, Any] = {}
        for i, op in enumerate(self.operations):
            names[f"out_{i}"] = self._out[i]
            if op.kind == "exact":
                names[f"raw_{i}"] = _exact_raw(op)
                names[f"value_{i}"] = _exact_value(op)
            elif op.kind == "float32":
                names[f"single_{i}"] = memoryview(bytearray(4)).cast("f")
        return names


def _check(message: Message, routes: Sequence[SignalRoute]) -> None:
    names = [route.signal.name for route in routes]
    for name, route in zip(names, routes, strict=True):
        if message.require(name) != route.signal:
            raise ConfigError(f"{message.file}: {message.name}.{name} is declared otherwise than the route's")
        if names.count(name) > 1:
            raise ConfigError(f"{message.file}: {message.name}.{name} is sent by two connections")


def _out_of_range(op: SignalOperation, counter: list[int]) -> Callable[[float, int], float]:
    """Return the slow path: a function from a value outside [low, high], and the step, to the raw value.

    It counts in `counter`: how often it was called, and in which step first.
    """

    def out(x: float, k: int) -> float:
        raw = reference(op.signal, op.settings, x)[0]
        if not counter[0]:
            counter[1] = k
        counter[0] += 1
        return raw if op.kind == "exact" else float(raw)

    return out


def _exact_raw(op: SignalOperation) -> Callable[[float], float]:
    return lambda x: quantize(op.signal, op.settings.rounding, x)


def _exact_value(op: SignalOperation) -> Callable[[float], float]:
    return lambda raw: decode(op.signal, raw)


def _log_type(op: SignalOperation) -> tuple[str, str]:
    """Return struct's format and numpy's type of a raw value of this signal."""
    if op.kind == "exact":
        return ("q", "<i8") if op.signal.signed else ("Q", "<u8")
    return "d", "<f8"


# ---- the source text ----


def _source(routes: Sequence[SignalRoute], operations: Sequence[SignalOperation], log_raw: bool) -> str:
    lines = ["def transmit(m, k):"]
    for i, (route, op) in enumerate(zip(routes, operations, strict=True)):
        lines += _send(i, route, op)
    for i, (route, op) in enumerate(zip(routes, operations, strict=True)):
        lines += _receive(i, route, op)
    if log_raw:
        lines.append(f"extend(pack({', '.join(['k', *(f'r{i}' for i in range(len(routes)))])}))")
    if len(lines) == 1:
        lines.append("pass")
    return "\n    ".join(lines) + "\n"


def _send(i: int, route: SignalRoute, op: SignalOperation) -> list[str]:
    """Return the lines from the sender's slot to the raw value r<i>."""
    use = op.settings
    return [
        f"# {_one_line(op.signal.name)} [{_one_line(op.signal.unit)}]: {use.rounding}, {use.overflow}",
        f"x = {route.to_bus.expression(f'm[{route.source}]')}",
        f"if {op.low!r} <= x <= {op.high!r}:",
        *(f"    {line}" for line in _quantize_lines(i, op)),
        "else:",
        f"    r{i} = out_{i}(x, k)",
    ]


def _one_line(text: str) -> str:
    """Return a text of the DBC file as part of a comment: a line break in it must not end the comment."""
    return text.encode("unicode_escape").decode("ascii")


def _quantize_lines(i: int, op: SignalOperation) -> list[str]:
    if op.kind == "exact":
        return [f"r{i} = raw_{i}(x)"]
    q = _raw_steps(op)
    if op.kind == "float32":
        return [f"single_{i}[0] = {q}", f"r{i} = single_{i}[0]"]
    if op.kind == "float64":
        return [f"r{i} = {q}"]
    match op.settings.rounding:
        case "half_even":
            # doubles from 2**52 on are whole, so the sum is rounded to a whole number, a half to the even one
            return [f"r{i} = {q} + 6755399441055744.0 - 6755399441055744.0"]
        case "nearest":
            half = "0.49999999999999994"  # the greatest double below 0.5, which would round itself up
        case "truncate":
            half = "0.0"
        case _:
            assert_never(op.settings.rounding)
    if _never_negative(op):
        return [f"r{i} = ({q} + {half}) // 1.0"]
    up, down = f"(q + {half}) // 1.0", f"0.0 - ({half} - q) // 1.0"  # 0.0 - 0.0 is no -0.0
    return [f"q = {q}", f"r{i} = {up} if q >= 0.0 else {down}"]


def _raw_steps(op: SignalOperation) -> str:
    """Return (x - offset) / scale as source. A product with 1 / scale would not be the same double."""
    x = "x"
    if op.offset:
        x = f"(x - {op.offset!r})" if op.offset > 0 else f"(x + {-op.offset!r})"
    return f"{x} / {op.scale!r}" if op.scale != 1.0 else x


def _never_negative(op: SignalOperation) -> bool:
    least = op.low if op.scale > 0 else op.high
    return (least - op.offset) / op.scale >= 0.0


def _receive(i: int, route: SignalRoute, op: SignalOperation) -> list[str]:
    """Return the lines from the raw value r<i> to the receivers' slots."""
    if not route.sinks:
        return []
    value = f"value_{i}(r{i})" if op.kind == "exact" else _value(f"r{i}", op)
    if len(route.sinks) == 1:
        ((slot, affine),) = route.sinks
        inner = value if affine.scale == 1.0 or value.isidentifier() else f"({value})"
        return [f"m[{slot}] = {affine.expression(inner)}"]
    lines = [f"v = {value}"]
    lines += [f"m[{slot}] = {affine.expression('v')}" for slot, affine in route.sinks]
    return lines


def _value(r: str, op: SignalOperation) -> str:
    """Return r * scale + offset as source, without what does nothing."""
    product = f"{r} * {op.scale!r}" if op.scale != 1.0 else r
    return f"{product} + {op.offset!r}" if op.adds_offset else product
