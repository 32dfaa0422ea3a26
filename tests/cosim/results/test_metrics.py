import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results import results as results_module
from evcosim.cosim.results.metrics import Metric, Metrics, check, evaluate
from evcosim.cosim.results.results import Results, ResultVariable
from evcosim.cosim.system.metric_spec import MetricSpec

STATES = ((0, "driver"), (1, "acceleration"), (2, "velocity"))
VARIABLES = (
    ResultVariable("vehicle.speed", "m/s"),
    ResultVariable("ecu.speed_bound", "km/h", causality="input"),
    ResultVariable("battery.power", "W"),
    ResultVariable("ecu.state", type="Enumeration", variability="discrete", items=STATES),
    ResultVariable("battery.temperature", "degC"),
    ResultVariable("vendor.speed"),
)


def run(n: int = 1001) -> Results:
    """10 s at a constant acceleration of 2 m/s2 and 1 kW: 100 m, 20 m/s at the end."""
    t = np.linspace(0.0, 10.0, n)
    state = np.select([t < 2.0, t < 7.0], [0, 1], 2)
    columns = [2.0 * t, np.full(n, 36.0), np.full(n, 1000.0), state, 20.0 + t, t]
    return Results(t, np.column_stack(columns), VARIABLES)


def metric(results: Results | None = None, **spec):
    return evaluate(run() if results is None else results, [MetricSpec(name="it", **spec)])[0]


KNOWN = [
    ({"signal": "vehicle.speed", "unit": "km/h"}, 72.0),
    ({"signal": "vehicle.speed", "unit": "km/h", "reduce": "mean"}, 36.0),
    ({"signal": "vehicle.speed", "unit": "m", "reduce": "integral"}, 100.0),
    ({"signal": "vehicle.speed", "unit": "km", "reduce": "integral"}, 0.1),
    ({"signal": "vehicle.speed", "unit": "m/s", "reduce": "range"}, 20.0),
    ({"signal": "vehicle.speed", "unit": "m/s", "reduce": "rms"}, 20.0 / math.sqrt(3.0)),
    ({"signal": "vehicle.speed", "unit": "km/h", "minus": "ecu.speed_bound", "reduce": "max"}, 36.0),
    ({"signal": "ecu.speed_bound", "unit": "km/h", "minus": "vehicle.speed", "reduce": "min"}, -36.0),
    ({"signal": "ecu.speed_bound", "unit": "m", "minus": "vehicle.speed", "reduce": "integral"}, 0.0),
    (
        {
            "signal": "ecu.speed_bound",
            "unit": "m",
            "minus": "vehicle.speed",
            "reduce": "integral_above",
            "threshold": 0,
        },
        25,
    ),
    ({"signal": "battery.power", "unit": "Wh", "reduce": "integral"}, 1e4 / 3600.0),
    (
        {
            "signal": "vehicle.speed",
            "unit": "%",
            "reduce": "share_above",
            "threshold": 36,
            "threshold_unit": "km/h",
        },
        50.0,
    ),
    ({"signal": "vehicle.speed", "unit": "s", "reduce": "time_above", "threshold": 5}, 7.5),
    ({"signal": "ecu.state", "unit": "%", "reduce": "share_equal", "value": "acceleration"}, 50.0),
    ({"signal": "ecu.state", "unit": "s", "reduce": "time_equal", "value": "velocity"}, 3.0),
    ({"signal": "ecu.state", "unit": "s", "reduce": "time_equal", "value": 0}, 2.0),
    ({"signal": "ecu.state", "reduce": "changes"}, 2.0),
    ({"signal": "battery.temperature", "unit": "K", "reduce": "max"}, 303.15),
    ({"signal": "battery.temperature", "unit": "K", "reduce": "range"}, 10.0),
    ({"signal": "vendor.speed", "reduce": "max"}, 10.0),
    (
        {
            "signal": "battery.power",
            "reduce": "integral",
            "unit": "Wh/km",
            "per": {"signal": "vehicle.speed", "reduce": "integral"},
        },
        1e4 / 3600.0 / 0.1,
    ),
    ({"signal": "vehicle.speed", "unit": "%", "per": {"signal": "ecu.speed_bound"}}, 200.0),
]


@pytest.mark.parametrize(("spec", "value"), KNOWN)
def test_known_numbers_in_their_unit(spec: dict, value: float) -> None:
    assert metric(**spec).value == pytest.approx(value, rel=5e-3, abs=2e-2)
    assert metric(**spec).unit == spec.get("unit", "1")
    assert metric(**spec).reason == ""


