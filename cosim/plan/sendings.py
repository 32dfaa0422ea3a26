"""The communication steps at which messages are sent, or looked at for something to send."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping

from ..can.bus_settings import BusSettings
from ..can.database import Message
from ..can.send_steps import send_steps
from ..can.send_types import Sending, check_send_type, send_type_of
from ..clock import steps_to
from ..errors import ConfigError
from .steps import steps_in

Turns = Mapping[str, tuple[int, int]]
"""Period and offset of each unit in communication steps."""


@dataclasses.dataclass(frozen=True)
class SendTimes:
    """The steps k >= first with (k - first) % every == 0 at which a message is sent, or looked at."""

    every: int
    first: int
    sending: Sending

    @property
    def apart(self) -> int:
        """The least number of steps between two frames."""
        return max(self.every, self.sending.interval)


def send_times(
    message: Message,
    settings: BusSettings,
    senders: Iterable[str],
    turns: Turns,
    step_size: float,
    place: str,
    bus: str,
    pages: int,
) -> SendTimes:
    """Return when a message, as the bus sends it, is sent; `step_size` in s.

    `senders` are the units that send it. `place` is the system file. Raises ConfigError for times that do not
    fit the step, and settings that do not fit the send type.
    """
    where = f"{place}: buses.{bus}"
    check_send_type(message, settings, pages, where)
    own = settings.of_message(message.name)
    kind, _ = send_type_of(message, own)
    if kind == "cyclic" or pages > 1:
        every, first = send_steps(message, step_size, place, bus)
        return SendTimes(every * settings.cycle, first, Sending())
    first, every, cycle = steps_to(message.start_delay, step_size), 1, 0
    interval = _interval(message, settings, step_size, where)
    if kind == "on_write":
        every, offset = _turns_of_all(message, sorted(set(senders)), turns, where)
        first = offset + -(-max(0, first - offset) // every) * every
    elif kind != "on_change":
        if kind == "if_active" and own.cycle_time is None and message.fast_cycle:
            message = dataclasses.replace(message, cycle_time=message.fast_cycle)
        cycle, first = send_steps(message, step_size, place, bus)
        if own.min_interval is not None and interval > cycle:
            raise ConfigError(
                f"{where}.messages.{message.name}.min_interval = {own.min_interval} s is longer than the "
                f"cycle time {message.cycle_time} s"
            )
        interval = min(interval, cycle)
    bounds = interval * settings.cycle if interval else settings.cycle * every if settings.cycle > 1 else 0
    if kind == "on_write":  # of the writes within an interval the frame at its end has the last
        every = max(every, bounds)
    return SendTimes(every, first, Sending(kind, cycle * settings.cycle, bounds))


def _interval(message: Message, settings: BusSettings, step_size: float, place: str) -> int:
    """Return the least steps between two frames; that of the database is rounded up. 0: nothing is said."""
    own = settings.of_message(message.name)
    if own.min_interval is not None:
        where = f"{place}.messages.{message.name}.min_interval"
        return steps_in(own.min_interval, step_size, where, least=1)
    return steps_to(message.min_interval, step_size)


def _turns_of_all(message: Message, units: list[str], turns: Turns, place: str) -> tuple[int, int]:
    """Return period and offset of the units that write a message. Raises ConfigError where they differ."""
    found = {turns[unit] for unit in units}
    if len(found) > 1:
        raise ConfigError(
            f"{place}.messages.{message.name}.send_type: on_write sends it with each step of its sender, and "
            f"{' and '.join(units)} step at different times"
        )
    return found.pop()


def other_send_types(messages: Iterable[tuple[str, Message, BusSettings, bool]]) -> list[str]:
    """Return a warning for each message that the database has sent otherwise than it is.

    Each is given by bus, message, settings, and True where it has several pages.
    """
    said = []
    for bus, message, settings, paged in messages:
        kind, missing = send_type_of(message, settings.of_message(message.name))
        if paged and kind != "cyclic":
            missing = f"has the send type {message.send_type or kind}; its pages are sent at each cycle"
        if missing:
            said.append(f"{message.file}: {bus}.{message.name} {missing}")
    return list(dict.fromkeys(said))
