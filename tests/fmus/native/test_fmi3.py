"""Native FMUs of FMI 3.0 beside those of FMI 2.0: the same values and words, by the names of 3.0."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

from evcosim.fmus.catalog import Experiment
from evcosim.fmus.description import Origin
from evcosim.fmus.native.description3 import describe_3
from evcosim.fmus.native.package import native_content
from evcosim.models.base import Model, record, var

NO_ITEM = "is no item of its enumeration (-1 reverse, 1 neutral, 2 forward)"
KINDS = ("Handmade", "HandmadeSampled", "HandmadePlain")
SETTERS = {"Real": "Float64", "Integer": "Int32", "Enumeration": "Int64", "Boolean": "Boolean"}


class Unit3:
    """One instance of an FMU of FMI 3.0: values by name, messages kept."""

    def __init__(self, path: Path, folder: Path) -> None:
        fmpy.extract(str(path), str(folder))
        self.description = fmpy.read_model_description(str(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.log: list[tuple[int, str, str]] = []
        self.fmu = FMU3Slave(
            guid=self.description.instantiationToken,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="it",
        )
        self.fmu.instantiate(loggingOn=True, logMessage=self.note)

    def note(self, _: Any, status: int, category: bytes, message: bytes) -> None:
        """Keep a message."""
        self.log.append((status, category.decode(), message.decode()))

    def kind(self, name: str) -> str:
        """Return the name of the functions of a variable."""
        kind = self.variables[name].type
        return "Int64" if kind == "Enumeration" else str(kind)

    def set(self, values: dict[str, Any]) -> None:
        """Set each variable by the function of its type."""
        for name, value in values.items():
            getattr(self.fmu, f"set{self.kind(name)}")([self.variables[name].valueReference], [value])

    def get(self, *names: str) -> dict[str, Any]:
        """Return values by name, all outputs if none is named."""
        wanted = names or [name for name, v in self.variables.items() if v.causality == "output"]
        return {
            name: getattr(self.fmu, f"get{self.kind(name)}")([self.variables[name].valueReference])[0]
            for name in wanted
        }

    def initialize(self, values: dict[str, Any] | None = None, start: float = 0.0) -> None:
        """Set values and enter the step mode."""
        self.set(values or {})
        self.fmu.enterInitializationMode(startTime=start)
        self.fmu.exitInitializationMode()

    def refused(self, call: str, *arguments: Any, status: int = 3) -> str:
        """Return the message of a call that fails."""
        before = len(self.log)
        with pytest.raises(Exception, match=f"status {status}"):
            getattr(self.fmu, call)(*arguments)
        ((level, category, message),) = self.log[before:]
        assert (level, category) == (3, "logStatusError")
        return message


@pytest.fixture
def load3(pairs: Callable[..., Any], tmp_path: Path) -> Iterator[Callable[[str], Unit3]]:
    """Instantiate native FMUs of FMI 3.0; they are freed at the end."""
    loaded: list[Unit3] = []

    def one(name: str) -> Unit3:
        loaded.append(Unit3(pairs(name, 3).native, tmp_path / f"three{len(loaded)}"))
        return loaded[-1]

    yield one
    for unit in loaded:
        unit.fmu.freeInstance()


@pytest.mark.parametrize("name", KINDS)
def test_the_same_run_as_in_fmi_2(
    name: str, pairs: Callable[..., Any], load: Any, load3: Any, random_inputs: Any, bits: Any
) -> None:
    two, three = load(pairs(name).native), load3(name)
    start = {"gain": 3.3, "limit": 1, "mode": -1}
    before = len(two.log)
    for unit in (two, three):
        unit.initialize(start, start=5.0)
    for k, values in enumerate(random_inputs(pairs(name).model, 60, 7)):
        for unit in (two, three):
            unit.set(values)
        two.fmu.doStep(5.0 + 0.01 * k, 0.01)
        said = three.fmu.doStep(5.0 + 0.01 * k, 0.01)
        assert said == (False, False, False, 5.0 + 0.01 * k + 0.01)
        assert bits(two.get()) == bits(three.get())
    assert [text for _, _, text in two.log[before:]] == [text for _, _, text in three.log]
    assert len(three.log) > 1
    state = three.fmu.getFMUState()
    content = three.fmu.serializeFMUState(state)
    three.fmu.freeFMUState(state)
    assert two.fmu.serializeFMUState(two.fmu.getFMUState()) == content  # and they can be exchanged


@pytest.mark.parametrize("name", KINDS)
def test_validators_are_silent(name: str, pairs: Callable[..., Any]) -> None:
    three = pairs(name, 3).native
    assert validate_fmu(str(three)) == []
    both = [
        fmpy.simulate_fmu(str(path), stop_time=0.5, output_interval=0.1)
        for path in (three, pairs(name).native)
    ]
    assert (both[0] == both[1]).all()


def test_the_words_of_refusals(load3: Any) -> None:
    unit = load3("Handmade")
    assert unit.refused("getFloat64", [12]) == "fmi3GetFloat64: the initialization mode has not been entered"
    unit.initialize()
    for call, arguments, expected in (
        ("setFloat64", ([99, 9], [0.0, 0.0]), "there is no Float64 variable with value reference 9, 99"),
        ("setFloat64", ([0], [0.0]), "gain is a fixed parameter: it cannot be set after the initialization"),
        ("setFloat64", ([7], [0.0, 1.0]), "there are 2 values for 1 value references"),
        ("setInt32", ([11], [1]), "there is no Int32 variable with value reference 11"),
        ("setInt64", ([9], [1]), "there is no Int64 variable with value reference 9"),
        ("setInt64", ([11], [0]), f"lever = 0 {NO_ITEM}"),
        ("setInt64", ([16], [2]), "last is neither parameter nor input: it cannot be set"),
        ("getBoolean", ([7],), "there is no Boolean variable with value reference 7"),
        ("getString", ([7],), "there is no String variable with value reference 7"),
        ("setUInt8", ([7], [1]), "there is no UInt8 variable with value reference 7"),
        ("terminate", (), None),
        ("setFloat64", ([7], [0.0]), "it was terminated"),
    ):  # fmt: skip # one case a line
        if expected is None:
            getattr(unit.fmu, call)(*arguments)
        else:
            assert unit.refused(call, *arguments) == f"fmi3{call[0].upper()}{call[1:]}: {expected}"


def test_steps_that_fail(load3: Any) -> None:
    unit = load3("HandmadePlain")
    unit.initialize({"word": 3, "limit": 9})
    for k in range(2):
        unit.fmu.doStep(float(k), 1.0)
    said = unit.refused("doStep", 2.0, 1.0, status=2)
    assert said == "fmi3DoStep at t = 2.0 s: output ticks is 3000000000, which is no Int32"
    assert unit.refused("doStep", 1e22, -1.0, status=2) == (
        "fmi3DoStep at t = 1e+22 s: the step is -1.0 s: it must be finite and longer than 0"
    )


def test_percent_signs_are_not_doubled(load3: Any) -> None:
    unit = load3("Handmade")
    unit.set({"share": 120.0})
    unit.fmu.enterInitializationMode()
    assert unit.refused("exitInitializationMode") == (
        "fmi3ExitInitializationMode: share = 120.0 % is above its maximum 100 %"
    )


def test_the_time_is_a_variable_of_every_fmu(load3: Any) -> None:
    plain, timed = load3("HandmadePlain"), load3("HandmadeSampled")
    for unit in (plain, timed):
        unit.initialize(start=2.0)
    assert plain.get("time") == {"time": 2.0}
    assert timed.get("clock") == {"clock": 2.0}
    for unit in (plain, timed):
        unit.fmu.doStep(2.0, 0.5)
    assert plain.get("time") == {"time": 2.5}
    assert timed.get("clock") == {"clock": 2.0}  # a sampled model computes at the start of the step
    assert plain.refused("setFloat64", [17], [1.0]) == (
        "fmi3SetFloat64: the time is neither parameter nor input: it cannot be set"
    )
    assert timed.refused("getFloat64", [18]).endswith("no Float64 variable with value reference 18")


def test_functions_that_it_does_not_have(load3: Any, pairs: Callable[..., Any]) -> None:
    unit = load3("Handmade")
    unit.initialize()
    headers = Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h"
    names = set(re.findall(r"FMI3_Export\s+\w+TYPE\s+(fmi3\w+);", headers.read_text()))
    has = re.compile(
        "fmi3(GetVersion|SetDebugLogging|Instantiate.*|FreeInstance|(Enter|Exit)InitializationMode|Terminate"
        "|Reset|[GS]et(U?Int|Float)[0-9]+|[GS]et(Boolean|String|Binary|Clock)|.*FMUState(Size)?|DoStep)"
    )
    lacking = sorted(name for name in names if not has.fullmatch(name))
    assert len(lacking) == 30
    for name in lacking:
        before = len(unit.log)
        function = ctypes.CDLL(unit.fmu.dll._name)[name]
        assert function(ctypes.c_void_p(unit.fmu.component), *[ctypes.c_void_p()] * 8) == 3
        assert unit.log[before:] == [(3, "logStatusError", f"{name}: this FMU does not support it")]


def test_instances_that_cannot_be(load3: Any) -> None:
    unit = load3("Handmade")
    for wanted, expected in (
        ({"eventModeUsed": True}, "Handmade has no event mode"),
        ({"requiredIntermediateVariables": [12]}, "Handmade has no intermediate values within a step"),
    ):
        other = _another(unit)
        with pytest.raises(Exception, match="Failed to instantiate"):
            other.instantiate(logMessage=unit.note, **wanted)
        assert unit.log[-1] == (3, "logStatusError", f"fmi3InstantiateCoSimulation: {expected}")
    other = _another(unit)
    other.guid = "50 %"
    with pytest.raises(Exception, match="Failed to instantiate"):
        other.instantiate(logMessage=unit.note)
    assert "the instantiationToken is '50 %', that of Handmade is '{" in unit.log[-1][2]


def _another(unit: Unit3) -> Any:
    return FMU3Slave(
        guid=unit.description.instantiationToken,
        unzipDirectory=unit.fmu.unzipDirectory,
        modelIdentifier="Handmade",
        instanceName="another",
    )


def test_the_description_says_the_same_in_both_versions(pairs: Callable[..., Any]) -> None:
    two, three = (fmpy.read_model_description(str(pairs("Handmade", fmi).native)) for fmi in (2, 3))
    for old, new in zip(two.modelVariables, three.modelVariables, strict=True):
        assert SETTERS[old.type].replace("Int64", "Enumeration") == new.type
        for what in ("name", "valueReference", "causality", "variability", "initial", "unit", "min", "max"):
            assert getattr(old, what) == getattr(new, what), (old.name, what)
        for what in ("start", "nominal", "description"):
            assert getattr(old, what) == getattr(new, what), (old.name, what)
    assert repr(two.unitDefinitions) == repr(three.unitDefinitions)
    for which in ("outputs", "initialUnknowns"):
        said = [
            [(u.variable.name, [d.name for d in u.dependencies]) for u in getattr(about, which)]
            for about in (two, three)
        ]
        assert said[0] == said[1]
    assert [(item.name, item.value) for item in three.typeDefinitions[0].items] == [
        ("reverse", "-1"), ("neutral", "1"), ("forward", "2")
    ]  # fmt: skip
    assert three.coSimulation.canGetAndSetFMUstate and three.coSimulation.canSerializeFMUstate


def test_a_model_with_a_variable_named_time() -> None:
    class Named(Model):
        """Has a parameter that is named so."""

        @record
        class Parameters:
            """One."""

            time: float = var(0.0, "s", "A time")

        @record
        class Inputs:
            """None."""

        @record
        class State:
            """None."""

        @record
        class Outputs:
            """None."""

        initial = step = outputs = staticmethod(lambda p, x: None)

    text = describe_3(Named, Origin("{1}", "tool", "", ""), Experiment()).decode()
    assert '<Float64 name="simulation_time" valueReference="1"' in text


def test_only_2_and_3(parts: Callable[..., Any]) -> None:
    with pytest.raises(ValueError, match="native FMUs of FMI 2 and 3, not of 1"):
        native_content(parts("Handmade"), fmi=1)
