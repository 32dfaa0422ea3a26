"""The frames of a message: how they are made, sent and received, where values alone do not say it."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection

from ..errors import ConfigError, nearest, short
from .bus_settings import BusSettings
from .database import Message, Signal
from .message_settings import E2eSettings, MessageSettings
from .protection.profiles import CODES, P1C, P2, P5


@dataclasses.dataclass(frozen=True)
class Protection:
    """The protection of a message: profile by its code, data IDs, signals, greatest step of the counter."""

    profile: int
    ids: tuple[int, ...]
    crc: Signal
    counter: Signal
    nibble: Signal | None
    max_delta: int

    @property
    def signals(self) -> list[Signal]:
        """The signals that the protection fills."""
        return [s for s in (self.crc, self.counter, self.nibble) if s is not None]


@dataclasses.dataclass(frozen=True)
class Framing:
    """The settings of a message that is sent as the bytes of a frame.

    `status` are the mailboxes of inputs that receive the status of its last frame.
    """

    protection: Protection | None = None
    status: tuple[int, ...] = ()

    def watched(self, own: MessageSettings) -> bool:
        """Return True where somebody looks, once a cycle, whether a frame came."""
        return self.protection is not None or own.timeout is not None


def framing_of(
    message: Message, settings: BusSettings, connected: Collection[str] = (), place: str = ""
) -> Framing | None:
    """Return how the frames of a message are made; None where its values alone say what receivers get.

    With resolution "ideal" there are no frames, and protection, timeouts and statuses do nothing. `connected`
    are the names of the signals that a connection feeds. Raises ConfigError, which starts with
    `place`, for a protection that its signals do not hold.
    """
    own = settings.of_message(message.name)
    protection = None
    if own.e2e is not None:
        protection = _protection(message, own.e2e, connected, f"{place}.messages.{message.name}.e2e")
    if own.status and own.e2e is None and own.timeout is None:
        raise ConfigError(
            f"{place}.messages.{message.name}.status: there is a status with `e2e` or with a `timeout`"
        )
    if own.on_timeout != "hold" and own.timeout is None:
        raise ConfigError(f"{place}.messages.{message.name}.on_timeout: it needs a `timeout`, in cycles")
    special = own.e2e is not None or own.timeout is not None
    if special and message.multiplexed:
        raise ConfigError(
            f"{place}.messages.{message.name}: `e2e` and `timeout` are for messages that are not multiplexed"
        )
    if settings.resolution == "ideal":
        check_quantized(settings, place)
        return None
    return Framing(protection) if special or settings.timing == "frame" else None


def check_quantized(settings: BusSettings, place: str, fault: bool = False) -> None:
    """Raise ConfigError, which starts with `place`, where values that are not quantized should make frames.

    They are what a `fault` hits, and what takes time. A protection alone changes no value, and is left out.
    """
    if settings.resolution == "ideal" and (fault or settings.timing == "frame"):
        needs = "a fault hits frames" if fault else 'timing = "frame" needs frames'
        raise ConfigError(
            f'{place}: with resolution = "ideal" values are not quantized, and make no frames; {needs}'
        )


def check_jitter(message: Message, settings: BusSettings, cycle: float, place: str) -> None:
    """Raise ConfigError, which starts with `place`, where a frame could be queued after the next one.

    `cycle` [s] is the time between two of them.
    """
    jitter = settings.jitter_of(message.name)
    if jitter >= cycle:
        raise ConfigError(
            f"{place}: message '{message.name}': jitter = {jitter} s is not less than its cycle time "
            f"{cycle} s: a frame would be queued after the next one"
        )


def _protection(message: Message, e2e: E2eSettings, connected: Collection[str], place: str) -> Protection:
    code = CODES[e2e.profile]
    crc_bits, counter_bits = (16, 8) if code == P5 else (8, 4)
    crc = _signal(message, e2e.crc, "crc", crc_bits, connected, place)
    counter = _signal(message, e2e.counter, "counter", counter_bits, connected, place)
    nibble = None
    if (e2e.nibble is None) != (code != P1C):
        raise ConfigError(f"{place}: profile 1C has a `nibble`, and no other: it is a signal of 4 bits")
    if e2e.nibble is not None:
        nibble = _signal(message, e2e.nibble, "nibble", 4, connected, place)
    if crc.start % 8 != (0 if crc.little_endian else 7) or (code == P5 and not crc.little_endian):
        order = "two bytes, the low one first" if code == P5 else "one byte"
        raise ConfigError(f"{place}.crc: {crc.name} begins with bit {crc.start}; it must be {order}")
    return Protection(code, _ids(e2e, code, place), crc, counter, nibble, e2e.max_delta)


def _ids(e2e: E2eSettings, code: int, place: str) -> tuple[int, ...]:
    ids = e2e.data_id if isinstance(e2e.data_id, list) else [e2e.data_id]
    count, most = (16, 0xFF) if code == P2 else (1, 0xFFFF)
    if len(ids) != count or not all(0 <= number <= most for number in ids):
        raise ConfigError(
            f"{place}.data_id: profile {e2e.profile} has {count} from 0 to {most}, not {short(e2e.data_id)}"
        )
    return tuple(ids)


def _signal(
    message: Message, name: str, key: str, bits: int, connected: Collection[str], place: str
) -> Signal:
    """Return the signal that a key of the protection names. Raises ConfigError where it does not fit."""
    if name not in message.signals:
        raise ConfigError(
            f"{place}.{key}: {message.file}: message '{message.name}' has no signal '{name}'"
            f"{nearest(name, message.signals)}"
        )
    signal = message.signals[name]
    if name in connected:
        raise ConfigError(f"{place}.{key}: {name} is fed by a connection, and by the protection")
    if signal.length != bits or signal.is_float:
        raise ConfigError(f"{place}.{key}: {name} has {signal.length} bits, and {bits} are needed")
    return signal