def test_every_unit_of_a_quantity_says_the_same() -> None:
    values = {u: metric(signal="vehicle.speed", reduce="integral", unit=u).value for u in ("m", "km", "mm")}
    assert values["m"] == pytest.approx(1e3 * values["km"], rel=1e-14)
    assert values["mm"] == pytest.approx(1e3 * values["m"], rel=1e-14)


def test_a_signal_converts_exactly_as_the_units_do() -> None:
    assert metric(signal="vehicle.speed", unit="km/h").value == 3.6 * 20.0


samples = arrays.arrays(np.float64, st.integers(2, 20), elements=st.floats(-1e3, 1e3))


@given(samples)
def test_the_reductions_agree_with_each_other(values: np.ndarray) -> None:
    results = Results(np.arange(len(values)), values[:, None], [ResultVariable("a.x", "W")])

    def of(**spec) -> float:
        return metric(results, signal="a.x", **spec).value

    low, mean, high = (of(unit="W", reduce=r) for r in ("min", "mean", "max"))
    assert low - 1e-9 <= mean <= high + 1e-9
    assert of(unit="W", reduce="range") == high - low
    assert of(unit="W", reduce="rms") >= abs(mean) - 1e-9
    assert of(unit="J", reduce="integral") == pytest.approx(mean * (len(values) - 1), abs=1e-9)
    above = of(reduce="share_above", threshold=0.0)
    assert 0.0 <= above <= 1.0
    assert of(unit="s", reduce="time_above", threshold=0.0) == pytest.approx(above * (len(values) - 1))


@given(st.lists(st.integers(0, 2), min_size=2, max_size=30))
def test_the_times_in_all_states_make_up_the_run(states: list[int]) -> None:
    data = np.array(states, dtype=float)[:, None]
    results = Results(0.5 * np.arange(len(states)), data, [VARIABLES[3]])
    times = [
        metric(results, signal="ecu.state", unit="s", reduce="time_equal", value=name).value
        for _, name in STATES
    ]
    assert sum(times) == results.time[-1]


def test_held_signals_are_integrated_as_held() -> None:
    data = np.array([[1.0, 1.0], [3.0, 3.0]])
    variables = [ResultVariable("a.x", "W"), ResultVariable("a.u", "W", causality="input")]
    results = Results([0.0, 1.0], data, variables)
    assert metric(results, signal="a.x", unit="J", reduce="integral").value == 2.0
    assert metric(results, signal="a.u", unit="J", reduce="integral").value == 1.0


def test_a_number_that_cannot_be_had_says_why() -> None:
    standing = Results([0.0, 1.0], np.zeros((2, 6)), VARIABLES)
    per_distance = {
        "signal": "battery.power",
        "reduce": "integral",
        "unit": "Wh/km",
        "per": {"signal": "vehicle.speed", "reduce": "integral"},
    }
    assert metric(standing, **per_distance).text == "- (the integral of vehicle.speed is 0)"
    assert math.isnan(metric(standing, **per_distance).value)
    one = Results([0.0], np.ones((1, 6)), VARIABLES)
    assert (
        metric(one, signal="vehicle.speed", unit="m/s", reduce="mean").text == "- (the run has no duration)"
    )
    assert metric(one, signal="vehicle.speed", unit="m/s").value == 1.0
    none = Results([], np.ones((0, 6)), VARIABLES)
    assert metric(none, signal="vehicle.speed", unit="m/s").reason == "the run has no communication point"
    vendor = metric(signal="vendor.speed", unit="km/h")
    assert vendor.text == "- ('vendor.speed' declares no unit of measure)"
    broken = run()
    broken.data[3, 0] = math.nan
    assert (
        metric(broken, signal="vehicle.speed", unit="m/s").reason == "vehicle.speed is not finite at 0.03 s"
    )
    share = {"signal": "vehicle.speed", "unit": "%", "reduce": "share_above", "threshold": 0}
    assert metric(broken, **share).reason == "vehicle.speed is not finite at 0.03 s"


def test_text_is_for_people() -> None:
    assert metric(signal="vehicle.speed", unit="km/h").text == "72 km/h"
    assert metric(signal="ecu.state", reduce="changes").text == "2"


def test_a_unit_that_nobody_defines_passes_where_nothing_is_converted() -> None:
    results = Results([0.0, 1.0], [[1.0], [2.0]], [ResultVariable("a.x", "parsecond")])
    assert metric(results, signal="a.x", unit="parsecond", reduce="max").value == 2.0


