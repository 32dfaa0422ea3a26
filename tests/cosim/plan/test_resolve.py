"""From files to the plan: every wrong system or scenario is refused with place, rule and values."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.units.measure import Affine
from support.car import plan
from support.databases import write
from support.mocks import MockUnit, plan_of, real


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("car.mass", 0.5, "0.5 kg is below the minimum 1.0 kg of mass"),
        ("car.mass", 2e4, "above the maximum 10000.0 kg"),
        ("car.mass", float("nan"), "finite Real number, not nan"),
        ("car.mass", True, "finite Real number, not true$"),
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


@pytest.mark.parametrize(
    ("scenario", "said"),
    [
        (
            {"stimulus": [{"to": "car.grad", "constant": 1}]},
            r"^test.toml: stimulus 1.to: .*no variable 'grad' \(did you mean 'grade'\?\)",
        ),
        (
            {"stimulus": [{"to": "car.throttle", "constant": 1, "unit": "N"}]},
            "^test.toml: stimulus 1.unit: .*different quantities",
        ),
        (
            {"stimulus": [{"to": "car.throttle", "constant": 1, "unit": "tbd"}]},
            r"^test.toml: stimulus 1.unit: .*'tbd' is not known; say what it is in: the stimulus' own `unit`$",
        ),
        (
            {"stimulus": [{"to": "car.grade", "csv": "no.csv"}]},
            "^test.toml: stimulus 1.csv: there is no file 'no.csv'",
        ),
        (
            {"stimulus": [{"to": "car.grade", "ramp": {"slope": 1, "end": -1}}]},
            "^test.toml: stimulus 1.ramp: .*never reaches",
        ),
        (
            {"stimulus": [{"to": "ecu.speed", "constant": 1}]},
            "^test.toml: stimulus 1.to: ecu.speed is driven already, by car.speed",
        ),
        (
            {"event": [{"time": 1, "action": "override", "variable": "car.speed", "value": 1}]},
            "no input 'car.speed'",
        ),
        ({"leave_out": ["caar"]}, r"no unit 'caar' in mocks.toml \(did you mean 'car'\?\)"),
        (
            {"parameters": {"car": {"mass": True}}},
            "test.toml: parameters.car.mass: mass is a finite Real number, not true$",
        ),
        (
            {"experiment": {"stop_time": -1.0}},
            "^test.toml: experiment.stop_time -1.0 s is not after start_time 0.0 s",
        ),
        (
            {"experiment": {"stop_time": 1.0, "step_size": 0.03}},
            r"^test.toml: experiment.stop_time = 1.0 s is not a multiple of the communication step 0.03 s; the nearest are 0.99 s and 1.02 s$",
        ),
        ({"parameters": {"car": {"mass": 0}}}, "test.toml: parameters.car.mass: 0 kg is below the minimum"),
        (
            {"record": ["car.spee"]},
            r"^test.toml: record: 'car.spee' fits no variable \(did you mean 'car.speed'\?\)",
        ),
    ],
)
def test_a_wrong_scenario_is_named(scenario, said):
    with pytest.raises(ConfigError, match=said):
        plan([{"from": "car.speed", "to": ["ecu.speed"]}], scenario)


@pytest.mark.parametrize("stop_time", [1e8, 1e300])
def test_a_run_that_no_memory_holds_is_refused(stop_time):
    with pytest.raises(ConfigError, match=r"steps of 0\.01 s with .* recorded variables are more than"):
        plan([], options={"stop_time": stop_time})


@pytest.mark.parametrize(
    ("column", "unit", "said"),
    [
        ("speed [m/s]", None, True), ("v (m/s)", None, True), ("speed [mph]", None, True),
        ("speed [m/s]", "m/s", False), ("speed [km/h]", None, False), ("speed [kph]", None, False),
        ("speed", None, False), ("speed [filtered]", None, False), ("speed [1]", None, False),
    ],
)  # fmt: skip # a table
def test_a_column_that_says_another_unit_than_its_input_is_a_warning(tmp_path, column, unit, said):
    (tmp_path / "v.csv").write_text(f"time,{column}\n0,1\n1,2\n")
    entry = {"to": "ecu.speed", "csv": str(tmp_path / "v.csv")} | ({"unit": unit} if unit else {})
    warnings = " ".join(plan([], {"stimulus": [entry]}).warnings)
    assert (f"column '{column}': its values are taken in [km/h], the unit of ecu.speed" in warnings) == said


def test_a_second_column_of_times_is_a_warning_unless_the_stimulus_says_which_is_meant(tmp_path):
    (tmp_path / "v.csv").write_text("t [s],time,x\n0,0,1\n1,2,5\n")
    entry = {"to": "ecu.speed", "csv": str(tmp_path / "v.csv"), "column": "x"}
    said = (
        "2 is taken as the time, though column 't [s]' has another one, 1; `time_column` says which is meant"
    )
    assert said in " ".join(plan([], {"stimulus": [entry]}).warnings)
    assert "taken as the time" not in " ".join(
        plan([], {"stimulus": [entry | {"time_column": "t [s]"}]}).warnings
    )


@pytest.mark.parametrize(("own", "given"), [("degC", "delta_degC"), ("K", "delta_K"), ("delta_degC", "degC")])
def test_a_stimulus_in_a_unit_of_differences_drives_no_absolute_input(tmp_path, own, given):
    unit = MockUnit("a", [real("t", "input", unit=own)])
    (tmp_path / "t.csv").write_text(f"time,t [{given}]\n0,1\n1,2\n")
    for value in ({"constant": 5.0}, {"csv": str(tmp_path / "t.csv")}, {"table": [[0.0, 5.0]]}):
        with pytest.raises(ConfigError, match=r"stimulus 1.unit: .* cannot feed a.t .* means nothing to the"):
            plan_of([unit], {}, {"stimulus": [{"to": "a.t", "unit": given} | value]})
    made = plan_of([unit], {}, {"stimulus": [{"to": "a.t", "csv": str(tmp_path / "t.csv")}]})
    assert f"its values are taken in [{own}], the unit of a.t; [{given}] is a" in made.warnings[0]
    if given.startswith("delta"):
        warming = MockUnit("a", [real("t", "input", unit="K", difference=True)])
        (drive,) = plan_of(
            [warming], {}, {"stimulus": [{"to": "a.t", "unit": given, "constant": 5.0}]}
        ).drives
        assert drive.map == Affine()


def framed(folder, experiment, own, faults=(), **options):
    units = [MockUnit("a", [real("y", "output")]), MockUnit("b", [real("x", "input")])]
    system = {
        "experiment": experiment,
        "buses": {
            "c": {"dbc": str(write(folder, 'S : 0|8@1+ (1,0) [0|0] "" X')), "cycle_time": 3600.0} | own
        },
        "connect": [{"from": "a.y", "to": ["b.x"], "via": "c.M.S"}],
    }
    return plan_of(units, system, {"fault": list(faults)}, **options)


LOSE = {"action": "lose", "time": 0.0, "message": "c.M"}


@pytest.mark.parametrize(
    ("bus", "faults"),
    [({"timing": "frame"}, ()), ({"messages": {"M": {"timeout": 2}}}, ()), ({}, [LOSE])],
)
def test_frames_whose_times_cannot_count_are_refused(tmp_path, bus, faults):
    long = {"start_time": -1e7, "stop_time": -1e7 + 1112 * 3600.0, "step_size": 3600.0}
    assert framed(tmp_path, long, {}).steps == 1112  # plain values have no times
    assert framed(tmp_path, long | {"stop_time": -1e7 + 1111 * 3600.0}, bus, faults).framed_bus == "c"
    with pytest.raises(
        ConfigError, match=r"experiment\.stop_time = -5996800\.0 s: bus c has frames .* 4e\+06 s"
    ):
        framed(tmp_path, long, bus, faults)
