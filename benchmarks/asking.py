"""Measurements in processes of their own, each master in turn, the best of several rounds."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any

from . import machine
from .case import Case

_TIMEOUT = 300.0  # s


@dataclasses.dataclass(frozen=True)
class Figure:
    """What came of a master in a case: `microseconds` a step of the whole loop, or else the `reason`.

    `one_core`: it was fastest with one processor to run on; threads that wait for each other cost some
    masters more than they gain.
    """

    master: str
    version: str
    case: Case
    microseconds: float | None = None
    one_core: bool = False
    reason: str = ""


def measured(
    masters: Sequence[str], case: Case, rounds: int, pythons: Mapping[str, str] | None = None
) -> list[Figure]:
    """The best of each master: in turn, `rounds` times over, with all processors and with one.

    A master that cannot do the case is asked once. `pythons` are the interpreters of masters that are
    installed in environments of their own.
    """
    found: dict[str, Figure] = {}
    ways = [False, True] if len(machine.cores()) > 1 else [False]
    for one_core in ways * rounds:
        for master in masters:
            before = found.get(master)
            if before is None or before.microseconds is not None:
                python = (pythons or {}).get(master, sys.executable)
                found[master] = _better(before, ask(master, case, one_core, python))
    return [found[master] for master in masters]


def _better(before: Figure | None, now: Figure) -> Figure:
    """The faster one; one that failed now and then counts with the times that it has."""
    if before is None or before.microseconds is None:
        return now
    return now if now.microseconds is not None and now.microseconds < before.microseconds else before


def ask(master: str, case: Case, one_core: bool = False, python: str = sys.executable) -> Figure:
    """Measure once, in a new process, which may use one processor or all."""
    command = [python, "-m", "benchmarks.worker", master, json.dumps(dataclasses.asdict(case))]
    before = machine.cores()
    try:
        if one_core and before:
            os.sched_setaffinity(0, before[:1])  # the child inherits it
        answer = _answer(command)
    finally:
        if one_core and before:
            os.sched_setaffinity(0, before)
    known = {name: answer[name] for name in ("version", "microseconds") if name in answer}
    return Figure(
        master, known.pop("version", ""), case, one_core=one_core, reason=answer.get("error", ""), **known
    )


def _answer(command: list[str]) -> dict[str, Any]:
    try:
        # some masters unpack FMUs and never delete them
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
            own = os.environ | dict.fromkeys(("TMPDIR", "TEMP", "TMP"), scratch)
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=_TIMEOUT, check=False, env=own
            )
        answer: dict[str, Any] = json.loads(done.stdout)
        return answer
    except subprocess.TimeoutExpired:
        return {"error": f"took more than {_TIMEOUT:g} s"}
    except ValueError:
        return {"error": f"its process ended with code {done.returncode}"}
    except OSError as error:
        return {"error": f"{command[0]} cannot be started: {error.strerror or error}"}
