"""The compiled engine gives what the python engine gives, bit for bit, with the same errors and counts."""

from __future__ import annotations

import numpy as np
import pytest

from evcosim.cosim.errors import RunError
from evcosim.cosim.system.scenario import scenario_names
from evcosim.cosim.system.system import load_system, system_names
from evcosim.cosim.units.conversion import between
from evcosim.cosim.units.spellings import EXACT
from evcosim.cosim.units.words import WORDS
from evcosim.master.engine.compiled.engine import CompiledEngine
from evcosim.master.engine.initialization import initialize
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.simulation import Simulation
from support.c_fmu import mixed_fmu
from support.mocks import MockUnit, plan_of, real, started
from support.needs import need_c_compiler
from support.straight import by_code, is_straight

pytestmark = pytest.mark.usefixtures("warm_units")

BUILT_IN = [(s, c) for s in system_names() for c in (None, *scenario_names(load_system(s)))]
EVENTS = """
[[event]]
time = 0.5
action = "override"
variable = "n0.u0"
value = 2.5
[[event]]
time = 0.9
action = "bias"
variable = "n1.u0"
value = -0.125
[[event]]
time = 1.3
action = "reset"
variable = "n0.u0"
"""


def run(engine, system, scenario=None, steps=None, straight=False, **options):
    """Recorded bits, saturations, warnings and the error's text ("": none)."""
    options = {"isolation": "none"} | options
    with by_code(straight), Simulation(system, scenario, engine=engine, **options) as simulation:
        assert simulation.manifest()["experiment"]["engine"] == engine
        error = ""
        try:
            simulation.step(min(simulation.plan.steps, steps or simulation.plan.steps))
        except RunError as failure:
            error = str(failure)
        assert is_straight(simulation._engine) == (straight and POSSIBLE)
        results = simulation.results
        bits = np.stack([results[v.name] for v in results.variables]).view(np.int64)
        return bits, simulation.manifest()["saturations"], simulation.warnings, error


def same(system, scenario=None, steps=None, **options):
    """Both engines agree, the compiled one by its tables and by code for the structure; what they gave."""
    python = run("python", system, scenario, steps, **options)
    for straight in (False, True):
        compiled = run("compiled", system, scenario, steps, straight, **options)
        assert python[1:] == compiled[1:]
        assert np.array_equal(python[0], compiled[0])
    return python


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize(("system", "scenario"), BUILT_IN, ids=lambda value: value or "default")
def test_built_in_systems(system, scenario, algorithm):
    bits, *_, error = same(system, scenario, 300, algorithm=algorithm)
    assert not error
    assert len({row.tobytes() for row in bits}) > 5  # there is something to compare


def test_a_detailed_plant_in_the_place_of_the_plain_one_here_and_in_a_process_of_its_own():
    """Its states are stiff between the steps, and its rear wheel leaves the road within the 0.3 s."""
    plant = {"fmus": {"vehicle": "DetailedTwoWheeler"}}
    bits, *_, error = same("braking", "known_speed", 30, **plant)
    assert not error
    assert np.array_equal(same("braking", "known_speed", 30, isolation="process", **plant)[0], bits)
    with Simulation("braking", "known_speed", isolation="none", **plant) as simulation:
        simulation.step(30)
        assert simulation.results["vehicle.rear_load"].min() == 0.0


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize("overflow", ["saturate", "wrap"])
@pytest.mark.parametrize("rounding", ["nearest", "half_even", "truncate"])
def test_every_rounding_and_overflow_of_the_bus(ring, tmp_path, rounding, overflow, algorithm):
    (tmp_path / "events.toml").write_text(EVENTS)
    system = ring(f'rounding = "{rounding}"\noverflow = "{overflow}"\nresolution = 1.3', bias=100.0)
    _, saturations, _, error = same(system, tmp_path / "events.toml", algorithm=algorithm)
    assert saturations
    assert not error


def test_a_value_that_no_signal_holds_is_the_same_error(ring):
    *_, error = same(ring('overflow = "error"', bias=100.0))
    assert error.startswith("at t = ")
    assert "via can0.M" in error


@pytest.mark.parametrize("offset", [0.0, 0.02])
def test_delays_cycles_periods_offsets_and_substeps(ring, tmp_path, offset):
    (tmp_path / "events.toml").write_text(EVENTS)
    system = ring("delay = 0.05\ncycle = 2", f"period = 0.03\noffset = {offset}\nsubsteps = 2")
    assert not same(system, tmp_path / "events.toml")[-1]


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_every_type_of_a_variable(tmp_path, fmi):
    need_c_compiler()
    fmu = mixed_fmu(tmp_path / "mixed.fmu", fmi)
    (tmp_path / "s.toml").write_text(
        f'name = "mixed"\n[experiment]\nstop_time = 1.0\n[units.a]\nfmu = "{fmu}"\n'
    )
    assert not same(tmp_path / "s.toml")[-1]


