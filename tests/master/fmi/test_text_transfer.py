"""Texts: they connect, are driven, have starts, are recorded and read back; equal wherever they run."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.interface import VariableInfo
from evcosim.cosim.results.results import Results
from evcosim.cosim.texts import Texts
from evcosim.master.fmi.text_transfer import moving_texts
from evcosim.master.fmi.transfer import Item, Transfer
from evcosim.master.fmi.types import STRING, TYPES
from evcosim.master.simulation import Simulation, simulate
from support.c_fmu import mixed_fmu, typed_fmu

pytestmark = pytest.mark.usefixtures("warm_units")

GREEN = "Gr\N{LATIN SMALL LETTER U WITH DIAERESIS}n"
KIND = next(t for t in TYPES if t.kind is STRING)


def transfer(gets: bool, values: Any) -> Transfer:
    variables = (VariableInfo("a", "String", start="first"), VariableInfo("b", "String"))
    items = tuple(Item(i, i, 1.0, -0.0, v) for i, v in enumerate(variables))
    return Transfer("", None, None, values, KIND, gets, items)


def test_texts_are_set_where_one_has_changed() -> None:
    texts, told, calls = Texts(), {}, []
    memory = memoryview(bytearray(16)).cast("d")
    values = (ctypes.c_char_p * 2)()
    set_texts = moving_texts(transfer(False, values), lambda: calls.append(list(values)), memory, texts, told)
    memory[0] = texts.number("first")
    set_texts()
    assert calls == [] and told == {"a": "first", "b": ""}
    memory[1] = texts.number(GREEN)
    set_texts()
    set_texts()
    assert calls == [[b"first", GREEN.encode()]]


def test_texts_are_read_as_their_numbers() -> None:
    texts = Texts()
    memory = memoryview(bytearray(16)).cast("d")
    values = (ctypes.c_char_p * 2)(b"on", None)
    moving_texts(transfer(True, values), lambda: None, memory, texts, {})()
    assert [texts.text(number) for number in memory] == ["on", ""]


SYSTEM = """
name = "texts"
[experiment]
stop_time = 0.05
algorithm = "{algorithm}"
[units.a]
fmu = "typed.fmu"
[units.b]
fmu = "typed.fmu"
start = {{ text_in = "b begins" }}
[[connect]]
from = "a.text"
to = ["b.text_in"]
"""
SCENARIO = """
[[stimulus]]
to = "a.text_in"
csv = "in.csv"
"""
TABLE = 'time,u\n0,"cold, wet"\n0.02,"line\n# two ""quoted"""\n0.04,' + GREEN + "\n"
ENGINES = [("python", "none"), ("compiled", "none"), ("python", "process"), ("compiled", "process")]


def files(folder: Path, fmi: int = 2, algorithm: str = "gauss_seidel") -> tuple[Path, Path]:
    typed_fmu(folder / "typed.fmu", fmi)
    system, scenario = folder / "texts.toml", folder / "s.toml"
    system.write_text(SYSTEM.format(algorithm=algorithm))
    scenario.write_text(SCENARIO)
    (folder / "in.csv").write_text(TABLE, encoding="utf-8")
    return system, scenario


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_texts_are_the_same_from_every_engine_isolated_or_not(
    fmi: int, algorithm: str, tmp_path: Path
) -> None:
    paths = files(tmp_path, fmi, algorithm)
    runs = []
    for engine, isolation in ENGINES:
        options: dict[str, Any] = {"engine": engine, "isolation": isolation}
        results = simulate(*paths, **options)
        assert results.texts == ("a.text_in", "a.text", "b.text_in", "b.text")
        runs.append({name: results[name].tolist() for name in results.texts})
    assert runs[0] == runs[1] == runs[2] == runs[3]
    cold, two, green = "cold, wet", 'line\n# two "quoted"', GREEN
    assert runs[0]["a.text_in"] == [cold, cold, two, two, green, green]
    assert runs[0]["a.text"][1:] == runs[0]["a.text_in"][:-1]  # the unit shows after a step what it received


def test_texts_are_written_beside_the_numbers_and_read_back(tmp_path: Path) -> None:
    options: dict[str, Any] = {"isolation": "none"}
    results = simulate(*files(tmp_path), **options)
    results.write(tmp_path / "out")
    assert (tmp_path / "out" / "results.csv").read_text().startswith("time,a.flag_in,")
    assert (tmp_path / "out" / "results.texts.csv").read_text().startswith('"time","a.text_in",')
    for path in (tmp_path / "out", tmp_path / "out" / "results.csv", results.save(tmp_path / "alone.csv")):
        back = Results.read(path)
        assert back.texts == results.texts and back.names == results.names
        for name in results.texts:
            assert back[name].tolist() == results[name].tolist()
        assert "a.text" in back and "a.text" not in back.names
        with pytest.raises(ConfigError, match=r"a.text is a String, which has no numbers"):
            back.column("a.text")


EVENTS = """
[[event]]
time = 0.01
action = "override"
variable = "a.text_in"
value = "forced, here"
[[event]]
time = 0.02
action = "set"
variable = "b.text_in"
value = "set"
[[event]]
time = 0.03
action = "reset"
variable = "a.text_in"
"""


