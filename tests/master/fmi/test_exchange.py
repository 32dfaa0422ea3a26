"""Model Exchange: the solver and its events, beside closed forms and the same equations in Co-Simulation."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.cosim.results.results import Results
from evcosim.master.cli import main
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.fmi.loading import load_unit
from evcosim.master.simulation import simulate
from support.equations import MODELS, equations_fmu

VERSIONS = (1, 2, 3)


def run(
    fmu: Path,
    more: str = "",
    scenario: str = "",
    stop: float = 3.0,
    step: float = 0.01,
    isolation: str = "none",
    record: str = '"*"',
) -> Results:
    """A system of this FMU alone."""
    path = fmu.with_suffix(".toml")
    path.write_text(
        f'name = "alone"\nrecord = [{record}]\n[experiment]\nstop_time = {stop}\nstep_size = {step}\n'
        f'[units.a]\nfmu = "{fmu.name}"\nisolation = "{isolation}"\n{more}\n'
    )
    if not scenario:
        return simulate(path, trust=True)
    path.with_name("driven.toml").write_text(scenario)
    return simulate(path, path.with_name("driven.toml"), trust=True)


# ---- events


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_bouncing_ball_is_its_closed_form(tmp_path: Path, fmi: int) -> None:
    """Bounce n is at t_n = t_1 (1 + 2 (e + ... + e^(n-1))), between two the height is a parabola."""
    results = run(equations_fmu(tmp_path / "ball.fmu", "ball", fmi), stop=2.0)
    g, e = 9.81, 0.7
    t1, v1 = math.sqrt(2.0 / g), math.sqrt(2.0 * g)
    bounces = np.array([t1 * (1.0 + 2.0 * sum(e**k for k in range(1, n))) for n in range(1, 30)])
    count = np.searchsorted(bounces, results.time)
    since = results.time - np.where(count > 0, bounces[count - 1], -t1)
    speed = np.where(count > 0, v1 * e**count, v1)
    height = speed * since - 0.5 * g * since**2
    assert count[-1] == 4
    np.testing.assert_allclose(results["a.x0"], height, atol=1e-6)
    # a discrete output of a stranger belongs to the time at which it has changed, as a continuous one does
    np.testing.assert_array_equal(results["a.count"], count)
    np.testing.assert_allclose(results["a.last"][-1], bounces[3], rtol=1e-7)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_ball_comes_to_rest(tmp_path: Path, fmi: int) -> None:
    results = run(equations_fmu(tmp_path / "ball.fmu", "ball", fmi))
    assert results["a.count"][-1] == 18  # v_1 0.7^18 is the first below 0.01 m/s
    assert np.all(results["a.x0"][-10:] == 0.0)
    assert np.min(results["a.x0"]) > -1e-9


@pytest.mark.parametrize("fmi", VERSIONS)
def test_time_events_are_met_exactly(tmp_path: Path, fmi: int) -> None:
    """Every 0.13 s, whatever the communication step; 1.3 s is an event and a communication point."""
    fmu = equations_fmu(tmp_path / "timer.fmu", "timer", fmi)
    for step in (0.01, 0.1, 0.65):
        results = run(fmu, stop=1.3, step=step)
        assert results["a.last"][-1] == pytest.approx(1.3, rel=1e-15)
        assert results["a.count"][-1] == 11
        expected = 0.13 * np.floor(results.time / 0.13 + 1e-9)
        np.testing.assert_allclose(results["a.last"], expected, atol=1e-12)


DISCRETE = """
[[stimulus]]
to = "a.level"
table = [[0.0, 1.0], [0.205, 4.0]]
interpolation = "hold"
[[stimulus]]
to = "a.demand"
table = [[0.0, 5.0], [0.4, 7.0]]
interpolation = "hold"
[[event]]
time = 0.3
action = "override"
variable = "a.armed"
value = 1
"""


@pytest.mark.parametrize("fmi", VERSIONS)
def test_discrete_inputs_act_in_an_event_at_their_communication_point(tmp_path: Path, fmi: int) -> None:
    """In FMI 2.0 and 3.0 the unit refuses them outside of event mode, and it uses them in events alone."""
    fmu = equations_fmu(tmp_path / "timer.fmu", "timer", fmi)
    results = run(fmu, "parameters = { p0 = 100.0 }", DISCRETE, stop=0.5)
    # the step from t_k sees the inputs of t_k, and its outputs belong to t_k+1
    k = np.arange(len(results.time) - 1)
    np.testing.assert_array_equal(results["a.held"][1:], np.where(k >= 21, 8.0, 2.0))
    np.testing.assert_array_equal(results["a.seen"][1:], np.where(k >= 40, 8.0, 6.0))
    np.testing.assert_array_equal(results["a.on"][1:], k < 30)


@pytest.mark.parametrize("kind", ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"])
def test_every_type_of_fmi_3_acts_in_events(tmp_path: Path, kind: str) -> None:
    types = {"demand": kind, "seen": kind, "level": "Float32", "held": "Float32"}
    other = equations_fmu(tmp_path / "other.fmu", "timer", 3, types=types)
    usual = equations_fmu(tmp_path / "usual.fmu", "timer", 3)
    found, wanted = (run(fmu, "parameters = { p0 = 100.0 }", DISCRETE, stop=0.5) for fmu in (other, usual))
    assert len(set(wanted["a.seen"])) == len(set(wanted["a.held"])) == 2
    for name in wanted.names:
        assert np.array_equal(found[name], wanted[name]), name


def test_a_continuous_input_in_single_precision_is_rounded_to_it(tmp_path: Path) -> None:
    single = equations_fmu(tmp_path / "single.fmu", "relay", 3, types={"u": "Float32"})
    double = equations_fmu(tmp_path / "double.fmu", "relay", 3)
    found = [
        run(fmu, scenario=f'[[stimulus]]\nto = "a.u"\nconstant = {value!r}\n', stop=1.0)["a.x0"]
        for fmu, value in [(single, 0.1), (double, float(np.float32(0.1))), (double, 0.1)]
    ]
    assert np.array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])


@pytest.mark.parametrize(
    ("variable", "reason"),
    [
        (
            '<Binary name="odd" valueReference="60" causality="output"/>',
            "is of type Binary, which is not supported",
        ),
        (
            '<Clock name="odd" valueReference="60" causality="output" intervalVariability="triggered"/>',
            "is of type Clock, which",
        ),
        (
            '<Float64 name="odd" valueReference="60" causality="output"><Dimension start="2"/></Float64>',
            "is an array, Float64[2]; arrays are not supported",
        ),
    ],
)
def test_what_cannot_be_exchanged_is_refused_by_name(tmp_path: Path, variable: str, reason: str) -> None:
    """But for those who ask for it such a variable does no harm."""
    fmu = equations_fmu(tmp_path / "decay.fmu", "decay", 3, more=variable)
    assert len(run(fmu, stop=0.1)) == 11
    with pytest.raises(ConfigError) as refusal:
        run(fmu, stop=0.1, record='"a.odd"')
    assert f"record: 'a.odd' {reason}" in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("p0", "is of causality parameter, not input"),
    ],
)
def test_what_is_not_recorded_is_refused_by_name(tmp_path: Path, name: str, reason: str) -> None:
    fmu = equations_fmu(tmp_path / "decay.fmu", "decay", 2)
    with pytest.raises(ConfigError, match=f"record: 'a.{name}' {reason}"):
        run(fmu, record=f'"a.{name}"')


SWITCHED = """
[[stimulus]]
to = "a.u"
table = [[0.0, 0.0], [0.5, 2.0], [2.0, 0.0]]
interpolation = "hold"
"""


@pytest.mark.parametrize("fmi", VERSIONS)
def test_an_input_that_jumps_over_an_indicator_is_a_state_event_there(tmp_path: Path, fmi: int) -> None:
    results = run(equations_fmu(tmp_path / "relay.fmu", "relay", fmi), scenario=SWITCHED)
    assert results["a.count"][-1] == 2
    assert results["a.last"][-1] == 2.0
    rising = (results.time >= 0.5) & (results.time <= 2.0)
    exact = 2.0 * (1.0 - np.exp(-(results.time[rising] - 0.5)))
    np.testing.assert_allclose(results["a.x0"][rising], exact, atol=1e-6)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_step_event_is_the_first_step_of_the_solver_that_asks_for_it(tmp_path: Path, fmi: int) -> None:
    """x0 = 2 (1 - exp(-(t - 0.5))) is behind 0.9 within a communication step of 0.25 s, before its end."""
    fmu = equations_fmu(tmp_path / "relay.fmu", "relay", fmi)
    results = run(fmu, scenario=SWITCHED, step=0.25)
    assert 0.9 < results["a.held"][-1] < 0.96
    row = int(np.flatnonzero(results["a.held"] > 0.0)[0])
    assert results["a.x0"][row - 1] < 0.9 < results["a.held"][-1] < results["a.x0"][row]


@pytest.mark.parametrize("fmi", VERSIONS)
def test_without_states_indicators_are_followed_over_time(tmp_path: Path, fmi: int) -> None:
    """sin(2 pi t/0.3) is 0 at multiples of 0.15 s; that at 0 is an event as it becomes positive."""
    for step in (0.01, 0.07):
        results = run(equations_fmu(tmp_path / "wave.fmu", "wave", fmi), stop=1.4, step=step)
        assert results["a.count"][-1] == 10
        assert results["a.last"][-1] == pytest.approx(1.35, abs=1e-9)


# ---- the solver


@pytest.mark.parametrize("model", MODELS)
def test_model_exchange_is_co_simulation_of_the_same_source(tmp_path: Path, model: str) -> None:
    """Co-Simulation sees an event up to 10 us late: a height is off by that times the ball's speed."""
    found = {
        (fmi, kind): run(
            equations_fmu(tmp_path / f"{model}{fmi}.fmu", model, fmi, "ME CS"), f'interface = "{kind}"'
        )
        for fmi in (2, 3)
        for kind in ("model_exchange", "co_simulation")
    }
    exchanged, simulated = found[2, "model_exchange"], found[2, "co_simulation"]
    assert exchanged.manifest["units"]["a"]["interface"] == "model_exchange"
    atol = 2e-3 if model == "ball" else 1e-6
    np.testing.assert_allclose(exchanged["a.y"], simulated["a.y"], atol=atol)
    assert exchanged["a.count"][-1] == simulated["a.count"][-1]
    for name in exchanged.names:  # and the versions of FMI are the same to the last bit
        for kind in ("model_exchange", "co_simulation"):
            assert np.array_equal(found[2, kind][name], found[3, kind][name]), (kind, name)
    first = run(equations_fmu(tmp_path / f"{model}1.fmu", model, 1))
    assert first.names == exchanged.names
    for name in first.names:
        assert np.array_equal(first[name], exchanged[name]), name


