"""A bus that is late, coarse or slow: against the same bus shifted, another DBC, and closed forms."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest

from evcosim import Simulation, simulate
from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.system.system import System, SystemFile, load_system
from evcosim.cosim.system.toml import validate
from evcosim.cosim.system.variation import varied
from support.mocks import MockUnit, column, plan_of, real, started

STEPS = 60
DBC = """VERSION ""
NS_ :
BS_:
BU_: A B
BO_ 16 Values: 8 A
 SG_ Value : 0|16@1- ({scale},0.5) [-20|20] "m" B
 SG_ Bare : 16|8@1+ (0.25,0) [0|0] "m" B
 SG_ State : 24|8@1+ (1,0) [0|3] "" B
BO_ 17 Back: 8 B
 SG_ Command : 0|32@1- (0.001,0) [-100|100] "m" A
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_ BO_ "GenMsgStartDelayTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" {cycle};
BA_DEF_DEF_ "GenMsgStartDelayTime" {start};
BA_ "GenMsgCycleTime" BO_ 16 {cycle};
BA_ "GenMsgCycleTime" BO_ 17 {cycle};
"""


@pytest.fixture
def dbc(tmp_path):
    """Write a database and return its path."""

    def write(scale=0.1, cycle=10, start=0):
        path = tmp_path / f"{scale}-{cycle}-{start}.dbc"
        path.write_text(DBC.format(scale=scale, cycle=cycle, start=start))
        return str(path)

    return write


def source(variability: str = "continuous") -> MockUnit:
    """A walk of known steps, which leaves the signal's range now and then, and a state that counts 0 to 3."""

    def step(values, time, step_size):
        k = round(time / 0.01)
        values["x"] = random.Random(k).uniform(-25.0, 25.0)
        values["state"] = k % 4

    state = VariableInfo("state", "Enumeration", "output", "discrete", items=((0, "a"), (3, "d")))
    return MockUnit("source", [real("x", "output", unit="m", variability=variability), state], step)


def probe() -> MockUnit:
    """Receives all of it."""
    state = VariableInfo("state", "Enumeration", "input", "discrete", start=2, items=((0, "a"), (3, "d")))
    return MockUnit("probe", [real("x", "input", unit="m", start=1.5), real("bare", "input"), state])


def received(bus, *, variability="continuous", algorithm="gauss_seidel", first="source", what="x"):
    """What the probe receives at each communication point, over a bus with these keys."""
    units = [source(variability), probe()]
    if first == "probe":
        units.reverse()
    connect = [
        {"from": "source.x", "to": ["probe.x"], "via": "can0.Values.Value", "initial": 1.5},
        {"from": "source.state", "to": ["probe.state"], "via": "can0.Values.State"},
    ]
    system = {"connect": connect, "buses": {"can0": bus}}
    engine = started(units, plan_of(units, system, algorithm=algorithm))
    engine.advance(STEPS)
    return column(engine, f"probe.{what}")[:STEPS]


# ---- delay


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize("variability", ["continuous", "discrete"])
@pytest.mark.parametrize("first", ["source", "probe"])
@pytest.mark.parametrize(("cycle", "start"), [(10, 0), (30, 20)])
@pytest.mark.parametrize("delay", [1, 2, 7])
def test_a_delay_shifts_what_is_received(dbc, algorithm, variability, first, cycle, start, delay):
    options = {"algorithm": algorithm, "variability": variability, "first": first}
    database = dbc(cycle=cycle, start=start)
    for what, initial in (("x", 1.5), ("state", 2.0)):
        at_once = received({"dbc": database}, what=what, **options)
        late = received({"dbc": database, "delay": delay * 0.01}, what=what, **options)
        assert np.array_equal(late[delay:], at_once[:-delay])
        assert (late[:delay] == initial).all()
        assert len(np.unique(at_once)) >= 4


def test_no_delay_is_no_change(dbc):
    plain = received({"dbc": dbc()})
    assert np.array_equal(plain, received({"dbc": dbc(), "delay": 0.0, "resolution": 1.0, "cycle": 1}))


def control_loop(units, bus, algorithm):
    """x' = -2 x + u with u = -3 x, both ways over the bus; the recorded states."""
    connect = [
        {"from": "plant.x", "to": ["controller.x"], "via": "can0.Values.Value", "initial": 2.0},
        {"from": "controller.u", "to": ["plant.u"], "via": "can0.Back.Command"},
    ]
    system = {"connect": connect, "buses": {"can0": bus}}
    engine = started(units, plan_of(units, system, algorithm=algorithm))
    engine.advance(STEPS)
    return column(engine, "plant.x")


@pytest.mark.parametrize(("algorithm", "extra"), [("gauss_seidel", 0), ("jacobi", 1)])
@pytest.mark.parametrize("delay", [0, 1, 3])
def test_a_loop_is_late_by_both_ways(dbc, algorithm, extra, delay):
    """The command of step k was made d steps before, of a state of d steps before (jacobi: one step more)."""
    a, b = 0.98, 0.0099

    def move(values, time, step_size):
        values["x"] = a * values["x"] + b * values["u"]

    def command(values, time, step_size):
        values["u"] = -3.0 * values["x"]

    plant = MockUnit("plant", [real("u", "input"), real("x", "output")], move, x=2.0)
    controller = MockUnit(
        "controller", [real("x", "input"), real("u", "output", variability="discrete")], command
    )
    bus = {"dbc": dbc(), "delay": delay * 0.01, "resolution": "ideal"}
    x = [2.0]
    for k in range(STEPS):
        sampled = k - delay - extra  # the step in which the command was made
        u = -3.0 * x[max(sampled - delay, 0)] if sampled >= 0 else 0.0
        x.append(a * x[k] + b * u)
    assert control_loop([controller, plant], bus, algorithm) == pytest.approx(x, rel=1e-12)


