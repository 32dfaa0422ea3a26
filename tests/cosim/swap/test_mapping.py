"""An FMU under the names of a system: names, units of measure and signs there and back, and what is absent."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.swap.mapping import present, without_absent, without_open, without_untaken
from evcosim.cosim.system.scenario import Scenario, ScenarioFile
from evcosim.cosim.system.system import System, SystemFile, UnitEntry
from evcosim.cosim.units.measure import Affine

FMU = UnitInterface(
    "V.fmu",
    {
        v.name: v
        for v in (
            VariableInfo("pedal", causality="input", unit="%", start=5.0, min=0.0, max=100.0),
            VariableInfo("mode", "Boolean", "input", "discrete"),
            VariableInfo("v", causality="output", unit="m/s", depends=("pedal",), depends_initially=None),
            VariableInfo("s", causality="local", unit="m"),
            VariableInfo("m_total", causality="parameter", unit="kg", start=200.0),
            VariableInfo("label", "String", "parameter", "fixed"),
            VariableInfo("odd", causality="local", unit="tbd"),
        )
    },
    unusable={"w": "is of type Binary, which no one can ask for"},
)


def shown(**tables: object) -> UnitInterface:
    """Return the FMU with these tables of a map."""
    return present(FMU, UnitEntry.model_validate({"fmu": "V.fmu", "map": tables}), "s.toml: units.u.")


def test_without_a_map_it_is_the_interface_itself() -> None:
    assert shown() is FMU
    assert shown(inputs={}) is FMU


def test_a_variable_is_known_by_the_systems_name_alone() -> None:
    known = shown(inputs={"throttle": "pedal"}, outputs={"speed": "v"}, parameters={"mass": "m_total"})
    assert set(known.variables) == {"throttle", "mode", "speed", "s", "mass", "label", "odd"}
    assert {v.declared_name for v in known.variables.values()} == set(FMU.variables)
    assert known.variables["s"] == FMU.variables["s"]


def test_dependencies_follow_the_names() -> None:
    speed = shown(inputs={"throttle": "pedal"}, outputs={"speed": "v"}).variables["speed"]
    assert (speed.depends, speed.depends_initially) == (("throttle",), None)


def test_a_local_variable_is_an_output_of_the_system() -> None:
    distance = shown(outputs={"distance": "s"}).variables["distance"]
    assert (distance.causality, distance.declared) == ("output", "s")


def test_inverting_turns_start_and_range_and_twice_is_nothing() -> None:
    throttle = shown(inputs={"throttle": {"variable": "pedal", "invert": True}}).variables["throttle"]
    assert (throttle.start, throttle.min, throttle.max) == (-5.0, -100.0, 0.0)
    assert throttle.inverted
    once = shown(inputs={"pedal": {"variable": "pedal", "invert": True}})
    entry = UnitEntry.model_validate(
        {"fmu": "V.fmu", "map": {"inputs": {"pedal": {"variable": "pedal", "invert": True}}}}
    )
    twice = present(once, entry, "").variables["pedal"]
    before = FMU.variables["pedal"]
    assert (twice.start, twice.min, twice.max, twice.inverted) == (
        before.start,
        before.min,
        before.max,
        before.inverted,
    )


def test_a_unit_of_measure_takes_the_place_of_the_declared_one() -> None:
    known = shown(inputs={"throttle": {"variable": "pedal", "unit": "1"}}).variables["throttle"]
    assert known.unit == "1"


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"inputs": {"x": "pedall"}}, "map.inputs.x: V.fmu has no variable 'pedall' (did you mean 'pedal'?)"),
        ({"inputs": {"x": "v"}}, "map.inputs.x: v is of causality output, not input"),
        ({"parameters": {"x": "pedal"}}, "map.parameters.x: pedal is of causality input, not parameter or structuralParameter"),
        ({"outputs": {"x": "w"}}, "map.outputs.x: w is of type Binary, which no one can ask for"),
        ({"inputs": {"x": {"variable": "pedal", "unit": "blub"}}}, "map.inputs.x: unit of measure 'blub' is not known"),
        ({"parameters": {"x": {"variable": "label", "unit": "m"}}}, "map.parameters.x: label is a String, which has no unit of measure"),
        ({"inputs": {"x": {"variable": "mode", "invert": True}}}, "map.inputs.x: mode is a Boolean: it has no sign to invert"),
        ({"inputs": {"x": "pedal"}, "outputs": {"x": "v"}}, "map.outputs.x: 'x' is mapped twice"),
        ({"inputs": {"my x": "v"}}, "map.inputs.'my x': v is of causality output, not input"),
    ],
)  # fmt: skip # one case a line
def test_what_cannot_be_mapped_is_named_with_its_key(tables: dict[str, object], said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        shown(**tables)
    assert str(caught.value).startswith(f"s.toml: units.u.{said}")


# ---- what is absent

SYSTEM = {
    "name": "s",
    "units": {"u": {"fmu": "F", "absent": ["x", "y"]}, "w": {"fmu": "F"}},
    "buses": {"can0": {"dbc": "x.dbc"}},
    "connect": [
        {"from": "u.y", "to": ["w.a"]},
        {"from": "w.b", "to": ["u.x", "w.c"]},
        {"from": "w.b", "to": ["u.x"], "via": "can0.M.S"},
        {"from": "w.b", "to": ["u.x"]},
        {"from": "u.z", "to": ["w.d"]},
    ],
    "record": ["w.*", "u.y", "u.z", "!u.x"],
    "figure": {"panels": [{"signals": ["u.y", "u.z"]}]},
    "metrics": [{"name": "of y", "signal": "u.y"}, {"name": "of z", "signal": "u.z"}],
    "budget": {"metric": "of y", "limit": 1.0},
}
DRIVEN = {
    "stimulus": [{"to": "u.x", "constant": 1.0}, {"to": "w.e", "constant": 1.0}],
    "event": [
        {"time": 1.0, "action": "reset", "variable": "u.x"},
        {"time": 1.0, "action": "reset", "variable": "w.e"},
    ],
    "parameters": {"u": {"x": 1.0, "p": 2.0}},
    "start": {"u": {"x": 1.0}},
}


def left(**system: object) -> tuple[System, Scenario, tuple[str, ...]]:
    return without_absent(
        System(Path("s.toml"), SystemFile.model_validate(SYSTEM | system)),
        Scenario("t", Path("t.toml"), ScenarioFile.model_validate(DRIVEN)),
    )


def test_what_needs_absent_variables_is_left_out_and_said() -> None:
    system, scenario, said = left()
    assert [(c.source, c.to) for c in system.file.connect] == [
        ("w.b", ["w.c"]),
        ("w.b", []),  # still sent over the bus
        ("u.z", ["w.d"]),
    ]
    assert [m.name for m in system.file.metrics] == ["of z"]
    assert system.file.budget is None
    assert [s.name for s in system.file.figure.panels[0].signals] == ["u.z"] if system.file.figure else False
    assert [s.to for _, s in scenario.file.stimuli] == ["w.e"]
    assert [e.needs for e in scenario.file.events] == [("w.e",)]
    assert scenario.file.parameters == {"u": {"p": 2.0}}
    assert scenario.file.start == {"u": {}}
    assert system.file.record == ["w.*", "u.z"]
    assert said == tuple(
        f"left out, since it is absent: {text}"
        for text in (
            "u.y -> w.a; a receiver keeps its start value",
            "w.b -> u.x",
            "metric 'of y'",
            "u.y in the figure",
            "u.y in the record",
            "the stimulus of u.x",
            "the event 'reset' of u.x at 1 s",
            "the value of u.x",
        )
    )


def test_what_is_left_out_of_a_connection_stands_in_the_order_of_the_file() -> None:
    names = [f"u.x{i}" for i in range(20)]
    absent = [name.removeprefix("u.") for name in names]
    units = {"u": {"fmu": "F", "absent": absent}, "w": {"fmu": "F"}}
    *_, said = left(units=units, connect=[{"from": "w.b", "to": ["w.c", *names]}])
    assert said == (f"left out, since it is absent: w.b -> {', '.join(names)}",)


def test_nothing_of_what_is_left_names_what_is_absent() -> None:
    system, scenario, _ = left()
    text = system.file.model_dump_json(exclude={"units"}) + scenario.file.model_dump_json()
    assert "u.x" not in text
    assert "u.y" not in text


def test_leaving_out_twice_is_leaving_out_once() -> None:
    system, scenario, _ = left()
    assert without_absent(system, scenario) == (system, scenario, ())


def test_an_optional_connection_is_left_out_where_an_fmu_has_no_variable_for_it() -> None:
    connect = [
        {"from": "w.b", "to": ["u.pedal", "u.extra"], "optional": True},
        {"from": "w.gone", "to": ["u.pedal"], "optional": True},
        {"from": "w.gone", "to": ["u.extra"]},
        {"from": "out.x", "to": ["u.pedal"], "optional": True},
    ]
    file = {"name": "s", "units": {n: {"fmu": "F"} for n in ("u", "w", "out")}, "connect": connect}
    system = System(Path("s.toml"), SystemFile.model_validate(file))
    w = UnitInterface("W.fmu", {"b": VariableInfo("b", causality="output")})
    left, said = without_untaken(system, {"u": FMU, "w": w})  # out takes no part
    assert [(c.source, c.to) for c in left.file.connect] == [
        ("w.b", ["u.pedal"]),
        ("w.gone", ["u.extra"]),  # what is needed is refused later, by name
        ("out.x", ["u.pedal"]),
    ]
    assert said == (
        "left out, since the FMU has no u.extra: w.b -> u.extra",
        "left out, since the FMU has no w.gone: w.gone -> u.pedal; a receiver keeps its start value",
    )
    assert without_untaken(left, {"u": FMU}) == (left, ())


def test_with_nothing_absent_all_stays() -> None:
    units = {"u": {"fmu": "F"}, "w": {"fmu": "F"}}
    system, scenario, said = left(units=units)
    assert system.file == SystemFile.model_validate(SYSTEM | {"units": units})
    assert scenario.file == ScenarioFile.model_validate(DRIVEN)
    assert said == ()


def test_a_factor_is_between_the_systems_quantity_and_the_fmus() -> None:
    torque = {"variable": "pedal", "unit": "N.m", "factor": -0.5, "offset": 10.0}
    known = shown(inputs={"torque": torque}).variables["torque"]
    assert (known.unit, known.scaling) == ("N.m", Affine(-0.5, 10.0))
    assert (known.min, known.start, known.max) == (-180.0, 10.0, 20.0)  # 100, 5, 0 %
    assert known.to_fmu == Affine(-0.5, 10.0)
    speed = shown(outputs={"frequency": {"variable": "v", "unit": "Hz", "factor": 2.0}}).variables[
        "frequency"
    ]
    assert (speed.unit, speed.from_fmu, speed.to_fmu) == ("Hz", Affine(2.0), Affine(0.5))


def test_a_unit_of_measure_beside_a_factor_is_the_systems() -> None:
    for convert, scale in ((True, 36.0), (False, 10.0)):
        entry = {"variable": "v", "unit": "km/h", "factor": 10.0, "convert": convert}
        speed = shown(outputs={"speed": entry}).variables["speed"]
        assert (speed.unit, speed.scaling) == ("km/h", Affine(scale))
    mass = shown(parameters={"mass": {"variable": "m_total", "unit": "t", "convert": True}}).variables["mass"]
    assert (mass.start, mass.to_fmu(0.3), mass.from_fmu(300.0)) == (0.2, 300.0, pytest.approx(0.3))


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"outputs": {"speed": {"variable": "v", "unit": "km/h", "factor": 3.6}}}, "say `convert = true`"),
        ({"outputs": {"speed": {"variable": "v", "factor": 3.6}}}, "say `convert = true`"),
        (
            {"inputs": {"on": {"variable": "mode", "factor": 2.0}}},
            "of type Boolean: only a Real can be scaled",
        ),
        (
            {"outputs": {"f": {"variable": "v", "unit": "N", "factor": 5e-324}}},
            "no number holds the way back",
        ),
        (
            {"outputs": {"f": {"variable": "odd", "unit": "V", "convert": True}}},
            "'tbd' is not known; with `convert = false` no unit of measure of odd counts$",
        ),
        (
            {"outputs": {"f": {"variable": "m_total", "unit": "ton", "convert": True}}},
            "several meanings; say what it is in: `unit` here$",
        ),
    ],
)
def test_what_cannot_be_scaled_is_named_with_its_key(tables: dict[str, object], said: str) -> None:
    with pytest.raises(ConfigError, match=rf"^s.toml: units.u.map\.\w+\.\w+: .*{said}"):
        shown(**tables)


def test_open_names_stop_a_run_unless_they_are_allowed() -> None:
    entry = {"fmu": "V.fmu", "open": ["throttle", "speed", "mass"], "map": {"outputs": {"speed": "v"}}}
    system = System(Path("s.toml"), SystemFile.model_validate({"name": "s", "units": {"u": entry}}))
    with pytest.raises(ConfigError, match=r"s.toml: units.u.open: .*V.fmu is chosen for throttle, mass; map"):
        without_open(system, False)
    allowed, units = without_open(system, True)
    assert units == ("u",)  # a name that is mapped is open no longer
    assert (allowed.file.units["u"].absent, allowed.file.units["u"].open) == (["throttle", "mass"], [])
    assert without_open(allowed, False) == (allowed, ())