ONE = 'name = "one"\n[experiment]\nstop_time = 1.0\n[units.a]\nfmu = "{fmu}"\n'
RISING = '[[stimulus]]\nto = "a.{to}"\ntable = [[0.0, 0.0], [1.0, {end}]]\n'


def one(folder, fmi, behavior=0, to="u", end=1.0):
    """The system of sources/mixed.c alone, which does wrong in some way, and a scenario that drives it."""
    need_c_compiler()
    (folder / "s.toml").write_text(ONE.format(fmu=mixed_fmu(folder / "mixed.fmu", fmi, behavior)))
    (folder / "rising.toml").write_text(RISING.format(to=to, end=end))
    return folder / "s.toml", folder / "rising.toml"


@pytest.mark.parametrize("fmi", [1, 2, 3])
@pytest.mark.parametrize(
    ("behavior", "step", "reason"),
    [
        (12, 50, "DoStep returned Discard (2)"),
        (17, 50, "DoStep returned no FMI status (7)"),
        (73, 50, "returned Error (3)"),
        (83, 49, "returned Error (3)"),
        (2, 50, "a.y = nan: an output must be finite"),
    ],
)
def test_what_a_unit_does_wrong(tmp_path, fmi, behavior, step, reason):
    bits, *_, error = same(*one(tmp_path, fmi, behavior))
    assert error.startswith(f"at t = {step / 100:g} s (step {step}): ")
    assert reason in error
    assert bits.shape[1] == step


@pytest.mark.parametrize("fmi", [1, 2, 3])
@pytest.mark.parametrize("behavior", [11, 71, 81])
def test_warnings_of_a_unit_are_counted(tmp_path, fmi, behavior):
    *_, warnings, error = same(*one(tmp_path, fmi, behavior))
    assert any(text.startswith("unit 'a' gave ") for text in warnings)
    assert not error


def test_a_step_of_fmi_3_that_ends_otherwise(tmp_path):
    bits, *_, error = same(*one(tmp_path, 3, 3))  # it asks to end the simulation
    assert (bits.shape[1], error) == (52, "")
    assert same(*one(tmp_path, 3, 4))[-1].startswith("at t = 0.5 s (step 50): unit 'a': fmi3DoStep ")


def test_a_value_that_its_type_does_not_hold(tmp_path):
    """A bias takes the 100 of an Int8 beyond its greatest number at t = 0.64 s."""
    system, scenario = one(tmp_path, 3, to="int8_in", end=0.0)
    event = '[[event]]\ntime = {}\naction = "bias"\nvariable = "a.int8_in"\nvalue = {}\n'
    scenario.write_text(scenario.read_text() + event.format(0.3, 100.0) + event.format(0.64, 128.0))
    *_, error = same(system, scenario)
    assert error.startswith("at t = 0.64 s (step 64): unit 'a': int8_in cannot be set to 128: ")


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_units_in_processes_of_their_own(ring, tmp_path, algorithm):
    """All four pairs of an engine and where the units are."""
    (tmp_path / "events.toml").write_text(EVENTS)
    runs = [
        same(ring(), tmp_path / "events.toml", algorithm=algorithm, isolation=isolation)
        for isolation in ("none", "process")
    ]
    assert np.array_equal(runs[0][0], runs[1][0])
    assert runs[0][1:] == runs[1][1:]


@pytest.mark.parametrize("overflow", ["saturate", "wrap"])
@pytest.mark.parametrize("rounding", ["nearest", "half_even", "truncate"])
def test_signals_whose_raw_values_no_double_holds(ring, rounding, overflow):
    """56 bits of 2^-50: the channel computes in integers."""
    system = ring(f'rounding = "{rounding}"\noverflow = "{overflow}"', bias=100.0)
    dbc = system.with_name("ring.dbc")
    narrow = "16|16@1- (0.0009765625,0) [-30|30]"
    assert dbc.read_text().count(narrow) == 3
    dbc.write_text(
        dbc.read_text()
        .replace(narrow, "8|56@1- (8.881784197001252e-16,0) [-30|30]")
        .replace("0|16@1- (0.0009765625,0)", "0|8@1- (0.25,0)")
    )
    with Simulation(system, trust=True) as simulation:
        kinds = {o.kind for sender in simulation._engine.senders for o in sender.channel.operations}
    assert kinds == {"integer", "exact"}
    assert not same(system)[-1]


def mock(broken_at):
    def step(values, time, step_size):
        values["x"] += step_size * values["u"] if time < broken_at else float("nan")

    return MockUnit("m", [real("u", "input"), real("x", "output", unit="m")], step, x=1.0)


