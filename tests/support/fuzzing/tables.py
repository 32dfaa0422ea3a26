"""Hostile CSV files: the tables of stimuli, and the results of runs."""

from __future__ import annotations

import json
import random
from pathlib import PurePosixPath

from support.fuzzing.changes import NUMBERS, TEXTS, Input, encoded, mutated
from support.fuzzing.toml_files import SHORT

_SCENARIO = 'leave_out = ["rider"]\n[[stimulus]]\nto = "ecu.throttle_request"\n{}\n'
_ABOUT = json.dumps(
    {
        "evcosim": "0.2.0",
        "system": "x",
        "status": "finished",
        "step_size": 0.01,
        "variables": [{"name": "a", "unit": "m"}],
    }
)
_HEADERS = ("time", "time [s]", "t", "Time", '"time"', "TIME (s)", "", "time,time", "a", "# time", "0.0")
_CELLS = (
    *NUMBERS,
    "",
    " ",
    '"',
    '""',
    '"1',
    "x",
    "TRUE",
    "NULL",
    "#N/A",
    "1;2",
    "=1+1",
    "\0",
    "1,234.5",
    "1e5 m",
)


def table(random: random.Random) -> bytes:
    """Return a table with a dialect of its own, hostile cells, or changes of its characters."""
    columns = ["time", "a", "b"]
    rows = [[f"{0.01 * k:.2f}", f"{k % 7}.5", str(k)] for k in range(random.choice((0, 1, 6, 6, 6, 200)))]
    if random.random() < 0.15:
        columns[random.randrange(3)] = random.choice((*_HEADERS, *TEXTS))
    for _ in range(random.choice((0, 0, 1, 1, 2))):
        if rows:
            random.choice(rows)[random.randrange(3)] = random.choice(_CELLS)
    match random.randrange(24):
        case 0 if rows:
            rows.insert(random.randrange(len(rows)), random.choice(rows))
        case 1 if rows:
            random.choice(rows).append("1")
        case 2 if rows:
            random.choice(rows).pop()
        case 3:
            rows.insert(random.randrange(len(rows) + 1), [random.choice(("#", "# x", "", "%", "//"))])
        case 4:
            random.shuffle(rows)
        case 5:
            columns += [f"c{i}" for i in range(3000)]
        case 6:
            rows = rows * 500
    mark = random.choice((*[","] * 8, ";", "\t", "|", " ", ", "))
    text = random.choice((*["\n"] * 6, "\r\n", "\r")).join(mark.join(row) for row in [columns, *rows])
    if random.random() < 0.05:
        text = text.replace(".", ",")
    if random.random() < 0.2:
        return mutated(random, text, random.choice(('"', ",", ";", '"a\n')))
    return encoded(random, text + random.choice(("\n", "\n", "\n", "", "\n\n", "\x1a")))


def a_table(random: random.Random) -> Input:
    """A CSV file of a stimulus or of results."""
    text = table(random)
    match random.randrange(4):
        case 0 | 1:
            keys = (
                'csv = "t.csv"',
                'csv = "t.csv"\ncolumn = "b"\ninterpolation = "hold"',
                'csv = "t.csv"\ncolumn = "a"\nfactor = 1e308',
                'csv = "t.csv"\ntime_column = "time"\ncolumn = "a"',
            )
            scenario = _SCENARIO.format(random.choice(keys))
            files = {"t.csv": text, "c.toml": scenario.encode()}
            return Input("CSV", ["run", "scooter", "-s", "c.toml", *SHORT, "--no-plot"], files)
        case 2:
            given = random.choice(
                ("throttle=t.csv", "throttle=t.csv:b", "throttle=t.csv:", "brake_force=t.csv:a")
            )
            return Input("CSV", ["run", "Scooter", "--input", given, *SHORT, "--no-plot"], {"t.csv": text})
        case _:
            return _results(random, text)


def _results(random: random.Random, text: bytes) -> Input:
    rows = "".join(f"{0.01 * k:.2f},{k % 7}.5,{k}\n" for k in range(6))
    files = {
        "r/results.csv": text,
        "r/run.json": _about(random),
        "q/results.csv": ("time,a,b\n" + rows).encode(),
        "q/run.json": _ABOUT.encode(),
    }
    if random.random() < 0.2:
        name = random.choice(("r/rows.part", "r/results.part", "r/rows.bin", "r/results.rows"))
        files[str(PurePosixPath(name))] = text
    commands = (
        ["compare", "r", "q"],
        ["compare", "q", "r", "--relative", "1e-6"],
        ["compare", "r", "r", "--json"],
        ["compare", "r", "q", "--plot", "d.png"],
        ["compare", "r/results.csv", "q/results.csv"],
        ["plot", "r"],
        ["plot", "r", "--signals", "a"],
        ["results", "recover", "r"],
        ["run", "scooter", *SHORT[:-1], "r", "--no-plot"],
    )
    return Input("CSV", random.choice(commands), files)


def _about(random: random.Random) -> bytes:
    """Return a run.json: as it is, changed as a text, or with another value at a key."""
    match random.randrange(4):
        case 0:
            return _ABOUT.encode()
        case 1:
            return mutated(random, _ABOUT, random.choice(("[", '{"a":')))
        case 2:
            data = json.loads(_ABOUT)
            strange = (None, [], {}, 0, -1, "x", [[]], [None], True, 1e308, [{"name": None}], "\0", "../x")
            data[random.choice(list(data))] = random.choice(strange)
            return json.dumps(data).encode()
        case _:
            data = json.loads(_ABOUT)
            variable = {
                "name": random.choice(TEXTS),
                "unit": random.choice(TEXTS),
                "items": random.choice(([], {}, 1)),
            }
            data["variables"] = [variable] * random.choice((1, 2, 100))
            return json.dumps(data).encode()
