"""A model with a variable of every type, beside which model.c is the same by hand; in three kinds.

`Handmade` is continuous and feeds through, `HandmadeSampled` is a sampled controller, and `HandmadePlain`
neither feeds through nor knows the time.
"""

from __future__ import annotations

import functools
from enum import IntEnum

from evcosim.models.base import Model, record, time, var


class Mode(IntEnum):
    """Which way it goes."""

    REVERSE = -1
    NEUTRAL = 1
    FORWARD = 2


@record
class Settings:
    """All types, and what is derived of them."""

    gain: float = var(1.5, "N/m", "Added at each step", min=0.0, max=10.0)
    divisor: float = var(3.0, "", "Zero divides by zero")
    limit: int = var(3, "", "Steps from which on there is a notice", min=0, max=9)
    active: bool = var(True, "", "Add the gain")
    mode: Mode = var(Mode.FORWARD, "", "The mode in which the gain is added")
    share: float = var(50.0, "%", "A part of the gain", max=100)
    word: int = var(0, "", "Which failure `initial` is to have", min=0)

    @functools.cached_property
    def part(self) -> float:
        """The part of the gain."""
        return self.gain * self.share / 100.0


@record
class Memory:
    """A sum, the mode of the last step, a count, and three numbers."""

    total: float = var(0.0, "", "Sum")
    last: Mode = var(Mode.NEUTRAL, "", "Mode")
    count: int = var(0, "", "Steps")
    seen: bool = var(False, "", "`on` was true")
    queue: tuple[float, float, float] = var(0.0, "", "The last three sums")


def begin(p: Settings, speed: float, clock: float) -> Memory:
    """Start at the speed and the time."""
    if p.word == 1:
        raise RuntimeError("100 % sure %s %n \u00fc")
    if p.word == 2:
        raise ValueError("")
    return Memory(speed + clock + p.part, Mode.NEUTRAL, 0, False, (-1.0, -1.0, -1.0))


def advance(p: Settings, x: Memory, u: Driven | Untimed, clock: float, dt: float) -> Memory:
    """Add, in an order that rounding remembers."""
    total = x.total + dt * (0.1 * u.speed + clock) / p.divisor
    if p.active and u.lever is p.mode:
        total = total * 1.1 + p.part
    queue = (total, total, total) if u.steps < 0 else (*x.queue[1:], total)
    return Memory(total, u.lever, x.count + 1, x.seen or u.on, queue)


def sentence(p: Settings, x: Memory, after: Memory, u: Driven | Untimed) -> str:
    """Tell that the limit was passed, and each third number of it."""
    if after.count < p.limit or u.on:
        return ""
    return f"{after.count // 3 * 3} of {p.limit} steps, 100 % of them"


def oldest(x: Memory) -> float:
    """Return the oldest number."""
    return x.queue[0]


@record
class Driven:
    """All types, and the time in between."""

    speed: float = var(0.0, "km/h", "A Real input")
    clock: float = time()
    steps: int = var(0, "", "An Integer input")
    on: bool = var(False, "", "A Boolean input")
    lever: Mode = var(Mode.NEUTRAL, "", "An Enumeration input")


@record
class Untimed:
    """All types."""

    speed: float = var(0.0, "km/h", "A Real input")
    steps: int = var(0, "", "An Integer input")
    on: bool = var(False, "", "A Boolean input")
    lever: Mode = var(Mode.NEUTRAL, "", "An Enumeration input")