@pytest.mark.parametrize("fmi", [1, 2])
def test_a_stiff_oscillator(tmp_path: Path, fmi: int) -> None:
    """Van der Pol's with p0 = 1000: a jump within 1 ms, then 800 s on a slow manifold."""
    fmu = equations_fmu(tmp_path / "oscillator.fmu", "oscillator", fmi)
    results = run(fmu, "parameters = { p0 = 1000.0 }", stop=1000.0, step=10.0)
    reference = solve_ivp(
        lambda t, x: [x[1], 1000.0 * (1.0 - x[0] ** 2) * x[1] - x[0]],
        (0.0, 1000.0), [2.0, 0.0], method="Radau", rtol=1e-10, atol=1e-12, t_eval=results.time,
    )  # fmt: skip # as long as it is
    assert np.min(reference.y[0]) < -1.8
    np.testing.assert_allclose(results["a.x0"], reference.y[0], atol=1e-4)


def test_the_tolerance_is_that_of_the_system_else_of_the_fmu(tmp_path: Path) -> None:
    def error(more: str, declared: str) -> float:
        fmu = equations_fmu(tmp_path / "decay.fmu", "decay", 3, tolerance=declared)
        results = run(fmu, more)
        return float(np.max(np.abs(results["a.x0"] - np.exp(-results.time))))

    coarse, fine = error("", "1e-3"), error("", "1e-9")
    assert fine < 1e-7 < 1e-5 < coarse < 1e-2
    assert error("tolerance = 1e-9", "1e-3") == fine
    assert error("tolerance = 1e-3", "no number") == coarse
    assert error("", "2.0") == error("tolerance = 1e-6", "1e-3")  # 2 is none: the default


