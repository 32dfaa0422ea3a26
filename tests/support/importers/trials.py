"""The trials: jobs for an importer, and what its answer differs from evcosim's run of the same FMU alone.

A finding is a number, the largest difference of an output in shares of its range (0: the same bits), or a
line that says why there is none. What is recorded of a trial is a summary over models:

    {"models": number of right ones, "largest": their largest difference, "others": {why: [names]}}
"""

from __future__ import annotations

import ast
import functools
import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import fmpy

from evcosim import simulate
from evcosim.fmus.build import built, names
from evcosim.fmus.native.build import native_built
from evcosim.fmus.native.wanted import Wanted

Rows = list[list[dict[str, float]]]  # of each instance after each step
Finding = float | str
KINDS = ("python", "native 2", "native 3")
STEP, EXACT_STEP, STEPS = 0.01, 1.0 / 128.0, 200
RIGHT = 1e-9  # a difference of less is one of rounding
TRIALS = ("run", "exact", "parameters", "two", "state")
SAID = ("text", "nothing")  # of a refusal; else what was said instead


class Job(NamedTuple):
    """An FMU, what to set (`inputs` of each instance), how far to step; `saves`: from a saved state on."""

    model: str
    kind: str
    parameters: Mapping[str, Any]
    inputs: tuple[Mapping[str, Any], ...]
    step: float = STEP
    count: int = STEPS
    saves: bool = False

    @property
    def fmi(self) -> int:
        """The version of FMI."""
        return 3 if self.kind == "native 3" else 2

    @property
    def fmu(self) -> Path:
        """The file."""
        return fmu(self.model, self.kind)


class Deep(NamedTuple):
    """What is set in a model that is tried further; `second` are the inputs of a second instance."""

    parameters: Mapping[str, Any]
    inputs: Mapping[str, Any]
    second: Mapping[str, Any]
    refused: Mapping[str, Any]
    said: str


# Each names all inputs: some importers set those to 0 that nobody names.
DEEP = {
    "Scooter": Deep(
        {"mass": 180.0, "initial_speed": 3.0},
        {"throttle": 60.0, "brake_force": 1.0, "road_grade": 0.01, "available_power": 2500.0},
        {"throttle": 30.0, "brake_force": 0.0, "road_grade": 0.0, "available_power": 1e12},
        {"mass": -5.0},
        "mass = -5.0 kg is below its minimum 1.0 kg",
    ),
    "BoundController": Deep(
        {"gain": 0.5, "dwell_time": 0.25, "speed_resolution": 0.5},
        {
            "throttle_request": 80.0,
            "speed_measured": 29.0,
            "speed_bound": 28.0,
            "acceleration_bound": 0.7,
            "throttle_position": 70.0,
            "front_wheel_speed": 40.0,
            "rear_wheel_speed": 41.0,
        },
        {
            "throttle_request": 20.0,
            "speed_measured": 12.0,
            "speed_bound": 30.0,
            "acceleration_bound": 1.0,
            "throttle_position": 20.0,
            "front_wheel_speed": 17.0,
            "rear_wheel_speed": 17.0,
        },
        {"time_constant": -1.0},
        "time_constant = -1.0 s is below its minimum 0.001 s",
    ),
    "TwoWheelerBraking": Deep(
        {"mass": 220.0, "initial_speed": 80.0},
        {"front_torque": 150.0, "rear_torque": 40.0},
        {"front_torque": 90.0, "rear_torque": 10.0},
        {"wheel_radius": 0.0},
        "wheel_radius = 0.0 m is below its minimum 0.01 m",
    ),
}


@functools.cache
def fmu(model: str, kind: str) -> Path:
    """Return the FMU of a built-in model."""
    if kind == "python":
        return built(model)
    return native_built(model, wanted=Wanted(fmi=int(kind[-1])))


@functools.cache
def description(model: str, kind: str) -> Any:
    """Return the description of an FMU."""
    return fmpy.read_model_description(str(fmu(model, kind)))


def variables(model: str, kind: str) -> dict[str, tuple[int, str]]:
    """Return the value reference and the type, by the names of FMI 2.0, of each variable."""
    types = {"Float64": "Real", "Int32": "Integer"}
    found = description(model, kind).modelVariables
    return {v.name: (v.valueReference, types.get(v.type, v.type)) for v in found}


def outputs(model: str) -> list[str]:
    """Return the names of the outputs."""
    return [v.name for v in description(model, "python").modelVariables if v.causality == "output"]


def starts(model: str) -> dict[str, Any]:
    """Return the start value of each input, in its type."""
    read = {"Real": float, "Integer": int, "Enumeration": int, "Boolean": lambda text: text in ("true", "1")}
    found = description(model, "python").modelVariables
    return {v.name: read[v.type](v.start) for v in found if v.causality == "input"}


