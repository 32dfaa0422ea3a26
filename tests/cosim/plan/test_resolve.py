"""From files to the plan: every wrong system or scenario is refused with place, rule and values."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import UnitInterface, VariableInfo
from evcosim.cosim.system.system import SystemFile, load_system
from evcosim.cosim.system.toml import read_toml, validate
from evcosim.cosim.units import Affine, UnitOfMeasure
from support.mocks import MockUnit, plan_of, real

SPEED = (0, 1, -1, 0, 0, 0, 0, 0)
DEFINED = {
    "m/s": UnitOfMeasure("m/s", SPEED),
    "km/h": UnitOfMeasure("km/h", SPEED, 1 / 3.6),
    "N": UnitOfMeasure("N", (1, 1, -2, 0, 0, 0, 0, 0)),
    "%": UnitOfMeasure("%", (0,) * 8, 0.01),
}


def unit(name: str, *variables: VariableInfo) -> MockUnit:
    mock = MockUnit(name, list(variables))
    mock.interface = UnitInterface(f"{name}.fmu", mock.interface.variables, DEFINED)
    return mock


def car() -> MockUnit:
    return unit(
        "car",
        real("throttle", "input", unit="%"),
        real("grade", "input"),
        real("speed", "output", unit="m/s"),
        real("force", "output", unit="N"),
        VariableInfo("gear", "Integer", "output", "discrete"),
        real("mass", "parameter", unit="kg", start=200.0, min=1.0, max=1e4),
        VariableInfo("sport", "Boolean", "parameter", "fixed", start=False),
        VariableInfo("mode", "Enumeration", "parameter", "fixed", start=0, items=((0, "eco"), (1, "fast"))),
        VariableInfo("count", "Integer", "parameter", "fixed", start=0),
    )


def ecu() -> MockUnit:
    return unit(
        "ecu",
        real("speed", "input", unit="km/h", start=0.0),
        VariableInfo("flag", "Boolean", "input", "discrete", start=False),
        real("throttle", "output", unit="%", variability="discrete"),
    )


def plan(connect, scenario=None, **more):
    options = more.pop("options", {})
    return plan_of([ecu(), car()], {"connect": connect, **more}, scenario, **options)


BUS = {"buses": {"can0": {"dbc": "can/ev.dbc"}}}
SENT = {"from": "car.speed", "to": ["ecu.speed"], "via": "can0.EMD_Status.EMD_VehicleSpeed"}


def test_a_direct_connection_converts_units():
    (route,) = [
        r for r in plan([{"from": "car.speed", "to": ["ecu.speed"]}]).units[0].routes if not r.map.identity
    ]
    assert route.map == Affine(3.6)


def test_a_bus_connection_converts_on_both_sides():
    (message,) = plan([SENT], **BUS).messages
    (signal,) = message.routes
    assert signal.to_bus == Affine(3.6)  # m/s to the signal's km/h
    assert [map_ for _, map_ in signal.sinks] == [Affine()]
    assert (message.every, message.first) == (1, 0)


def test_ideal_leaves_the_bus_out():
    assert plan([SENT], **BUS, options={"ideal": True}).messages == ()


@pytest.mark.parametrize(
    ("connect", "said"),
    [
        (
            [{"from": "car.spede", "to": ["ecu.speed"]}],
            r"'car' has no variable 'spede' \(did you mean 'speed'\?\)",
        ),
        ([{"from": "caar.speed", "to": ["ecu.speed"]}], r"no unit 'caar' \(did you mean 'car'\?\)"),
        (
            [{"from": "car.speed", "to": ["ecu.sped"]}],
            r"'ecu' has no variable 'sped' \(did you mean 'speed'\?\)",
        ),
        ([{"from": "ecu.speed", "to": ["car.throttle"]}], "causality input, not output or local"),
        ([{"from": "car.speed", "to": ["ecu.throttle"]}], "causality output, not input"),
        (
            [{"from": "car.speed", "to": ["car.throttle"]}],
            r"car.speed \[m/s\] cannot feed car.throttle \[%\]: .*different quantities",
        ),
        ([{"from": "car.speed", "to": ["ecu.flag"]}], "car.speed is of type Real, ecu.flag of type Boolean"),
        ([{"from": "car.speed"}], "needs a receiver in 'to' or a signal in 'via'"),
        (
            [{"from": "car.speed", "to": ["ecu.speed"]}, {"from": "car.speed", "to": ["ecu.speed"]}],
            "ecu.speed is driven already, by car.speed",
        ),
        ([SENT | {"via": "can1.EMD_Status.EMD_VehicleSpeed"}], r"no bus 'can1' \(did you mean 'can0'\?\)"),
        (
            [SENT | {"via": "can0.EMD_Stats.EMD_VehicleSpeed"}],
            r"no message 'EMD_Stats' \(did you mean 'EMD_Status'",
        ),
        ([SENT | {"via": "can0.EMD_Status.EMD_Speed"}], "no signal 'EMD_Speed'"),
        ([SENT | {"from": "car.force"}], r"car.force \[N\] cannot feed .* \[km/h\]"),
        ([SENT, SENT | {"from": "ecu.throttle", "to": []}], "is sent already, by car.speed"),
    ],
)
def test_a_wrong_connection_is_named(connect, said):
    for ideal in (False, True):
        if ideal and "sent already" in said:
            continue  # without the bus there is no signal to send twice
        with pytest.raises(ConfigError, match=said) as caught:
            plan(connect, **BUS, options={"ideal": ideal})
        assert "mocks.toml: connect" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("car.mass", 0.5, "0.5 kg is below the minimum 1.0 kg of mass"),
        ("car.mass", 2e4, "above the maximum 10000.0 kg"),
        ("car.mass", float("nan"), "finite Real number, not nan"),
        ("car.mass", True, "finite Real number, not True"),
        ("car.mass", "heavy", "finite Real number, not 'heavy'"),
        ("car.masss", 1.0, r"no variable 'masss' \(did you mean 'mass'\?\)"),
        ("car.speed", 1.0, "causality output, not parameter"),
        ("cart.mass", 1.0, r"no unit 'cart' \(did you mean 'car'\?\)"),
        ("car.sport", 2, "a Boolean, true or false, not 2"),
        ("car.mode", "fasst", r"no item 'fasst' \(did you mean 'fast'\?\)"),
        ("car.count", 1.5, "an Integer, not 1.5"),
    ],
)
def test_a_wrong_parameter_is_named(name, value, said):
    with pytest.raises(ConfigError, match=said) as caught:
        plan([], options={"parameters": {name: value}})
    assert name in str(caught.value)


def test_parameters_user_before_scenario_before_system():
    units = {"car": {"parameters": {"mass": 100.0, "mode": "fast"}}}
    scenario = {"parameters": {"car": {"mass": 150, "sport": True}}}
    assert plan([], scenario, units=units).units[1].parameters == {"mass": 150.0, "mode": 1, "sport": True}
    changed = plan([], scenario, units=units, options={"parameters": {"car.mass": 180}})
    assert changed.units[1].parameters["mass"] == 180.0


def test_a_unit_left_out_frees_its_receivers():
    connect = [{"from": "ecu.throttle", "to": ["car.throttle"]}, {"from": "car.speed", "to": ["ecu.speed"]}]
    both = plan_of([ecu(), car()], {"connect": connect})
    assert both.inputs["car.throttle"].driver == "ecu.throttle"
    alone = plan_of([ecu(), car()], {"connect": connect}, {"leave_out": ["ecu"]})
    assert [u.name for u in alone.units] == ["car"]
    assert alone.inputs["car.throttle"].driver == ""


@pytest.mark.parametrize(
    ("scenario", "said"),
    [
        ({"stimulus": [{"to": "car.grad", "constant": 1}]}, r"no variable 'grad' \(did you mean 'grade'\?\)"),
        ({"stimulus": [{"to": "car.throttle", "constant": 1, "unit": "N"}]}, "different quantities"),
        ({"stimulus": [{"to": "ecu.speed", "constant": 1}]}, "ecu.speed is driven already, by car.speed"),
        (
            {"event": [{"time": 1, "action": "override", "variable": "car.speed", "value": 1}]},
            "no input 'car.speed'",
        ),
        ({"leave_out": ["caar"]}, r"no unit 'caar' in mocks.toml \(did you mean 'car'\?\)"),
        ({"experiment": {"stop_time": -1.0}}, "stop_time -1.0 s is not after start_time 0.0 s"),
        (
            {"experiment": {"stop_time": 1.0, "step_size": 0.03}},
            "is not a multiple of the communication step 0.03 s",
        ),
        ({"parameters": {"car": {"mass": 0}}}, "test.toml: parameters.car.mass: 0 kg is below the minimum"),
        ({"record": ["car.spee"]}, r"'car.spee' fits no variable \(did you mean 'car.speed'\?\)"),
    ],
)
def test_a_wrong_scenario_is_named(scenario, said):
    with pytest.raises(ConfigError, match=said):
        plan([{"from": "car.speed", "to": ["ecu.speed"]}], scenario)


def test_what_is_recorded():
    names = [c.name for c in plan([], record=["car.*"]).columns]
    assert names == ["car.throttle", "car.grade", "car.speed", "car.force", "car.gear"]
    assert [c.name for c in plan([], record=["*.speed"]).columns] == ["ecu.speed", "car.speed"]


def test_a_missing_unit_of_measure_is_said():
    bare = unit("car", real("speed", "output"))
    plan_ = plan_of([ecu(), bare], {"connect": [{"from": "car.speed", "to": ["ecu.speed"]}]})
    assert plan_.warnings == ("car.speed declares no unit of measure; it is taken as [km/h]",)


# ---- the files


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name = 'x'\n[units.a]\nfmu = 'A'\nparametres = {}\n", r"units.a.parametres: unknown key \(did you mean 'parameters'"),
        ("name = 'x'\n", "units: this key is needed"),
        ("name = 'x'\n[units.a]\n", "units.a.fmu: this key is needed"),
        ("name = 'x'\n[units.a]\nfmu = 'A'\nsubsteps = 0\n", "units.a.substeps: .* not 0"),
        ("name = 'x'\n[units.a]\nfmu = 'A'\n[[connect]]\nfrom = 'a'\nto = ['a.b']\n", "written unit.variable, not 'a'"),
        ("name = 'x'\n[units.a]\nfmu = 'A'\n[experiment]\nalgorithm = 'gauss'\n", "algorithm: .*'gauss_seidel' or 'jacobi'"),
        ("name = x\n", "is not valid TOML: .*line 1"),
    ],
)  # fmt: skip # one case a line
def test_a_wrong_system_file_names_file_key_and_value(tmp_path, text, said):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=said) as caught:
        read_toml(path, SystemFile)
    assert "mine.toml" in str(caught.value)


def test_a_direct_connection_has_no_value_before_the_first_message():
    unit = {"fmu": "F"}
    data = {"name": "a", "units": {"u": unit, "w": unit}}
    connection = {"from": "u.y", "to": ["w.x"], "initial": 1.0}
    with pytest.raises(ConfigError, match="connect 1: 'initial' is what is there before the first message"):
        validate(data | {"connect": [connection]}, SystemFile, "s.toml")


@pytest.mark.parametrize("stop_time", [1e8, 1e300])
def test_a_run_that_no_memory_holds_is_refused(stop_time):
    with pytest.raises(ConfigError, match=r"steps of 0\.01 s with .* recorded variables are more than"):
        plan([], options={"stop_time": stop_time})


@pytest.mark.parametrize("mark", ["", "\ufeff"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_files_of_other_editors(tmp_path, mark, end):
    path = tmp_path / "a.toml"
    text = f'{mark}name = "a"{end}[units.u]{end}fmu = "F"{end}'
    path.write_bytes(text.encode())
    assert load_system(str(path)).file.units["u"].fmu == "F"


def test_unknown_names_say_what_there_is(tmp_path):
    with pytest.raises(
        ConfigError, match=r"unknown system 'scoter' \(did you mean 'scooter'\?\); known: .*scooter"
    ):
        load_system("scoter")
    with pytest.raises(ConfigError, match="there is no such system file"):
        load_system(str(tmp_path / "none.toml"))
