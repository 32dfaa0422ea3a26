"""Hostile command lines: every verb and option of the application, with values that it does not expect."""

from __future__ import annotations

import functools
import random
from typing import Any

from evcosim.master.cli.app import command
from support.fuzzing.changes import NUMBERS, TEXTS, Input

_BEGINNINGS = """
run scooter --stop-time 0.05 --no-plot -q -o out
run scooter --scenario fig8 --stop-time 0.05 --ideal -q --no-plot -o out
run Scooter --stop-time 0.05 --no-plot -q -o out
run Battery --input power=100 --set capacity=30 --stop-time 0.05 -q --no-plot -o out
info scooter --json
info Scooter --causality input --search speed
info scooter --diagram out.svg
list
build Battery -o out
check Battery --as scooter.battery
check Battery --as scooter.battery --try 5ms
check Scooter --as scooter.vehicle --write w.toml
compare r r --tolerance 1e-6
plot r -o p.png
plot r --signals a
schema swap -o out
budget scooter --stop-time 0.02 --set vehicle.mass=180 --workers 1 -o out
identify Scooter --input throttle --output speed --amplitude 2 --sweep 1,2 --duration 0.5 -q --no-plot -o out
identify scooter --duration 0.5 --amplitude 2 -q --no-plot -o out
compile Battery -o out.fmu
results recover r
reproduce nothing
"""
_RESULTS = {
    "r/results.csv": b"time,a\n0.0,1.0\n0.01,2.0\n0.02,1.5\n",
    "r/run.json": b'{"system": "x", "status": "finished", "variables": [{"name": "a", "unit": "m"}]}',
    "w.toml": b'fmu = "Battery"\n',
    "t.csv": b"time,a\n0.0,1.0\n1.0,2.0\n",
}
_SETTINGS = (
    "vehicle.mass=",
    "mass=",
    "ecu.enabled=",
    "vehicle.initial_speed=",
    "capacity=",
    "x.y=",
    "=",
    "vehicle.=",
)
_NOT_TRIED = ("--install-completion", "reproduce")
"""What changes files of the user, and what takes minutes when it has no argument."""


@functools.cache
def options(verb: str) -> tuple[Any, ...]:
    """Return the options of a verb, as the application declares them."""
    found = command().commands.get(verb)
    return tuple(o for o in getattr(found, "params", ()) if o.opts[0].startswith("-"))


def a_value(random: random.Random) -> str:
    """Return a value of any option: a number, a text, a setting, a pair or a file."""
    value = random.choice((*TEXTS, *NUMBERS))
    match random.randrange(8):
        case 0:
            return random.choice(_SETTINGS) + value
        case 1:
            return f"{value},{random.choice(NUMBERS)}"
        case 2:
            return random.choice(
                ("t.csv", "t.csv:a", "u=t.csv", "power=", "vehicle=w.toml", "w.toml", "r", "scooter")
            )
        case 3:
            return value + random.choice(("s", "ms", "%", " ", ".toml", ".fmu", ".csv", ".png"))
        case _:
            return value


def a_command(random: random.Random) -> Input:
    """A command line with other words, options and values in it."""
    words = random.choice(_BEGINNINGS.strip().splitlines()).split()
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        _change(random, words)
    if words and words[0] in _NOT_TRIED and not any(word == "nothing" for word in words):
        words.append("nothing")
    kept = [word.replace("\0", "") for word in words if word not in _NOT_TRIED or word == "reproduce"]
    return Input("CLI", kept, dict(_RESULTS))


def _change(random: random.Random, words: list[str]) -> None:
    declared = options(words[0]) if words else ()
    given = [j for j in range(1, len(words)) if words[j - 1].startswith("-") and not words[j].startswith("-")]
    i = random.randrange(len(words)) if words else 0
    chance = random.random()
    if given and chance < 0.35:
        words[random.choice(given)] = a_value(random)
    elif declared and chance < 0.75:
        option = random.choice(declared)
        words += [random.choice(option.opts)] + (
            [] if getattr(option, "is_flag", False) else [a_value(random)]
        )
    elif not words:
        words.append(a_value(random))
    else:
        match random.randrange(6):
            case 0:
                words[i] = a_value(random)
            case 1:
                words[i] = words[i].partition("=")[0] + "=" + a_value(random)
            case 2:
                words.insert(i, a_value(random))
            case 3:
                words.insert(i, random.choice(words))
            case 4:
                del words[i]
            case _:
                words[i] = words[i] + a_value(random)
