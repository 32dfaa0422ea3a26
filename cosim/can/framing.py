"""The frames of a message: how they are made, sent and received, where values alone do not say it."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterable
from pathlib import Path

from ..errors import ConfigError, nearest, short
from .bus_settings import BusSettings
from .database import Message, Signal
from .message_settings import E2eSettings, MessageSettings
from .protection.maker import MakerChecksum
from .protection.profiles import CODES, MAKER, P1C, P2, P5, modulus


@dataclasses.dataclass(frozen=True)
class Protection:
    """The protection of a message: profile by its code, data IDs, signals, greatest step of the counter.

    `maker` is the function of a maker's own checksum.
    """

    profile: int
    ids: tuple[int, ...]
    crc: Signal
    counter: Signal | None
    nibble: Signal | None
    max_delta: int
    maker: MakerChecksum | None = None

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
    message: Message,
    settings: BusSettings,
    connected: Collection[str] = (),
    place: str = "",
    folder: str = ".",
) -> Framing | None:
    """Return how the frames of a message are made; None where its values alone say what receivers get.

    With resolution "ideal" there are no frames, and protection, timeouts and statuses do nothing. `connected`
    are the names of the signals that a connection feeds, `folder` that of the system file. Raises
    ConfigError, which starts with `place`, for a protection that its signals do not hold.
    """
    own = settings.of_message(message.name)
    protection = None
    if own.e2e is not None:
        protection = _protection(message, own.e2e, connected, f"{place}.messages.{message.name}.e2e")
    _check_checksum_keys(own, f"{place}.messages.{message.name}")
    if own.checksum is not None:
        protection = _makers(message, own, connected, f"{place}.messages.{message.name}", folder)
    if own.status and protection is None and own.timeout is None:
        raise ConfigError(
            f"{place}.messages.{message.name}.status: there is a status with `e2e`, `checksum` or `timeout`"
        )
    if own.on_timeout != "hold" and own.timeout is None:
        raise ConfigError(f"{place}.messages.{message.name}.on_timeout: it needs a `timeout`, in cycles")
    special = protection is not None or own.timeout is not None
    if settings.resolution == "ideal":
        check_quantized(settings, place)
        return None
    return Framing(protection) if special or settings.timing == "frame" else None


def check_quantized(settings: BusSettings, place: str, needs: str = "") -> None:
    """Raise ConfigError, which starts with `place`, where values that are not quantized should make frames.

    With timing = "frame" they should, and where the clause `needs` says why. A protection alone changes no
    value: with resolution "ideal" it is left out.
    """
    needs = needs or ('timing = "frame" needs them' if settings.timing == "frame" else "")
    if settings.resolution == "ideal" and needs:
        raise ConfigError(
            f'{place}: with resolution = "ideal" values are not quantized, and make no frames; {needs}'
        )


def bare_framing(settings: BusSettings, place: str, needs: str) -> Framing:
    """Return a framing without protection, for what `needs` frames. Raises ConfigError as check_quantized."""
    check_quantized(settings, place, needs)
    return Framing()


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
    crc = _signal(message, e2e.crc, "crc", range(crc_bits, crc_bits + 1), connected, place)
    counter = _signal(
        message, e2e.counter, "counter", range(counter_bits, counter_bits + 1), connected, place
    )
    nibble = None
    if (e2e.nibble is None) != (code != P1C):
        raise ConfigError(f"{place}: profile 1C has a `nibble`, and no other: it is a signal of 4 bits")
    if e2e.nibble is not None:
        nibble = _signal(message, e2e.nibble, "nibble", range(4, 5), connected, place)
    if crc.start % 8 != (0 if crc.little_endian else 7) or (code == P5 and not crc.little_endian):
        order = "two bytes, the low one first" if code == P5 else "one byte"
        raise ConfigError(f"{place}.crc: {crc.name} begins with bit {crc.start}; it must be {order}")
    if e2e.max_delta >= modulus(code):
        raise ConfigError(
            f"{place}.max_delta = {e2e.max_delta}: the counter of profile {e2e.profile} has {modulus(code)} "
            f"values, so that no frame is more than {modulus(code) - 1} counts on; give less"
        )
    return Protection(code, _ids(e2e, code, place), crc, counter, nibble, e2e.max_delta)


def _check_checksum_keys(own: MessageSettings, place: str) -> None:
    """Raise ConfigError, which starts with `place`, for keys of a checksum that do not go together."""
    if own.checksum is None:
        for key in ("checksum_signal", "checksum_counter", "checksum_max_delta"):
            if getattr(own, key) is not None:
                raise ConfigError(f'{place}.{key}: it needs `checksum`, the function: "module:function"')
    elif own.e2e is not None:
        raise ConfigError(f"{place}: `checksum` and `e2e` both protect the message; give one of them")
    elif own.checksum_signal is None:
        raise ConfigError(f"{place}.checksum: `checksum_signal` names the signal that it fills")


def _makers(
    message: Message, own: MessageSettings, connected: Collection[str], place: str, folder: str
) -> Protection:
    crc = _signal(message, own.checksum_signal or "", "checksum_signal", range(1, 33), connected, place)
    counter, values = None, 0
    if own.checksum_counter is not None:
        counter = _signal(message, own.checksum_counter, "checksum_counter", range(1, 17), connected, place)
        if counter.name == crc.name:
            raise ConfigError(f"{place}.checksum_counter: {counter.name} is the checksum's signal")
        values = 1 << counter.length
        if counter.maximum is not None and counter.scale == 1 and counter.offset == 0:
            values = int(min(values, counter.maximum + 1))
        if counter.signed or values < 2:
            raise ConfigError(f"{place}.checksum_counter: {counter.name} must count from 0 to 1 or more")
    delta = _checked_delta(own.checksum_max_delta, counter, values, f"{place}.checksum_max_delta")
    maker = MakerChecksum(own.checksum or "", folder, f"{place}.checksum", f"{message.name}.{crc.name}")
    maker.check()
    return Protection(MAKER + values, (), crc, counter, None, delta, maker)


def _checked_delta(delta: int | None, counter: Signal | None, values: int, place: str) -> int:
    """Return the greatest step of a maker's counter with so many values. Raises ConfigError."""
    if delta is None:
        return 1
    if counter is None:
        raise ConfigError(f"{place} = {delta}: it needs a `checksum_counter`, whose steps it bounds")
    if delta >= values:
        raise ConfigError(
            f"{place} = {delta}: {counter.name} has {values} values, so that no frame is more than "
            f"{values - 1} counts on; give less"
        )
    return delta


