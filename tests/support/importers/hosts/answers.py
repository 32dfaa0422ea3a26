"""The job of an importer, and its answer: what the programs of this folder have in common.

They run in an environment in which evcosim is not installed, so that they import nothing of the project.
"""

from __future__ import annotations

import json
import sys
from typing import Any


class Job:
    """An FMU, what to set, how far to step, and what to tell.

    `inputs` has a dictionary for each instance; `variables` the value reference and type of each variable.
    """

    def __init__(self, given: dict[str, Any]) -> None:
        self.fmu: str = given["fmu"]
        self.fmi: int = given["fmi"]
        self.step: float = given["step"]
        self.count: int = given["count"]
        self.parameters: dict[str, Any] = given["parameters"]
        self.inputs: list[dict[str, Any]] = given["inputs"]
        self.outputs: list[str] = given["outputs"]
        self.variables: dict[str, tuple[int, str]] = given["variables"]
        self.saves: bool = given["saves"]

    def time(self, k: int) -> float:
        """Return the time after k steps."""
        return k * self.step

    def of_type(self, *types: str) -> list[str]:
        """Return the outputs of these types."""
        return [name for name in self.outputs if self.variables[name][1] in types]


def read() -> Job:
    """Return the job that the command line names."""
    with open(sys.argv[1], encoding="utf-8") as file:
        return Job(json.load(file))


def answer(instances: list[list[dict[str, float]]], note: str = "") -> None:
    """Print the outputs of each instance after each step, exactly."""
    rows = [[{name: float(value) for name, value in row.items()} for row in rows] for rows in instances]
    sys.stdout.flush()
    print("ANSWER " + json.dumps({"instances": rows, "note": note}), flush=True)