WRONG = [
    (
        {"signal": "vehicle.sped"},
        r"no variable 'vehicle.sped' is recorded \(did you mean 'vehicle.speed'\?\)",
    ),
    ({"signal": "vehicle.speed", "minus": "x"}, "no variable 'x' is recorded"),
    ({"signal": "vehicle.speed", "unit": "N"}, r"\[m/s\] and \[N\] measure different quantities"),
    ({"signal": "vehicle.speed", "unit": "km", "reduce": "mean"}, r"\[m/s\] and \[km\] measure different"),
    (
        {"signal": "vehicle.speed", "unit": "m/s", "minus": "battery.power"},
        r"\[W\] and \[m/s\] measure different",
    ),
    (
        {"signal": "vehicle.speed", "reduce": "share_above", "threshold": 1, "threshold_unit": "N"},
        r"\[N\] and \[m/s\] measure different",
    ),
    (
        {"signal": "ecu.state", "reduce": "share_equal", "value": "velo_city"},
        r"no state 'velo_city' \(did you mean 'velocity'\?\); states: driver, acceleration, velocity",
    ),
    ({"signal": "battery.temperature", "unit": "K.s", "reduce": "integral"}, "its zero is arbitrary"),
    ({"signal": "battery.temperature", "unit": "K", "reduce": "rms"}, "their zeros differ"),
    (
        {"signal": "battery.power", "unit": "1", "per": {"signal": "battery.temperature"}},
        "a zero of theirs is",
    ),
    ({"signal": "battery.power", "unit": "W", "per": {"signal": "nowhere"}}, "no variable 'nowhere'"),
    ({"signal": "vehicle.speed", "unit": "furlong_per_nothing"}, "is not known"),
]


@pytest.mark.parametrize(("spec", "message"), WRONG)
def test_a_metric_that_cannot_come_out_is_refused_before_the_run(spec: dict, message: str) -> None:
    with pytest.raises(ConfigError, match=rf"^scooter.toml: metric 'it': .*{message}"):
        check([MetricSpec(name="it", **spec)], {v.name: v for v in VARIABLES}, "scooter.toml")


def test_a_text_has_no_metric() -> None:
    spec = MetricSpec(name="it", signal="ecu.mode")
    with pytest.raises(ConfigError, match=r"metric 'it': 'ecu.mode' is a String, which has no numbers"):
        check([spec], {"ecu.mode": ResultVariable("ecu.mode", type="String")}, "scooter.toml")


def test_a_name_stands_once() -> None:
    spec = MetricSpec(name="it", signal="ecu.state")
    with pytest.raises(ConfigError, match="metric 'it' is there twice"):
        check([spec, spec], {v.name: v for v in VARIABLES}, "scooter.toml")


def settling(x, **spec):
    """The settling time of a signal x [m/s], 1 s from point to point, into 0.5 m/s."""
    results = Results(
        np.arange(float(len(x))), np.array(x)[:, None], (ResultVariable("vehicle.speed", "m/s"),)
    )
    spec = {"reduce": "settling", "threshold": 0.5, "unit": "s"} | spec
    return metric(results, signal="vehicle.speed", **spec)


def test_settling_is_from_leaving_a_band_to_coming_back_for_good():
    assert settling([0.0, 0.0, 1.0, 0.2, -0.9, 0.1, 0.0]).value == 3.0
    assert settling([0.0, 0.5, -0.5]).value == 0.0
    assert settling([1.0, 1.0, 0.0], threshold=1.8, threshold_unit="km/h").value == 2.0
    unsettled = settling([0.0, 1.0, 1.0])
    assert math.isnan(unsettled.value)
    assert "at the end" in unsettled.reason


def test_after_reduces_the_rest_of_the_run():
    late = {"signal": "vehicle.speed", "unit": "m/s", "after": 4.0}  # 2 m/s2, 10 s
    assert metric(**late, reduce="range").value == pytest.approx(12.0)
    assert metric(**late, reduce="mean").value == pytest.approx(14.0)
    assert metric(**late, reduce="min").value == pytest.approx(8.0)
    assert metric(signal="ecu.state", reduce="changes", after=4.0).value == 1.0  # of two


@pytest.mark.parametrize(("after", "reason"), [(10.0, "no duration"), (10.5, "ends before 10.5 s")])
def test_after_the_end_there_is_no_value(after, reason):
    nothing = metric(signal="vehicle.speed", unit="m/s", reduce="mean", after=after)
    assert math.isnan(nothing.value)
    assert reason in nothing.reason


