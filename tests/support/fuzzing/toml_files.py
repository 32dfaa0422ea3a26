"""Hostile system, scenario and swap files: changed as texts, or as tables that stay TOML."""

from __future__ import annotations

import json
import math
import random
import tomllib
from typing import Any

from evcosim.cosim.system.toml import DATA
from support.every_key import SCENARIO
from support.fuzzing.changes import DEEP, NUMBERS, TEXTS, Input, encoded, mutated

SHORT = ["--stop-time", "0.05", "-q", "-o", "out"]
_SWAP = """
fmu = "Scooter"
period = 0.01
substeps = 2
absent = []
memory_limit = 2000
isolation = "none"
[parameters]
mass = 180.0
[start]
brake_force = 0.0
[map.inputs]
throttle = "throttle"
brake_force = { variable = "brake_force", factor = 1.0, offset = 0.0, convert = true }
[map.outputs]
speed = "speed"
"""
_EVERY = f"""
leave_out = ["rider", "planner", "battery"]
{SCENARIO}
[[stimulus]]
to = "vehicle.brake_force"
constant = 0.0
[[event]]
action = "set"
time = 0.02
variable = "vehicle.available_power"
value = 9000.0
[[figure.panels]]
label = "Speed"
unit = "km/h"
signals = [{{ name = "vehicle.speed", label = "true", style = "solid", weight = 2.0 }}]
"""
_STRANGE: tuple[Any, ...] = (
    math.inf,
    -math.inf,
    math.nan,
    -0.0,
    5e-324,
    1e308,
    10**400,
    -(2**63) - 1,
    2**63,
    0,
    -1,
    True,
    [],
    {},
    [[]],
    [[[1.0]]],
    [1] * 10_000,
    [[0.0, 1.0]] * 1000,
    {"": 1},
    {"a\0b": 1},
    "9" * 5000,
    "\0",
    "\u202e",
)


def read(*parts: str) -> str:
    """Return a built-in file."""
    return DATA.joinpath(*parts).read_text(encoding="utf-8")


def plotted(random: random.Random) -> list[str]:
    return [] if random.random() < 0.15 else ["--no-plot"]


def changed(random: random.Random, text: str) -> bytes:
    """Return a TOML text with changes of its characters or of its tables."""
    if random.random() < 0.4:
        return mutated(random, text, random.choice(("[", "{ a = ", "a.", "[[", '"""', "# ")))
    data = tomllib.loads(text)
    for _ in range(random.choice((1, 1, 1, 2))):
        _change_tables(random, data)
    text = written(data)
    if random.random() < 0.15:
        lines = text.splitlines(keepends=True)
        text += random.choice(lines)  # a key or a table given twice
    return encoded(random, text)


def _change_tables(random: random.Random, data: dict[str, Any]) -> None:
    places = list(_places(data))
    leaves = [(table, key) for table, key in places if not isinstance(table[key], dict | list)]
    table, key = random.choice(leaves if leaves and random.random() < 0.6 else places)
    other, name = random.choice(places)
    match random.randrange(8):
        case 0 | 1:
            near = isinstance(table[key], int | float) and random.random() < 0.5
            table[key] = table[key] * random.choice((-1, 0.1, 3, 1e6, 0)) if near else random.choice(_STRANGE)
        case 2:
            table[key] = random.choice(TEXTS)
        case 3:
            table[key] = json.loads(json.dumps(other[name]))  # a copy: no table may hold itself
        case 4 if isinstance(table, dict):
            table[random.choice(TEXTS)] = json.loads(json.dumps(table.pop(key)))
        case 5:
            del table[key]
        case 6 if isinstance(table, dict):
            table[str(name)] = json.loads(json.dumps(other[name]))
        case _:
            for _ in range(random.choice((1, 2, 70))):
                table[key] = [table[key]] if random.random() < 0.7 else {"a": table[key]}


def _places(data: Any) -> Any:
    for key in data if isinstance(data, dict) else range(len(data)):
        yield data, key
        if isinstance(data[key], dict | list):
            yield from _places(data[key])


def written(value: dict[str, Any]) -> str:
    """Return a document as TOML, each table inline."""
    return "".join(f"{_inline(key)} = {_inline(inner)}\n" for key, inner in value.items())


def _inline(value: Any) -> str:
    match value:
        case bool():
            return str(value).lower()
        case int() | float():
            return repr(value)
        case str():
            return '"' + "".join(c if c.isalnum() and c.isascii() else _escaped(c) for c in value) + '"'
        case list():
            return f"[{', '.join(map(_inline, value))}]"
        case _:
            return f"{{{', '.join(f'{_inline(key)} = {_inline(inner)}' for key, inner in value.items())}}}"


def _escaped(character: str) -> str:
    return f"\\U{ord(character):08x}"


def a_system(random: random.Random) -> Input:
    """A system file."""
    name = random.choice(("scooter", "lane_keeping", "braking", "multi_drive"))
    files = {"s.toml": changed(random, read("systems", f"{name}.toml"))}
    match random.randrange(10):
        case 0 | 1 | 2:
            command = ["info", "s.toml", *random.choice(([], ["--json"], ["--diagram", "d.svg"]))]
        case 3:
            command = ["check", "Battery", "--as", "s.toml.battery"]
        case 4:
            command = ["budget", "s.toml", "--stop-time", "0.02", "--workers", "1", "-o", "out"]
        case _:
            command = ["run", "s.toml", *SHORT, *plotted(random)]
    return Input("TOML", command, files)


def a_scenario(random: random.Random) -> Input:
    """A scenario of a built-in system, with a figure and stimuli."""
    name = random.choice(("fig8", "udds", "identification", "ece15", ""))
    text = read("scenarios", "scooter", f"{name}.toml") if name else _EVERY
    files = {"c.toml": changed(random, text)}
    match random.randrange(8):
        case 0:
            command = ["identify", "scooter", "-s", "c.toml", "--duration", "0.5", "-q", "-o", "out"]
        case 1:
            command = ["check", "Scooter", "--as", "scooter.vehicle", "-s", "c.toml"]
        case _:
            engine = random.choice(([], ["--engine", "python"]))
            command = ["run", "scooter", "-s", "c.toml", *SHORT, *plotted(random), *engine]
    return Input("TOML", command, files)


def a_swap(random: random.Random) -> Input:
    """A swap file, run or checked."""
    files = {"w.toml": changed(random, _SWAP)}
    match random.randrange(6):
        case 0 | 1:
            command = ["check", "w.toml", "--as", "scooter.vehicle"]
        case 2:
            command = ["check", "w.toml", "--as", "scooter.vehicle", "--write", "new.toml"]
        case _:
            command = ["run", "scooter", "--swap", "vehicle=w.toml", *SHORT, "--no-plot"]
    return Input("TOML", command, files)


def nested(random: random.Random) -> Input:
    """A file that is nothing but depth or length."""
    inner = random.choice(("[", "{a=", "a.", "[[", '"a".', "a = 1\n", "[a]\n", "# \n", "'", "\n", "a=[\n"))
    text = random.choice(("", "a = ")) + inner * random.choice((100, 3000, DEEP))
    kind = random.choice(("run", "info"))
    return Input("TOML", [kind, "s.toml"], {"s.toml": encoded(random, text + random.choice(NUMBERS))})
