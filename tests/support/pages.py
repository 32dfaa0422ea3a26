"""Runs for tests of pages, and what stands in a page."""

from __future__ import annotations

import base64
import json
import re
import zlib
from typing import Any

import numpy as np

from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.results.text_table import TextTable
from evcosim.cosim.row_store import Array

HOSTILE = (
    "a.</script><script>window.hit = 1</script>",
    'a.<img src=x onerror="window.hit = 1">',
    "a.'\"&amp;",
    "a.\u202eevil\u200b",
    "a." + "long_name_" * 20,
)
"""Names of variables that a page must show as they are, and do nothing with."""


def small_run(count: int = 401, step: float = 0.01, **manifest: Any) -> Results:
    """Return a run with a state, a flag, a count, a text, a held and two continuous signals."""
    time = np.round(np.arange(count) * step, 9)
    variables = [
        ResultVariable("car.speed", "m/s", description="Speed over ground"),
        ResultVariable("car.wind", "km/h"),
        ResultVariable("ecu.torque", "N.m", causality="input"),
        ResultVariable(
            "ecu.state",
            "",
            "Enumeration",
            variability="discrete",
            items=((0, "off"), (1, "on"), (5, "failed")),
        ),
        ResultVariable("ecu.ready", "", "Boolean", variability="discrete"),
        ResultVariable("ecu.count", "1", "Integer", variability="discrete"),
    ]
    part = np.arange(count) * 4 // max(1, count)  # 0 ... 3
    columns = [
        np.sin(time), 3.6 * np.cos(time), np.floor(time), np.choose(part, [0, 1, 1, 5]), part > 1, part,
    ]  # fmt: skip # one column after the other
    texts = TextTable(
        [ResultVariable("ecu.mode", "", "String", variability="discrete")],
        [(0, ("warm-up",)), (count // 2, ("</script>",))] if count > 1 else [(0, ("warm-up",))] * count,
    )
    return Results(time, np.column_stack(columns), variables, manifest, texts=texts)


def hostile_run(count: int = 300) -> Results:
    """Return a run whose names, texts and values are the worst ones; its manifest too."""
    time = np.arange(count) * 0.01
    named = [ResultVariable(name, "m/s", description=name) for name in HOSTILE]
    valued = [
        ResultVariable(f"b.{name}", unit) for name, unit in (("huge", "V"), ("tiny", "A"), ("gaps", "W"))
    ]
    columns = [np.sin(time + i) for i in range(len(named))]
    columns += [1e300 * np.sin(time), 1e-30 * np.cos(time), np.where(time > 1.0, np.inf, time)]
    columns[2][5:90] = np.nan
    state = ResultVariable(
        "b.state", "", "Enumeration", variability="discrete", items=((0, HOSTILE[1]), (1, HOSTILE[0]))
    )
    manifest = {
        "system": HOSTILE[0],
        "scenario": HOSTILE[1],
        "status": "failed",
        "error": f"unit 'a': {HOSTILE[0]}",
        "warnings": list(HOSTILE),
        "order": list(HOSTILE),
        "units": {name: {"fmu": name, "file": name, "parameters": {name: name}} for name in HOSTILE},
        "connect": [{"from": f"{HOSTILE[0]}.{HOSTILE[1]}", "to": [f"{HOSTILE[1]}.x"]}],
        "events": [{"time": 1.0, "action": "override", "variable": HOSTILE[0], "value": 1.0}],
        "command": f"evcosim run '{HOSTILE[0]}'",
    }
    texts = TextTable([ResultVariable("b.text", "", "String")], [(0, (HOSTILE[0],)), (9, ("x" * 1000,))])
    data = np.column_stack([*columns, time > 1.5])
    return Results(time, data, [*named, *valued, state], manifest, texts=texts)


def data_in(page: str) -> list[Any]:
    """Return the data of each section of panels in a page."""
    found = re.findall(r'<script type="application/json">(.*?)</script>', page, re.DOTALL)
    return [json.loads(text) for text in found]


def unpacked(column: dict[str, Any]) -> Array:
    """Return the numbers of a column of a page, shape (n,)."""
    width = int(column["type"][1])
    octets = np.frombuffer(zlib.decompress(base64.b64decode(column["data"])), dtype=np.uint8)
    plain = octets.reshape(width, -1).T.tobytes()
    return np.frombuffer(plain, dtype=f"<{column['type']}").astype(np.float64)


def times_of(grid: dict[str, Any]) -> Array:
    """Return the times [s] of a grid of a page, shape (n,), as the page makes them."""
    if "data" in grid:
        return unpacked(grid)
    times = (grid["first"] + np.arange(grid["count"]) * grid["advance"]) / grid["divisor"]
    times[-1] = grid["last"]
    return times