class Handmade(Model):
    """Sums what it is given.

    Not part of the description.
    """

    initial_inputs = ("speed", "clock")

    Parameters = Settings
    Inputs = Driven
    State = Memory

    @record
    class Outputs:
        """All types; some feed through."""

        total: float = var(0.0, "N/m", "Sum", nominal=10.0)
        direct: float = var(0.0, "", "Sum, speed and time", depends=("speed", "clock"))
        ticks: int = var(
            0, "", "Steps times a million, and `steps`", depends=("steps",), initially=("steps",)
        )
        is_on: bool = var(False, "", "`on` now", depends=("on",))
        last: Mode = var(Mode.NEUTRAL, "", "The mode of the last step")
        oldest: float = var(0.0, "", "The oldest number")

    @staticmethod
    def initial(p: Settings, u: Driven) -> Memory:
        """Return the state at the start."""
        return begin(p, u.speed, u.clock)

    @staticmethod
    def step(p: Settings, x: Memory, u: Driven, dt: float) -> Memory:
        """Return the next state."""
        return advance(p, x, u, u.clock, dt)

    @staticmethod
    def outputs(p: Settings, x: Memory, u: Driven) -> Handmade.Outputs:
        """Return what is shown, now."""
        ticks = 1000000 * x.count + u.steps
        return Handmade.Outputs(
            x.total, x.total / (u.speed - 666.0) + u.clock, ticks, u.on, x.last, oldest(x)
        )

    notice = staticmethod(sentence)


class HandmadeSampled(Model):
    """Sums what it is given in samples."""

    sampled = True
    initial_inputs = ("speed", "clock")

    Parameters = Settings
    Inputs = Driven
    State = Memory

    @record
    class Outputs:
        """All types; some take the inputs of the sample."""

        total: float = var(0.0, "N/m", "Sum", nominal=10.0)
        direct: float = var(0.0, "", "Sum, speed and time", depends=("speed", "clock"))
        ticks: int = var(
            0, "", "Steps times a million, and `steps`", depends=("steps",), initially=("steps",)
        )
        is_on: bool = var(False, "", "`on` now", depends=("on",))
        last: Mode = var(Mode.NEUTRAL, "", "The mode of the last step")
        oldest: float = var(0.0, "", "The oldest number")

    @staticmethod
    def initial(p: Settings, u: Driven) -> Memory:
        """Return the state at the start."""
        return begin(p, u.speed, u.clock)

    @staticmethod
    def step(p: Settings, x: Memory, u: Driven, dt: float) -> Memory:
        """Return the next state."""
        return advance(p, x, u, u.clock, dt)

    @staticmethod
    def outputs(p: Settings, x: Memory, u: Driven) -> HandmadeSampled.Outputs:
        """Return what the sample shows."""
        ticks = 1000000 * x.count + u.steps
        return HandmadeSampled.Outputs(
            x.total, x.total / (u.speed - 666.0) + u.clock, ticks, u.on, x.last, oldest(x)
        )

    notice = staticmethod(sentence)


class HandmadePlain(Model):
    """Sums what it is given, without the time."""

    initial_inputs = ("speed",)

    Parameters = Settings
    Inputs = Untimed
    State = Memory

    @record
    class Outputs:
        """All types."""

        total: float = var(0.0, "N/m", "Sum", nominal=10.0)
        direct: float = var(0.0, "", "Half of the sum")
        ticks: int = var(0, "", "Steps, or times a thousand million")
        is_on: bool = var(False, "", "`on` at some time")
        last: Mode = var(Mode.NEUTRAL, "", "The mode of the last step")
        oldest: float = var(0.0, "", "The oldest number")

    @staticmethod
    def initial(p: Settings, u: Untimed) -> Memory:
        """Return the state at the start."""
        return begin(p, u.speed, 0.0)

    @staticmethod
    def step(p: Settings, x: Memory, u: Untimed, dt: float) -> Memory:
        """Return the next state."""
        return advance(p, x, u, 2.0, dt)

    @staticmethod
    def outputs(p: Settings, x: Memory) -> HandmadePlain.Outputs:
        """Return what is shown."""
        ticks = 1000000000 * x.count if p.word == 3 else x.count
        return HandmadePlain.Outputs(x.total, 0.5 * x.total, ticks, x.seen, x.last, oldest(x))

    notice = staticmethod(sentence)
