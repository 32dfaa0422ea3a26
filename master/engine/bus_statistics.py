"""Counts of the frames of a run: load, losses and times by bus and message."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cosim.can.wire import tables as T
from .frame_path import FramePath
from .listener_tables import by_receiver

_PICOSECOND = 1e-12

_COUNTS = {
    "sent": T.SENT,
    "replaced": T.REPLACED,
    "carried": T.CARRIED,
    "errors": T.ERRORS,
    "arrived": T.ARRIVED,
}
_FAULTY = {
    "lost": T.LOST,
    "silenced": T.SILENCED,
    "delayed": T.DELAYED,
    "held": T.HELD,
    "unheard": T.UNHEARD,
}


def bus_statistics(frames: FramePath, steps: int) -> dict[str, dict[str, Any]]:
    """Return the counts of the buses that carried frames, by name, after so many steps.

    Of a bus on which frames take time: `load`, the share of the time that it was busy (of a frame that ends
    later, the part until then), and of each node the error counters. Of each message its `load`, the numbers
    of frames that were sent, replaced by a newer one before they were carried, carried, ended by wire errors
    and arrived, and least, mean and greatest time [s] from the sampling to the end of the frame (`latency`)
    and to the communication point at which receivers see it (`seen`).
    """
    found: dict[str, dict[str, Any]] = {}
    messages, state = frames.arrays["messages"], frames.arrays["state"]
    elapsed = max(1, steps * int(state[T.STEP_TIME]))
    for i, sender in enumerate(frames.senders):
        row = messages[i]
        about = found.setdefault(sender.plan.bus, {"load": 0.0, "messages": {}, "nodes": {}})
        bus = frames.arrays["buses"][row[T.BUS]]
        later = max(0, int(bus[T.FREE_AT]) - elapsed) if bus[T.BEGUN_BY] == i and row[T.BUSY] else 0
        load = float(int(row[T.BUSY]) - later) / elapsed
        about["load"] += load
        about["messages"][sender.plan.label] = {
            "load": load,
            **{name: int(row[column]) for name, column in _COUNTS.items()},
            "latency": _times(row, T.LATENCY_LEAST, T.LATENCY_HIGH, int(row[T.CARRIED])),
            **_faulty(row),
            **by_receiver(frames.arrays, i, frames.nodes),
            "seen": _times(row, T.SEEN_LEAST, T.SEEN_HIGH, int(row[T.ARRIVED])),
        }
    for (bus, node), row in zip(frames.nodes, frames.arrays["nodes"], strict=False):
        found[bus]["nodes"][node] = {
            "tec": int(row[T.ERROR_COUNT]), "rec": int(row[T.RECEIVE_COUNT]), "bus_off": int(row[T.BUS_OFFS]),
        }  # fmt: skip # a row
    return found


def _faulty(row: NDArray[np.int64]) -> dict[str, Any]:
    """Return the counts of frames of a log, and of those that faults hit, where there are any."""
    found: dict[str, Any] = {}
    if row[T.REPLAYED]:
        found["replayed"] = int(row[T.REPLAYED])
    if any(row[column] for column in _FAULTY.values()):
        found |= {name: int(row[column]) for name, column in _FAULTY.items()}
    return found


def _times(row: NDArray[np.int64], least: int, high: int, count: int) -> dict[str, float] | None:
    """Return least, mean and greatest time [s] of the columns of `wire.uses.note`; None without any."""
    if count == 0:
        return None
    low, total, most = (int(row[least + i]) for i in range(3))
    total += int(row[high]) * T.SUM
    return {"min": low * _PICOSECOND, "mean": total / count * _PICOSECOND, "max": most * _PICOSECOND}
