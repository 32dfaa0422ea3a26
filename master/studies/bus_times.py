"""Measuring the times of frames: a run of a system in which they take time on all its buses.

What it finds stands in `cosim.analysis.bus_times`, its command in `cli.bus`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Unpack, cast

from ...cosim.analysis.bus_times import BusTimes, carried, longest_wait
from ...cosim.can.bus_settings import BusSettings, BusVariation
from ...cosim.errors import ConfigError
from ...cosim.plan.bus_load import bus_loads
from ...cosim.system.run_options import RunOptions
from ..simulation import RunProgress, Simulation, frame_logs


def bus_times(
    system: str | Path,
    scenario: str | Path | None = None,
    *,
    progress: RunProgress | None = None,
    **options: Unpack[RunOptions],
) -> list[BusTimes]:
    """Run a system with `timing = "frame"` on all its buses; return the times of the frames on each.

    The options are those of `simulate`, except for `bus` and `ideal`; `progress` gets the time that is
    reached and the stop time [s].
    Raises ConfigError where no connection is over a bus, and all that a run raises.
    """
    for name in ("bus", "ideal"):
        if options.get(name):
            raise ConfigError(
                f"the times of frames need the buses as they are, so that '{name}' cannot be given"
            )
    varied = cast(RunOptions, {**options, "bus": BusVariation(timing="frame")})
    with Simulation(system, scenario, log_frames=True, to_stop=True, **varied) as simulation:
        if not simulation.plan.messages:
            raise ConfigError(f"{simulation.system.path}: no connection is over a bus: there are no frames")
        simulation.run(progress=progress)
        about: dict[str, Any] = simulation.manifest()
        loads = bus_loads(simulation.plan.messages, simulation.plan.clock.step)
        found = []
        for log in frame_logs(simulation):
            if log.bus in loads:
                settings: BusSettings = simulation.system.file.buses[log.bus]
                frames = carried(log, simulation.plan.clock, settings)
                period = longest_wait(frames, settings.bitrate)
                delays = {
                    name.partition(".")[2]: units
                    for name, units in about["effective_delays"].items()
                    if name.partition(".")[0] == log.bus
                }
                found.append(BusTimes(loads[log.bus], about["frames"][log.bus], period, delays))
        return found