def checksum_sources(buses: Iterable[BusSettings], folder: str) -> list[bytes]:
    """Return the files in the system file's `folder` whose functions are checksums of messages, read.

    Raises ConfigError for one that cannot be read.
    """
    names = [own.checksum for bus in buses for own in bus.messages.values() if own.checksum is not None]
    return [_read(file) for name in names if (file := MakerChecksum(name, folder, "", "").file) is not None]


def _read(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise ConfigError(f"{file}: it has a checksum, and cannot be read: {error.strerror}") from error


def _ids(e2e: E2eSettings, code: int, place: str) -> tuple[int, ...]:
    ids = e2e.data_id if isinstance(e2e.data_id, list) else [e2e.data_id]
    count, most = (16, 0xFF) if code == P2 else (1, 0xFFFF)
    if len(ids) != count or not all(0 <= number <= most for number in ids):
        raise ConfigError(
            f"{place}.data_id: profile {e2e.profile} has {count} from 0 to {most}, not {short(e2e.data_id)}"
        )
    return tuple(ids)


def _signal(
    message: Message, name: str, key: str, bits: range, connected: Collection[str], place: str
) -> Signal:
    """Return the signal that a key of the protection names, of so many bits.

    Raises ConfigError where it does not fit.
    """
    if name not in message.signals:
        raise ConfigError(
            f"{place}.{key}: {message.file}: message '{message.name}' has no signal '{name}'"
            f"{nearest(name, message.signals)}"
        )
    signal = message.signals[name]
    if name in connected:
        raise ConfigError(f"{place}.{key}: {name} is fed by a connection, and by the protection")
    if signal.problem:
        raise ConfigError(f"{place}.{key}: {message.file}: {name}: {signal.problem}")
    if signal.multiplexer or signal.is_multiplexer:
        which = "stands in some frames only" if signal.multiplexer else "says which signals a frame has"
        raise ConfigError(f"{place}.{key}: {name} {which}; the protection needs a signal of all frames")
    if signal.length not in bits or signal.is_float:
        need = f"{bits[0]} are" if len(bits) == 1 else f"1 to {bits[-1]} are"
        raise ConfigError(f"{place}.{key}: {name} has {signal.length} bits, and {need} needed")
    return signal