def test_units_written_in_python_and_their_errors():
    connect = {"connect": [{"from": "m.x", "to": ["m.u"]}]}
    found = []
    for compiled in (False, True):
        units = [mock(0.5)]
        plan = plan_of(units, connect)
        if compiled:
            engine = CompiledEngine(plan, {"m": units[0]})
            initialize({"m": units[0]}, plan)
            engine.start()
        else:
            engine = started(units, plan)
        with pytest.raises(
            RunError, match=r"^at t = 0\.5 s .*m\.x = nan m: an output must be finite"
        ) as raised:
            engine.advance(100)
        found.append((str(raised.value), engine.recorded().whole().tobytes()))
    assert found[0] == found[1]


DBC = """VERSION ""
BS_:
BU_: ECU
{messages}
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;
BA_DEF_DEF_ "GenMsgCycleTime" 10;
"""
MESSAGE = 'BO_ {i} M{i}: 8 ECU\n SG_ S : 0|64@1- (1e-06,0) [0|0] "{text}" ECU\n'


OF_TWO_QUANTITIES = {"C", "F", "g", "G", "kt"}
"""Spellings whose meanings the other side tells apart; other open ones are refused, since each would do."""


def test_every_spelling_of_a_unit_is_the_same_number(tmp_path):
    """From a variable in each spelling, directly and over a signal in it, to one in what it means."""
    rows = [(spelling, m) for spelling, meaning, _ in (*WORDS, *EXACT) for m in meaning.split(" | ")]
    several = {spelling for spelling, meaning, _ in (*WORDS, *EXACT) if " | " in meaning}
    assert several > OF_TWO_QUANTITIES
    rows = [row for row in rows if row[0] not in several - OF_TWO_QUANTITIES]
    messages = [MESSAGE.format(i=i, text=text) for i, (text, _) in enumerate(rows)]
    (tmp_path / "it.dbc").write_text(DBC.format(messages="\n".join(messages)), encoding="utf-8")
    n = range(len(rows))
    connect = [{"from": f"a.y{i}", "to": [f"b.u{i}"]} for i in n]
    connect += [{"from": f"a.z{i}", "to": [f"b.v{i}"], "via": f"can0.M{i}.S"} for i in n]
    found = []
    for compiled in (False, True):
        sent = [real(f"y{i}", "output", unit=rows[i][0], start=1.0 + 0.37 * i) for i in n]
        sent += [real(f"z{i}", "output", unit=rows[i][1], start=1.0 + 0.37 * i) for i in n]
        received = [real(f"{name}{i}", "input", unit=rows[i][1]) for name in "uv" for i in n]
        units = {"a": MockUnit("a", sent), "b": MockUnit("b", received)}
        plan = plan_of(
            [*units.values()],
            {"connect": connect, "buses": {"can0": {"dbc": str(tmp_path / "it.dbc"), "bitrate": 10**7}}},
        )
        if compiled:
            engine = CompiledEngine(plan, units)
            initialize(units, plan)
            engine.start()
        else:
            engine = started([*units.values()], plan)
        engine.advance(2)
        found.append(engine.recorded().whole())
    assert found[0].tobytes() == found[1].tobytes()
    last = dict(zip([c.name for c in plan.columns], found[0][-1], strict=True))
    for i, (spelling, meaning) in enumerate(rows):
        assert last[f"b.u{i}"] == pytest.approx(between(spelling, meaning)(1.0 + 0.37 * i), rel=1e-14)
        assert last[f"b.v{i}"] == pytest.approx(1.0 + 0.37 * i, rel=1e-3, abs=2e-3)


SCALED = """
[units.a.map.inputs]
torque = { variable = "u", unit = "N.m", factor = -2.5, offset = 1.0, convert = false }
[units.a.map.outputs]
speed = { variable = "y", unit = "m/s", factor = 0.1, offset = -3.0, convert = false }
"""


@pytest.mark.parametrize("isolation", ["none", "process"])
@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_values_that_a_mapping_scales(tmp_path, fmi, isolation):
    """The system's torque is taken times -2.5 plus 1, the FMU's output times 0.1 less 3."""
    system, scenario = one(tmp_path, fmi, end=4.0)
    (tmp_path / "scaled.toml").write_text(system.read_text() + SCALED)
    (tmp_path / "down.toml").write_text(scenario.read_text().replace("a.u", "a.torque"))
    (tmp_path / "same.toml").write_text('[[stimulus]]\nto = "a.u"\ntable = [[0.0, 1.0], [1.0, -9.0]]\n')
    found = same(tmp_path / "scaled.toml", tmp_path / "down.toml", isolation=isolation)
    assert not found[-1]
    with Simulation(system, tmp_path / "same.toml") as plain:
        plain.step(plain.plan.steps)
        expected = 0.1 * plain.results["a.y"] - 3.0
    with Simulation(tmp_path / "scaled.toml", tmp_path / "down.toml", isolation=isolation) as scaled:
        assert scaled.manifest()["units"]["a"]["map"]["inputs"]["torque"]["factor"] == -2.5
        scaled.step(scaled.plan.steps)
        assert scaled.results.units["a.torque"] == "N.m"
        assert scaled.results["a.speed"] == pytest.approx(expected, abs=1e-12)