@pytest.mark.parametrize(("engine", "isolation"), ENGINES)
def test_events_act_on_texts(engine: Any, isolation: Any, tmp_path: Path) -> None:
    system, scenario = files(tmp_path)
    system.write_text(system.read_text().split("[[connect]]")[0])
    scenario.write_text(SCENARIO + EVENTS)
    results = simulate(system, scenario, engine=engine, isolation=isolation)
    cold, two, green = "cold, wet", 'line\n# two "quoted"', GREEN
    forced = "forced, here"
    assert results["a.text_in"].tolist() == [cold, forced, forced, two, green, green]
    assert results["b.text_in"].tolist() == ["b begins"] * 2 + ["set"] * 4
    assert results["a.text"][1:].tolist() == results["a.text_in"][:-1].tolist()


@pytest.mark.parametrize("fmi", [1, 2, 3])
@pytest.mark.parametrize("isolation", ["none", "process"])
def test_texts_are_parameters_and_starts(fmi: int, isolation: Any, tmp_path: Path) -> None:
    fmu = mixed_fmu(tmp_path / "mixed.fmu", fmi)
    options: dict[str, Any] = {"isolation": isolation, "stop_time": 0.1, "step_size": 0.05}
    results = simulate(fmu, parameters={"title": GREEN}, **options)
    assert set(results["fmu.shown"][1:]) == {GREEN}
    assert results.manifest["units"]["fmu"]["parameters"] == {"title": GREEN}
    assert set(simulate(fmu, **options)["fmu.shown"][1:]) == {"some text"}
    with pytest.raises(
        ConfigError, match=r"parameter fmu.title: title is a String, not 5: a text .* quotes$"
    ):
        simulate(fmu, parameters={"title": 5}, **options)
    typed = typed_fmu(tmp_path / "typed.fmu", fmi)
    for given in ({"parameters": {"text_in": "begun"}}, {"inputs": {"text_in": "begun"}}):
        assert set(simulate(typed, **given, **options)["fmu.text_in"]) == {"begun"}


def test_a_text_is_biased_by_nothing(tmp_path: Path) -> None:
    system, scenario = files(tmp_path)
    scenario.write_text(EVENTS.replace('"override"', '"bias"').replace('"forced, here"', "1.0"))
    with pytest.raises(ConfigError, match=r"event 1.action: a.text_in is a String, to which nothing can be"):
        simulate(system, scenario)


def test_a_text_is_set_and_read_in_a_run(tmp_path: Path) -> None:
    system, _ = files(tmp_path)
    options: dict[str, Any] = {"isolation": "none"}
    with Simulation(system, **options) as simulation:
        assert simulation.text("b.text_in") == "b begins"
        simulation.set("a.text_in", "one")
        simulation.step()
        assert simulation.text("a.text_in") == "one"
        assert simulation.results["a.text_in"].tolist() == ["one", "one"]
        simulation.override("a.text_in", "two")
        simulation.step()
        simulation.reset("a.text_in")
        simulation.step()
        assert simulation.results["a.text_in"].tolist() == ["one", "two", "one", "one"]
        with pytest.raises(ConfigError, match=r"a.text is a String: text\(\) returns it|a.text is a String"):
            simulation["a.text"]
        with pytest.raises(ConfigError, match=r"a.flag is of type Boolean"):
            simulation.text("a.flag")
        with pytest.raises(ConfigError, match=r"text_in is a String, not 1"):
            simulation.set("a.text_in", 1)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ('from = "a.text"\nto = ["b.flag_in"]', "a.text is of type String, b.flag_in of type Boolean"),
        ('from = "a.flag"\nto = ["b.text_in"]', "a.flag is of type Boolean, b.text_in of type String"),
        (
            'from = "a.text"\nto = ["b.text_in"]\nvia = "can0.EMD_Status.EMD_VehicleSpeed"',
            "a.text is a String, and the signal can0.EMD_Status.EMD_VehicleSpeed carries numbers; texts are",
        ),
    ],
)
def test_a_text_goes_to_a_text_and_over_no_bus(change: str, said: str, tmp_path: Path) -> None:
    system, scenario = files(tmp_path)
    text = system.read_text().replace('from = "a.text"\nto = ["b.text_in"]', change)
    system.write_text(text + '[buses.can0]\ndbc = "can/ev.dbc"\n')
    with pytest.raises(ConfigError, match=said):
        simulate(system, scenario)


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ("constant = 1", "constant: text_in is a String, not 1"),
        ("ramp = { slope = 1 }", "ramp: text_in is of type String, which takes a constant"),
        (
            'constant = "a"\nunit = "m"',
            r"stimulus 1.unit: a.text_in is a String, which has no unit of measure",
        ),
        ('constant = "a\\u0000b"', "constant: text_in = .*: no C text holds a NUL"),
    ],
)
def test_a_stimulus_of_a_text_is_texts(entry: str, said: str, tmp_path: Path) -> None:
    system, scenario = files(tmp_path)
    scenario.write_text(f'[[stimulus]]\nto = "a.text_in"\n{entry}\n')
    with pytest.raises(ConfigError, match=said):
        simulate(system, scenario)
