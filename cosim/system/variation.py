"""Variations of a bus: later, coarser, less often.

They stand in the system file, for one bus (`[buses.NAME]`), or are asked for beside it, for all buses
(BusVariation). `varied` puts the second into the first, so that there is one way to say each.
"""

from __future__ import annotations

import dataclasses

from ..can.dbc import Signal
from ..errors import ConfigError
from .system import BusEntry, Resolution, System, checked_resolution


@dataclasses.dataclass(frozen=True)
class BusVariation:
    """What is changed of all buses of a system, on top of what its file says of each.

    `delay_steps` communication steps are added to the delay; `resolution` multiplies the factor by which
    signals are coarser than their DBC says, "ideal" leaves quantization out; `cycle` multiplies the cycle
    time of every message. Raises ConfigError for a number that is none of these.
    """

    delay_steps: int = 0
    resolution: Resolution = 1.0
    cycle: int = 1

    def __post_init__(self) -> None:
        if not (_whole(self.delay_steps) and self.delay_steps >= 0):
            raise ConfigError(f"bus variation: delay_steps = {self.delay_steps!r}: it is 0 or more steps")
        if not (_whole(self.cycle) and self.cycle >= 1):
            raise ConfigError(f"bus variation: cycle = {self.cycle!r}: it is a whole number from 1 on")
        try:
            checked_resolution(self.resolution)
        except ValueError as error:
            raise ConfigError(f"bus variation: resolution = {self.resolution!r}: {error}") from error

    def of(self, entry: BusEntry, step_size: float) -> BusEntry:
        """A bus with this variation on top; `step_size` in s."""
        ideal = "ideal" in (entry.resolution, self.resolution)
        return entry.model_copy(
            update={
                "delay": entry.delay + self.delay_steps * step_size,
                "resolution": "ideal" if ideal else float(entry.resolution) * float(self.resolution),
                "cycle": entry.cycle * self.cycle,
            }
        )


def _whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def varied(system: System, variation: BusVariation, step_size: float) -> System:
    """The system with the variation on all its buses; `step_size` is the run's [s].

    Raises ConfigError when the system has no bus, where every variation would look harmless.
    """
    if not system.file.buses:
        raise ConfigError(f"{system.path}: a variation of its buses was asked for, but the system has none")
    buses = {name: variation.of(entry, step_size) for name, entry in system.file.buses.items()}
    return dataclasses.replace(system, file=system.file.model_copy(update={"buses": buses}))


def with_resolution(signal: Signal, resolution: Resolution) -> Signal:
    """A signal that is coarser by a factor: its scale multiplied, minimum and maximum as they are.

    "ideal": a value in range arrives as it was sent, one out of range as the limit that it would meet in the
    DBC's signal, of which the last raw value is one. A float signal has no resolution that a factor changes.
    """
    if resolution == "ideal":
        low, high = _physical_range(signal)
        return dataclasses.replace(
            signal, scale=1, offset=0, minimum=low, maximum=high, is_float=True, length=64,
            start_raw=signal.start_raw * signal.scale + signal.offset, not_available=None, choices={},
        )  # fmt: skip # what changes, then what follows from it
    if signal.is_float or resolution == 1.0:
        return signal
    scale = signal.scale * resolution
    # whole scales stay integers, with which large values are computed exactly (see `quantization`)
    whole = isinstance(signal.scale, int) and float(scale).is_integer()
    return dataclasses.replace(signal, scale=int(scale) if whole else scale)


def _physical_range(signal: Signal) -> tuple[float, float]:
    """The least and the greatest value that can arrive, in the signal's unit."""
    ends = sorted(float(raw * signal.scale + signal.offset) for raw in signal.raw_range)
    low = ends[0] if signal.minimum is None else max(ends[0], signal.minimum)
    high = ends[1] if signal.maximum is None else min(ends[1], signal.maximum)
    return low, high