@pytest.mark.parametrize("fmi", [1, 2])
def test_a_large_nominal_value_allows_a_large_error(tmp_path: Path, fmi: int) -> None:
    fmu = equations_fmu(tmp_path / "decay.fmu", "decay", fmi)
    errors = []
    for nominal in (1.0, 1e6):
        results = run(fmu, f"parameters = {{ p1 = {nominal} }}")
        errors.append(np.max(np.abs(results["a.x0"] - np.exp(-results.time))))
    assert errors[0] < 1e-7
    assert 100.0 * errors[0] < errors[1] < 1e-1


@pytest.mark.parametrize("fmi", [1, 3])
@pytest.mark.parametrize("model", ["oscillator", "ball", "timer"])
def test_a_process_of_its_own_changes_no_bit(tmp_path: Path, model: str, fmi: int) -> None:
    fmu = equations_fmu(tmp_path / f"{model}.fmu", model, fmi, "ME" if fmi == 1 else "ME CS")
    options = 'interface = "model_exchange"\ntolerance = 1e-5'
    here, apart = (run(fmu, options, stop=1.0, isolation=kind) for kind in ("none", "process"))
    assert apart.manifest["units"]["a"]["isolation"] == "process"
    for name in here.names:
        assert np.array_equal(here[name], apart[name]), name