@functools.cache
def _reference(model: str, parameters: str, inputs: str, step: float, count: int) -> list[dict[str, float]]:
    results = simulate(
        model,
        parameters=dict(ast.literal_eval(parameters)),
        inputs=dict(ast.literal_eval(inputs)),
        step_size=step,
        stop_time=step * count,
    )
    discrete = {v.name for v in description(model, "python").modelVariables if v.variability == "discrete"}
    columns = {name: results[f"fmu.{name}"] for name in outputs(model)}
    return [
        {name: float(column[k - (name in discrete)]) for name, column in columns.items()}
        for k in range(1, count + 1)  # a discrete output is evcosim's from the beginning of a step on
    ]


def reference(job: Job) -> Rows:
    """Return what evcosim computes, with the FMU in Python alone, for each instance."""
    return [
        _reference(
            job.model, repr(sorted(job.parameters.items())), repr(sorted(i.items())), job.step, job.count
        )
        for i in job.inputs
    ]


def difference(job: Job, rows: Rows) -> Finding:
    """Return how far rows are from the reference, in shares of an output's range or, if constant, value."""
    expected = reference(job)
    if [len(of_one) for of_one in rows] != [job.count] * len(job.inputs):
        return f"{[len(of_one) for of_one in rows]} rows instead of {job.count} for each instance"
    worst = 0.0
    for found, right in zip(rows, expected, strict=True):
        for name in found[0]:
            values = [row[name] for row in right]
            size, spread = max(map(abs, values)), max(values) - min(values)
            scale = (spread if spread > RIGHT * size else size) or 1.0  # else it would be rounding itself
            apart = [abs(a[name] - b) for a, b in zip(found, values, strict=True)]
            worst = max(worst, max(apart) / scale if all(map(math.isfinite, apart)) else math.inf)
    return worst


def jobs(model: str, kind: str) -> dict[str, Job]:
    """Return the further trials of a model: a run, parameters, two instances, a saved state."""
    deep = DEEP[model]
    return {
        "run": Job(model, kind, {}, (deep.inputs,)),
        "exact": Job(model, kind, {}, (deep.inputs,), EXACT_STEP),
        "parameters": Job(model, kind, deep.parameters, (deep.inputs,)),
        "two": Job(model, kind, deep.parameters, (deep.inputs, deep.second)),
        "state": Job(model, kind, {}, (deep.inputs,), saves=True),
    }


def first_steps(model: str, kind: str) -> Job:
    """Return the trial of a model that is loaded and takes two steps; some importers refuse a single one."""
    return Job(model, kind, {}, (starts(model),), count=2)


def refused(model: str, kind: str) -> Job:
    """Return the trial whose parameter the model refuses."""
    deep = DEEP[model]
    return Job(model, kind, deep.refused, (deep.inputs,), count=2)


class Said(NamedTuple):
    """An answer: rows or none, and all that was printed."""

    rows: Rows | None
    text: str


Run = Callable[[Job], Said]


def tried(run: Run, kind: str, can: frozenset[str]) -> dict[str, Any]:
    """Return what is recorded of an importer that `can` do some of parameters, two, state.

    Models that it does not load are not tried further.
    """
    loaded = {name: _found(run, first_steps(name, kind)) for name in names()}
    found: dict[str, Any] = {"loaded": summary(loaded)}
    deep = [model for model in DEEP if _right(loaded[model])]
    for what in TRIALS:
        if deep and (what in can or what in ("run", "exact")):
            found[what] = summary({model: _found(run, jobs(model, kind)[what]) for model in deep})
    if deep and "parameters" in can:
        found["refusal"] = grouped({model: _refusal(run, model, kind) for model in deep})
    return found


def summary(findings: Mapping[str, Finding]) -> dict[str, Any]:
    """Return what is recorded of the findings of some models."""
    right = [value for value in findings.values() if not isinstance(value, str) and value < RIGHT]
    others = {
        model: value if isinstance(value, str) else f"apart by {value:.1e} of the range"
        for model, value in findings.items()
        if not _right(value)
    }
    return {"models": len(right), "largest": max(right, default=None), "others": grouped(others)}


def grouped(said: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the models of each thing that was said."""
    return {text: [model for model in said if said[model] == text] for text in dict.fromkeys(said.values())}


def _right(value: Finding) -> bool:
    return not isinstance(value, str) and value < RIGHT


def _found(run: Run, job: Job) -> Finding:
    said = run(job)
    return why(said.text, job.model) if said.rows is None else difference(job, said.rows)


def _refusal(run: Run, model: str, kind: str) -> str:
    """Return what an importer shows of a refused parameter: the model's text, a status alone, or nothing."""
    said = run(refused(model, kind))
    if said.rows is not None:
        return "nothing"
    return "text" if DEEP[model].said in " ".join(said.text.split()) else why(said.text, model)


def why(text: str, model: str = "") -> str:
    """Return the line of a program's last words that says most, without what changes from run to run."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    telling = [
        line
        for line in lines
        if any(word in line.lower() for word in ("error", "exception", "fail", "undefined", "signal"))
    ]
    chosen = (telling or lines or ["nothing said"])[-1]
    if model:
        chosen = re.sub(rf"(/\S*/)?\b{model}\.so", "the library", chosen)
    return chosen if len(chosen) <= 160 else chosen[:157] + "..."
