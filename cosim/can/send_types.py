"""When a message is sent: each cycle, when a value changes, while one is active, or when it is written.

The send types are those of a bus' settings, or of the attributes that databases of Vector's tools have
(GenMsgSendType, GenSigSendType, GenMsgDelayTime, GenMsgCycleTimeFast, GenSigInactiveValue), and mean what the
transmission modes of AUTOSAR COM mean: PERIODIC is cyclic, DIRECT with TRIGGERED_ON_CHANGE on_change and with
TRIGGERED on_write, MIXED cyclic_and_on_change; the minimum delay time is `min_interval`.
"""

from __future__ import annotations

import dataclasses
import re

from ..errors import ConfigError
from .bus_settings import BusSettings
from .database import Message
from .message_settings import MessageSettings, SendType

_SILENT = {"", "nomsgsendtype", "nosigsendtype", "notused", "none", "vectorleerstring", "unknown"}
_CYCLIC = {"cyclic", "cyclicx", "periodic", "fixedperiodic"}
_ON_CHANGE = {
    "onchange",
    "onevent",
    "event",
    "eventdriven",
    "spontan",
    "spontaneous",
    "sporadic",
    "triggered",
}
_MIXED = {
    f"{cyclic}{joint}{event}"
    for cyclic in ("cyclic", "periodic")
    for joint in ("", "and", "or")
    for event in ("event", "onevent", "onchange", "spontan", "spontanx", "spontaneous", "triggered")
} | {"mixed", "periodicevent"}
_IF_ACTIVE = {"ifactive", "cyclicifactive", "cyclicifactivefast"}
_REPEATED = re.compile("(with|and)?repetitions?$")


@dataclasses.dataclass(frozen=True)
class Sending:
    """When a message is sent: `kind`, and in communication steps its `cycle` and the least `interval`.

    One that is cyclic is sent at each of its steps. Any other is looked at there; `cycle` is 0 where it has
    none, and `interval`, between two frames, where nothing bounds it but these steps.
    """

    kind: SendType = "cyclic"
    cycle: int = 0
    interval: int = 0

    @property
    def regular(self) -> bool:
        """True where a frame comes in each cycle."""
        return self.kind not in ("on_change", "if_active")


def send_type_of(message: Message, own: MessageSettings) -> tuple[SendType, str]:
    """Return the send type of a message, and what of its database's is not simulated ("" for nothing).

    The settings count before the database; a cycle time among them makes a message cyclic. Where the message
    has no send type those of its signals count.
    """
    if own.send_type is not None:
        return own.send_type, ""
    if own.cycle_time is not None:
        return "cyclic", ""
    if _plain(message.send_type) not in _SILENT:
        return _meaning(message.send_type)
    kinds = {_meaning(s.send_type) for s in message.signals.values() if _plain(s.send_type) not in _SILENT}
    said = next((missing for _, missing in sorted(kinds) if missing), "")
    types = {kind for kind, _ in kinds}
    if not types:
        return "cyclic", ""
    if types <= {"cyclic"} or len(types) == 1:
        return types.pop(), said
    return "cyclic_and_on_change" if message.cycle_time else "on_change", said


def _meaning(text: str) -> tuple[SendType, str]:
    """Return the send type that a text of a database stands for, and a clause on what is not simulated."""
    plain = _plain(text)
    kind = _REPEATED.sub("", plain)
    missing = f"has the send type {text}, whose repetitions are not simulated" if kind != plain else ""
    if kind in _CYCLIC:
        return "cyclic", missing
    if kind in _ON_CHANGE:
        return "on_change", missing
    if kind in _MIXED:
        return "cyclic_and_on_change", missing
    if kind in _IF_ACTIVE:
        return "if_active", missing
    if kind == "onwrite":
        return "on_write", missing
    return "cyclic", f"has the send type {text}, which is not simulated: it is sent at each cycle"


def _plain(text: str) -> str:
    return re.sub("[^a-z]", "", text.casefold())


def check_send_type(message: Message, settings: BusSettings, pages: int, place: str) -> None:
    """Raise ConfigError, which starts with `place`, for settings that do not fit the send type of a message.

    `place` is that of the bus; the message is sent in so many `pages`.
    """
    own, where = settings.of_message(message.name), f"{place}.messages.{message.name}"
    kind, _ = send_type_of(message, own)
    if own.min_interval is not None and kind == "cyclic":
        raise ConfigError(
            f"{where}.min_interval: a cyclic message has its cycle time; it is for other send types, as "
            'send_type = "on_change"'
        )
    if own.cycle_time is not None and kind in ("on_change", "on_write"):
        other = ', "cyclic_and_on_change" has one' if kind == "on_change" else ""
        raise ConfigError(f"{where}.cycle_time: a message that is sent {kind} has no cycle{other}")
    if own.timeout is not None and kind in ("on_change", "if_active"):
        reason = "nothing changes" if kind == "on_change" else "it is not active"
        raise ConfigError(
            f"{where}.timeout: a message that is sent {kind} does not come where {reason}, so that a timeout "
            'says nothing; with "cyclic_and_on_change" a frame comes each cycle'
        )
    if own.send_type not in (None, "cyclic") and pages > 1:
        raise ConfigError(
            f"{where}.send_type: the {pages} pages of a multiplexed message are sent cyclically"
        )
