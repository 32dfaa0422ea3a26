"""A hostile number in any argument of the public functions makes a result or an error that names it."""

from __future__ import annotations

import inspect
import math
import os
import re
import traceback
from collections.abc import Callable, Iterator
from typing import Any, get_type_hints

import numpy as np
import pytest

import evcosim
from evcosim import BusVariation, ConfigError, IdentificationSpec, RunError, Simulation, Task
from support import small_bench
from support.forked import forked

VALUES: list[Any] = [
    0,
    -1,
    -0.0,
    1e308,
    -1e308,
    5e-324,
    math.inf,
    math.nan,
    np.float64("nan"),
    2**63,
    10**400,
    -(10**5000),
    True,
    "0.5",
    [1],
]
SHORT: dict[str, Any] = {"engine": "python"}


def simulated(**options: Any) -> Any:
    return evcosim.simulate("s.toml", **SHORT, **options)


def of_one_fmu(**options: Any) -> Any:
    return evcosim.simulate("Battery", **SHORT, **({"stop_time": 0.03, "step_size": 0.01} | options))


def driven(call: Callable[[Simulation], object]) -> Any:
    """Do something with a simulation before its steps, and return its results."""
    with Simulation("s.toml", **SHORT) as simulation:
        call(simulation)
        simulation.run()
    return simulation.results


def identified(**changes: Any) -> Any:
    good = {"input": "throttle", "output": "speed", "amplitude": 1.0, "sweep": (0.5, 2.0), "duration": 4.0}
    return evcosim.identify("Scooter", IdentificationSpec(**good), **SHORT, **changes)


CALLS: dict[str, list[Callable[[Any], object]]] = {
    "RunOptions.parameters": [
        lambda x: simulated(parameters={"vehicle.mass": x}),
        lambda x: of_one_fmu(parameters={"capacity": x}),
    ],
    "RunOptions.inputs": [lambda x: of_one_fmu(inputs={"power": x})],
    "RunOptions.stop_time": [
        lambda x: simulated(stop_time=x),
        lambda x: of_one_fmu(stop_time=x),
        lambda x: of_one_fmu(stop_time=x, step_size=None),
    ],
    "RunOptions.start": [
        lambda x: simulated(start={"vehicle.road_grade": x}),
        lambda x: of_one_fmu(start={"power": x}),
    ],
    "RunOptions.delay": [lambda x: simulated(delay=x)],
    "RunOptions.step_size": [
        lambda x: of_one_fmu(step_size=x),
        lambda x: simulated(step_size=x),
        lambda x: identified(step_size=x),
    ],
    "RunOptions.tolerance": [lambda x: of_one_fmu(tolerance=x)],
    "Simulation.step.steps": [lambda x: driven(lambda s: s.step(x))],
    "Simulation.set.value": [lambda x: driven(lambda s: s.set("ecu.speed_bound", x))],
    "Simulation.override.value": [
        lambda x: driven(lambda s: s.override("vehicle.throttle", x)),
        lambda x: driven(lambda s: s.override("ecu.speed_measured", x)),
    ],
    "Simulation.follow.values": [
        lambda x: driven(lambda s: s.follow("vehicle.throttle", x)),
        lambda x: driven(lambda s: s.follow("vehicle.throttle", [x])),
        lambda x: driven(lambda s: s.follow("vehicle.throttle", [0.0, x])),
    ],
    "Simulation.bias.value": [lambda x: driven(lambda s: s.bias("vehicle.throttle", x))],
    "BusVariation.delay_steps": [lambda x: simulated(bus=BusVariation(delay_steps=x))],
    "BusVariation.resolution": [lambda x: simulated(bus=BusVariation(resolution=x))],
    "BusVariation.cycle": [lambda x: simulated(bus=BusVariation(cycle=x))],
    "BusVariation.jitter": [lambda x: simulated(bus=BusVariation(jitter=x, timing="frame"))],
    "BusVariation.loss": [lambda x: simulated(bus=BusVariation(loss=x))],
    "BusVariation.seed": [lambda x: simulated(bus=BusVariation(loss=0.5, seed=x))],
    "budget.seeds": [lambda x: evcosim.budget("s.toml", seeds=x, stop_time=0.01, workers=1, **SHORT)],
    "budget.workers": [lambda x: evcosim.budget("s.toml", workers=x, stop_time=0.01, **SHORT)],
    "run_all.workers": [lambda x: evcosim.run_all([Task("a", abs, (1,))], workers=x)],
}
"""Calls with a number in each argument that takes one."""

PARTS = (evcosim.Simulation, evcosim.BusVariation)
"""The classes that a caller makes or calls with numbers."""


def numeric_arguments() -> Iterator[str]:
    """Yield the arguments of the public functions, and of PARTS, that take a number or a value."""
    for name in get_type_hints(evcosim.RunOptions):
        if _is_number(evcosim.RunOptions.__annotations__[name]):
            yield f"RunOptions.{name}"
    calls = {name: getattr(evcosim, name) for name in evcosim.__all__}
    functions = {name: call for name, call in calls.items() if inspect.isfunction(call)}
    functions |= {part.__name__: part for part in PARTS}
    functions |= {
        f"{part.__name__}.{name}": call
        for part in PARTS
        for name, call in vars(part).items()
        if inspect.isfunction(call) and not name.startswith("_")
    }
    for name, call in functions.items():
        for parameter in inspect.signature(call).parameters.values():
            if parameter.kind is not parameter.VAR_KEYWORD and _is_number(parameter.annotation):
                yield f"{name}.{parameter.name}"


def _is_number(annotation: Any) -> bool:
    """Return True for an annotation with a number in it, or a value of any type."""
    text = getattr(annotation, "__forward_arg__", None) or str(annotation)
    return bool(re.search(r"\b(int|float|Value|Resolution)\b", text)) and "Callable" not in text


def outcome(call: Callable[[Any], object], value: Any) -> str:
    try:
        call(value)
    except ConfigError as error:
        return f"refused: {error}"
    except RunError as error:
        return f"ended: {error}"
    except TypeError as error:  # another type than the signature says
        return f"refused: {error}" if "is needed" in str(error) else traceback.format_exc()
    except Exception:  # to name the value beside it
        return traceback.format_exc()
    return "done"


def test_every_number_is_tried():
    # how a variation is put on settings is the engine's own
    assert set(numeric_arguments()) - {"BusVariation.of.step_size"} == set(CALLS)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each argument is tried in a child of this process")
@pytest.mark.parametrize("name", CALLS)
def test_a_hostile_number_is_used_or_refused(name, tmp_path, monkeypatch):
    small_bench.write(tmp_path)
    monkeypatch.chdir(tmp_path)
    # any number of workers is used, and so many processes take their time
    values = [x for x in VALUES if not (name == "budget.workers" and isinstance(x, int) and x > 1)]
    cases = [(call, value) for call in CALLS[name] for value in values]
    found = forked(lambda: [outcome(*case) for case in cases], limit=120.0)
    assert not found.crash, found.crash
    key = name.rpartition(".")[2]
    for (_, value), said in zip(cases, found.value, strict=True):
        shown = hex(value)[:40] if isinstance(value, int) else repr(value)[:40]
        assert said.startswith(("done", "refused", "ended")), f"{shown}: {said}"
        words = (key, "vehicle", "ecu", "power", "capacity", "experiment", shown)
        assert said == "done" or any(word in said for word in words), f"{shown}: {said}"
        assert len(said) < 2000, f"{shown}: {said}"