def test_the_can_log_shows_when_it_was_sampled(tmp_path):
    logs = []
    for delay in (0, 3):
        path = tmp_path / f"{delay}.log"
        with Simulation(
            "scooter", bus=BusVariation(delay_steps=delay), stop_time=0.5, log_frames=True
        ) as sim:
            sim.run()
            sim.write_can_log(path)
        logs.append([line.split(")")[0] for line in path.read_text().splitlines()])
    assert logs[0] == logs[1]


# ---- resolution


@pytest.mark.parametrize("factor", [2, 4, 8, 2.5])
@pytest.mark.parametrize("rounding", ["nearest", "truncate"])
def test_a_coarser_signal_is_that_of_a_dbc_with_a_greater_scale(dbc, factor, rounding):
    coarse = received({"dbc": dbc(0.1), "resolution": factor, "rounding": rounding})
    assert np.array_equal(coarse, received({"dbc": dbc(0.1 * factor), "rounding": rounding}))
    assert not np.array_equal(coarse, received({"dbc": dbc(0.1), "rounding": rounding}))


@pytest.mark.parametrize("resolution", [8, "ideal"])
def test_a_state_keeps_its_values(dbc, resolution):
    expected = received({"dbc": dbc()}, what="state")
    assert np.array_equal(received({"dbc": dbc(), "resolution": resolution}, what="state"), expected)


def test_ideal_samples_holds_and_saturates_but_does_not_quantize(dbc):
    exact = [0.0] + [min(max(random.Random(k).uniform(-25, 25), -20.0), 20.0) for k in range(STEPS - 1)]
    held = np.array(exact)[np.arange(STEPS) // 3 * 3]
    assert np.array_equal(received({"dbc": dbc(cycle=30), "resolution": "ideal"}), held)


# ---- cycle


@pytest.mark.parametrize("cycle", [2, 5])
@pytest.mark.parametrize("start", [0, 20])
def test_a_longer_cycle_holds_longer(dbc, cycle, start):
    each, seldom = (received({"dbc": dbc(start=start), "cycle": c}) for c in (1, cycle))
    first = start // 10
    k = np.arange(first, STEPS)
    assert np.array_equal(seldom[first:], each[k - (k - first) % cycle])
    assert (seldom[:first] == 1.5).all()


def test_all_three_together(dbc):
    both = received({"dbc": dbc(), "delay": 0.02, "resolution": 4, "cycle": 3})
    coarse = received({"dbc": dbc(0.4), "cycle": 3})
    assert np.array_equal(both[2:], coarse[:-2])


# ---- the option


def test_a_run_with_the_option(tmp_path):
    plain, same = simulate("scooter", stop_time=3.0), simulate("scooter", stop_time=3.0, bus=BusVariation())
    assert np.array_equal(plain.data, same.data)
    late = simulate("scooter", stop_time=3.0, bus=BusVariation(delay_steps=1))
    assert late.manifest["buses"]["can0"]["delay"] == pytest.approx(0.01)
    assert not np.array_equal(plain.data, late.data)
    text = load_system("scooter").path.read_text().replace("[buses.can0]", "[buses.can0]\ndelay = 0.01")
    (tmp_path / "scooter.toml").write_text(text)
    assert np.array_equal(simulate(tmp_path / "scooter.toml", stop_time=3.0).data, late.data)


# ---- errors


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"delay": -0.01}, "buses.can0.delay: Input should be greater than or equal to 0, not -0.01"),
        ({"delay": float("inf")}, "buses.can0.delay: Input should be less than or equal to 3600, not inf"),
        (
            {"resolution": "coarse"},
            'buses.can0.resolution: a resolution is a factor from 1 to 1e9, or "ideal"',
        ),
        ({"resolution": 0.5}, "buses.can0.resolution: .*, not 0.5"),
        ({"cycle": 0}, "buses.can0.cycle: .*greater than or equal to 1, not 0"),
        ({"dely": 0.01}, r"buses.can0.dely: unknown key \(did you mean 'delay'\?\)"),
    ],
)
def test_wrong_keys(keys, text):
    content = {"name": "s", "units": {"a": {"fmu": "A"}}, "buses": {"can0": {"dbc": "x.dbc"} | keys}}
    with pytest.raises(ConfigError, match=f"^s.toml: {text}"):
        validate(content, SystemFile, "s.toml")


def test_a_delay_between_two_points(dbc):
    rule = r"mocks.toml: buses.can0.delay = 0.015 s is not a multiple of the communication step 0.01 s"
    with pytest.raises(ConfigError, match=rule):
        received({"dbc": dbc(), "delay": 0.015})


def test_nothing_to_vary():
    with pytest.raises(ConfigError, match="'ideal' leaves the buses out"):
        simulate("scooter", ideal=True, bus=BusVariation(cycle=2))
    file = SystemFile.model_validate({"name": "s", "units": {"a": {"fmu": "A"}}})
    with pytest.raises(ConfigError, match=r"^s.toml: .* the system has none"):
        varied(System(Path("s.toml"), file), BusVariation(), 0.01)
    with pytest.raises(ConfigError, match=r'scooter.toml: buses.can0.resolution = "ideal": .* no frames'):
        Simulation("scooter", bus=BusVariation(resolution="ideal"), log_frames=True)


def test_a_loss_without_frames_is_refused_as_one_of_the_variation() -> None:
    with pytest.raises(ConfigError, match=r"^bus variation: loss: .*make no frames"):
        simulate("scooter", "fig9", stop_time=1.0, bus=BusVariation(loss=0.1, resolution="ideal"))
