"""The ranges that a system can give to the inputs of a unit, and how far a trial moves each of them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping

from ....cosim.errors import ConfigError
from ....cosim.interface import VariableInfo
from ....cosim.plan.plan import Plan
from ....cosim.system.scenario import Scenario, ScenarioFile
from ....cosim.system.system import System
from ....cosim.units.definition import defined
from ....cosim.units.measure import Affine
from ...prepare import prepare

_USUAL = {
    "N": 200.0, "N.m": 50.0, "W": 1000.0, "A": 20.0, "V": 50.0, "m/s": 5.0, "m/s2": 1.0, "m": 1.0,
    "rad": 0.05, "rad/s": 5.0, "K": 10.0, "kg": 10.0, "s": 1.0,
}  # fmt: skip # what moves a light vehicle clearly and keeps it on the road, in SI units


@dataclasses.dataclass(frozen=True)
class Level:
    """The values of an input, in the system's unit of measure for it.

    `rest` is its start value, `high` the one that a trial moves it to, `limits` (low, high) the range that
    the system can give, infinite if nothing declares it.
    """

    rest: float
    high: float
    limits: tuple[float, float]


def levels(system: System, unit: str, inputs: Iterable[VariableInfo]) -> dict[str, Level]:
    """Return the level of each input of a unit, as the present FMU declares it.

    Limits are those of the input itself, of the output that drives it, and of the bus signal in between.
    Raises ConfigError for a system that cannot run.
    """
    # trusted: no unit is run here, and those of a trial stand in processes of their own whatever a file says
    plan = prepare(system, Scenario("", None, ScenarioFile()), trust=True).plan
    return {v.name: _level(v, _reachable(plan, unit, v)) for v in inputs}


def _level(v: VariableInfo, limits: tuple[float, float]) -> Level:
    rest = float(v.start) if isinstance(v.start, int | float) else 0.0
    low, high = limits
    up, down = high - rest, low - rest
    way = up if up > 0.0 else down  # an input that can only fall is moved down
    half = 0.5 * way if math.isfinite(way) else math.copysign(math.inf, way)
    usual = _usual(v.unit)
    if usual is None:
        step = half if math.isfinite(half) else math.copysign(1.0, half)
    else:
        step = math.copysign(min(abs(half), usual), half)
    if v.type == "Integer":
        step = math.copysign(math.ceil(abs(step)), step)
    return Level(rest, rest + step, limits)


def _usual(unit: str) -> float | None:
    """Return the usual step in a unit of measure; None if it is unknown or has no dimension."""
    try:
        known = defined(unit)
    except ConfigError:
        return None
    for name, step in _USUAL.items():
        if defined(name).exponents == known.exponents:
            return step / known.factor
    return None


def _reachable(plan: Plan, unit: str, v: VariableInfo) -> tuple[float, float]:
    """Return the range that an input can receive, by all that declares one; infinite without."""
    name = f"{unit}.{v.name}"
    given = [(v.min, v.max), *_of_links(plan, (unit, v.name)), *_of_messages(plan, name)]
    low = max((low for low, _ in given if low is not None), default=-math.inf)
    high = min((high for _, high in given if high is not None), default=math.inf)
    return low, high


Ends = tuple[float | None, float | None]
"""The ends of a range; None: not declared."""


def _of_links(plan: Plan, sink: tuple[str, str]) -> Iterable[Ends]:
    """Yield the range of each output that is connected directly, in the input's unit of measure."""
    declared = _declared(plan)
    for link in plan.links:
        if link.sink == sink:
            source = declared[".".join(link.source)]
            yield _mapped(link.map, source.min, source.max)


def _of_messages(plan: Plan, name: str) -> Iterable[Ends]:
    """Yield the ranges of the bus signal and of its sender, in the input's unit of measure."""
    mailbox, declared = plan.inputs[name].mailbox, _declared(plan)
    for message in plan.messages:
        arrivals = dict(message.arrivals)
        for route in message.routes:
            for slot, from_bus in route.sinks:
                if arrivals.get(slot, slot) == mailbox:
                    yield _mapped(from_bus, route.signal.minimum, route.signal.maximum)
                    source = declared[message.senders[route.signal.name]]
                    low, high = _mapped(route.to_bus, source.min, source.max)
                    yield _mapped(from_bus, low, high)


def _declared(plan: Plan) -> Mapping[str, VariableInfo]:
    return {f"{u.name}.{v.name}": v for u in plan.units for v in u.interface.variables.values()}


def _mapped(map_: Affine, low: float | None, high: float | None) -> Ends:
    ends = tuple(None if x is None else map_(x) for x in (low, high))
    return (ends[0], ends[1]) if map_.scale > 0.0 else (ends[1], ends[0])