def test_substeps_bound_the_steps_of_the_solver(tmp_path: Path) -> None:
    fmu = equations_fmu(tmp_path / "decay.fmu", "decay", 2)
    coarse = run(fmu, "tolerance = 0.5", step=1.0)
    fine = run(fmu, "tolerance = 0.5\nsubsteps = 100", step=1.0)
    errors = [abs(r["a.x0"][-1] - math.exp(-3.0)) for r in (coarse, fine)]
    assert errors[1] < 0.1 * errors[0]


# ---- what goes wrong

TROUBLE = [
    (
        "decay",
        1,
        r"t = 0.5 s .step 50.: unit 'a': CVODE cannot go on: .*; there der[_(]x0\)? = nan, at t = 0.5",
    ),
    ("timer", 3, r"unit 'a': needs new discrete states without end \(1000 times\), at t = 0 s"),
    ("wave", 4, r"t = 0 s .step 0.: unit 'a': has more than 10000 events in one step, at t = 0 s"),
    ("decay", 5, r"t = 0.5 s .step 50.: unit 'a': CVODE cannot go on: the derivatives cannot be computed"),
    ("decay", 6, r"t = 0.49 s .step 49.: unit 'a': fmi[23]?Get\w*Derivatives returned Error \(3\)"),
    ("decay", 8, r"t = 0.69 s .step 69.: unit 'a': CVODE cannot go on: .* at t = 0.693147\d+ s"),
]


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize(("model", "behavior", "reason"), TROUBLE)
def test_what_ends_a_run_is_told(tmp_path: Path, model: str, behavior: int, reason: str, fmi: int) -> None:
    fmu = equations_fmu(tmp_path / "bad.fmu", model, fmi, behavior=behavior)
    with pytest.raises(RunError, match=reason):
        run(fmu)


def test_what_was_computed_before_is_kept(tmp_path: Path) -> None:
    fmu = equations_fmu(tmp_path / "bad.fmu", "decay", 3, behavior=1)
    with pytest.raises(RunError) as caught:
        run(fmu, isolation="process")
    assert len(caught.value.results) == 50


@pytest.mark.parametrize("fmi", VERSIONS)
def test_nominal_values_that_are_none_are_one(tmp_path: Path, fmi: int) -> None:
    results = run(equations_fmu(tmp_path / "bad.fmu", "decay", fmi, behavior=9))
    np.testing.assert_allclose(results["a.x0"], np.exp(-results.time), atol=1e-6)


def test_info_says_how_it_is_solved(tmp_path: Path, capsys) -> None:
    for fmi, kinds, count in ((3, "ME", 1), (3, "ME CS", 1), (3, "CS", 0), (1, "ME", 1)):
        assert main(["info", str(equations_fmu(tmp_path / "decay.fmu", "decay", fmi, kinds))]) == 0
        shown = capsys.readouterr().out
        assert shown.count("CVODE with events solves Model Exchange") == count, kinds
        assert ("asks for it" in shown) == (kinds == "ME CS")


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_value_set_after_the_initialization_is_an_event(tmp_path: Path, fmi: int) -> None:
    fmu = read_fmu(equations_fmu(tmp_path / "timer.fmu", "timer", fmi))
    unit = load_unit(fmu, "a", fmu.interface, tolerance=1e-4)
    try:
        unit.set("label", "first")
        unit.enter_initialization(0.0, None)
        unit.exit_initialization()
        assert [unit.get(name) for name in ("held", "shown")] == [0.0, "first"]
        unit.set("level", 3.0)
        unit.set("label", "second")
        assert [unit.get(name) for name in ("held", "shown")] == [6.0, "second"]
        unit.start_step(FmuSteps.equal(0.0, 0.5, 1))
        unit.finish_step()
        assert unit.get("last") == pytest.approx(0.39)
        unit.terminate()
    finally:
        unit.free()