@pytest.mark.parametrize("rows", [1, 2, 7, 500])
def test_a_metric_does_not_depend_on_the_pieces_that_a_run_is_read_in(rows, monkeypatch):
    specs = [MetricSpec(name=f"{i}", **spec) for i, (spec, _) in enumerate(KNOWN)]
    late = {"reduce": "settling", "unit": "s", "threshold": 3.0, "after": 0.1}
    specs.append(MetricSpec(name="late", signal="vehicle.speed", minus="ecu.speed_bound", **late))
    speed = np.random.default_rng(3).normal(9.0, 2.0, 1001)
    noisy = run()
    noisy.data[:800, 0] = speed[:800]
    noisy.data[800:, 0] = 10.0
    assert all(math.isfinite(m.value) for m in evaluate(noisy, specs))
    for results in (run(), noisy):
        whole = evaluate(results, specs)
        with monkeypatch.context() as patch:
            patch.setattr(results_module, "PIECE", rows)
            pieces = evaluate(results, specs)
        assert [m.reason for m in pieces] == [m.reason for m in whole]
        values = [m.value for m in whole]
        assert [m.value for m in pieces] == pytest.approx(values, rel=1e-12, abs=1e-12, nan_ok=True)


def test_a_difference_of_temperatures_has_no_zero_to_convert() -> None:
    t = np.linspace(0.0, 10.0, 11)
    warming = Results(t, t[:, None], (ResultVariable("cell.warming", "K", difference=True),))
    for reduce, value in (("final", 10.0), ("rms", math.sqrt(33.5)), ("mean", 5.0)):
        spec = {"signal": "cell.warming", "unit": "degC", "reduce": reduce}
        assert metric(warming, **spec).value == pytest.approx(value, rel=1e-2)
    above = {"reduce": "time_above", "threshold": 5.0, "threshold_unit": "degC", "unit": "s"}
    assert metric(warming, signal="cell.warming", **above).value == pytest.approx(5.0, abs=1.0)


def test_a_unit_of_differences_gives_no_absolute_temperature() -> None:
    t = np.linspace(0.0, 10.0, 11)
    warming = Results(t, t[:, None], (ResultVariable("cell.warming", "delta_degC"),))
    absolute = Results(t, t[:, None], (ResultVariable("cell.warming", "degC"),))
    for unit in ("K", "degC", "delta_K"):
        assert metric(warming, signal="cell.warming", unit=unit).value == 10.0
        above = {"reduce": "time_above", "threshold": 5.5, "threshold_unit": unit, "unit": "s"}
        assert metric(warming, signal="cell.warming", **above).value == pytest.approx(4.5, abs=1.0)
    assert metric(warming, signal="cell.warming", unit="K.s", reduce="integral").value == 50.0
    assert metric(absolute, signal="cell.warming", unit="delta_K", reduce="range").value == 10.0
    with pytest.raises(ConfigError, match=r"\[degC\] is an absolute quantity and \[delta_K\] a difference"):
        metric(absolute, signal="cell.warming", unit="delta_K")


def test_a_level_has_no_integral() -> None:
    t = np.linspace(0.0, 10.0, 11)
    noise = Results(t, t[:, None], (ResultVariable("motor.noise", "dB"),))
    assert metric(noise, signal="motor.noise", unit="dB", reduce="max").value == 10.0
    with pytest.raises(ConfigError, match=r"\[dB\] is logarithmic: it has no integral"):
        metric(noise, signal="motor.noise", unit="s", reduce="integral")


def test_the_metrics_of_a_run_are_there_by_name_place_and_call():
    specs = [MetricSpec(name="top", signal="a.x", reduce="max"), MetricSpec(name="end", signal="a.x")]
    results = Results([0.0, 1.0], [[3.0], [2.0]], [ResultVariable("a.x", "1")], metrics=specs)
    assert [metric.name for metric in results.metrics] == ["top", "end"]
    assert results.metrics["end"].value == results.metrics[1].value == 2.0
    assert results.metrics() == results.metrics
    assert results.metrics[:1] == [results.metrics["top"]]
    assert results.metrics._repr_html_().count("<tr>") == 2
    with pytest.raises(ConfigError, match=r"no metric 'topp' \(did you mean 'top'\?\); there are: top, end"):
        results.metrics["topp"]
    none = Results([0.0], [[1.0]], [ResultVariable("a.x")]).metrics
    assert (none, none._repr_html_()) == ([], "<p>no metrics</p>")


def test_metrics_are_printed_as_lines() -> None:
    found = Metrics([Metric("distance", 12.5, "m", ""), Metric("n", 3.0, "1", "")])
    assert str(found).splitlines() == ["distance  12.5 m", "n         3"]
    assert str(Metrics()) == "no metrics"
