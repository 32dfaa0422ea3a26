"""The benchmarks: our runs are those of the reference, and what is printed says what was measured."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks import __main__ as ring
from benchmarks import bus, coldstart, memory, native, scaling, slaves, systems, worker
from benchmarks.asking import Figure, ask, measured
from benchmarks.case import Case, quantized, reference
from benchmarks.page import put
from benchmarks.runners import Measured
from support.needs import need_c_compiler

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("case", [
    Case("c", 3, 200, signals=5, channel=True), Case("c", 1, 200), Case("python", 2, 200, channel=True),
])  # fmt: skip # one table
def test_our_outputs_are_the_reference(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    need_c_compiler()
    monkeypatch.chdir(ROOT)
    figure = ask("evcosim", case)
    assert figure.reason == ""
    assert figure.microseconds is not None
    assert figure.microseconds > 0.0


def test_an_fmu_costs_little_beside_its_model_and_the_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three times measured in turn, the least of each: a busy machine is slow at all of them."""
    need_c_compiler()
    monkeypatch.chdir(ROOT)
    found = slaves.measured("Scooter", rounds=60, steps=50)
    assert 0.0 < found.floor < found.fmu
    assert 0.0 < found.model < found.fmu
    assert found.ratio < 1.5
    assert f"| Scooter | 11 | {1e6 * found.model:.2f} |" in slaves.report({"Scooter": found})


def test_a_native_step_replays_what_a_unit_receives(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its inputs change from step to step; its mathematics are a part of its time, and Python is slower."""
    need_c_compiler()
    monkeypatch.chdir(ROOT)
    ride = native.RIDES["Scooter"]._replace(scenario="fig8", steps=300)
    given = native.received("Scooter", ride)
    assert given.steps == 300
    assert len(set(given.inputs["throttle"])) > 10
    assert set(native.at_rest(given, "Scooter").inputs["throttle"]) == {0.0}
    costs = native.measured("Scooter", ride, rounds=3)
    assert 0.0 < costs.library < costs.motion < costs.python
    assert costs.calls == 1 / 300  # its arguments stay: the values are kept
    assert f"| Scooter | {1e6 * costs.rest:.3g} |" in native.report({"Scooter": costs})


LAZY = {
    "list": {"pydantic"},
    "info scooter": {"numpy", "pydantic"},
    "run scooter --no-plot --engine python": {"numpy", "pydantic"},
    "run scooter --engine python": {"numpy", "pydantic", "matplotlib"},
}


@pytest.fixture(scope="module")
def known() -> None:
    """The cache has what the descriptions of the system's FMUs say, as after any run of it."""
    with pytest.MonkeyPatch.context() as there:
        there.chdir(ROOT)
        coldstart.imported("info scooter")


@pytest.mark.parametrize("command", LAZY)
def test_a_command_imports_what_it_needs(command: str, known: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert coldstart.imported(command) == LAZY[command]


def test_the_compiled_engine_needs_no_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert {"matplotlib", "pint"} & coldstart.imported("run scooter --no-plot") == set()


def test_the_best_round_of_a_command_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    seconds = coldstart.measured(["--help"], rounds=2)
    assert 0.0 < seconds[""] < seconds["--help"]
    assert "| `evcosim --help` |" in coldstart.report(seconds, {"--help": set()})


@pytest.mark.skipif(not hasattr(os, "wait4"), reason="this system does not tell a process's peak memory")
def test_the_memory_of_a_run_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two runs the longer has more rows by as much as it is longer; a process is more than its rows."""
    monkeypatch.chdir(ROOT)
    options = ("--no-plot", "--engine", "python")
    short, long = (memory.peak(length, options) for length in (10.0, 60.0))
    assert long.rows - short.rows == pytest.approx(5000 / 1001 * short.rows, rel=1e-3)
    assert short.rows < short.csv < short.memory
    assert "| 1 min |" in memory.report([(short, short), (long, long)])


def test_a_result_that_is_not_the_reference_has_no_time() -> None:
    """The reference of the other order of units is off by a step."""
    case = Case("c", 2, 50)
    wrong = Measured(1.0, reference(case, "gauss_seidel"), "jacobi")
    assert "not timed" in worker._checked(case, wrong)["error"]
    right = Measured(1.0, reference(case, "jacobi"), "jacobi")
    assert worker._checked(case, right)["microseconds"] == 1e6 / 50


def test_the_reference_quantizes_as_the_bus_does() -> None:
    halves = np.array([0.5, 1.5, -0.5, -2.5, 40000.0]) / 1024.0
    assert (1024.0 * quantized(halves)).tolist() == [1.0, 2.0, -1.0, -3.0, 30720.0]


def test_a_peer_that_is_missing_is_a_line_that_says_so() -> None:
    case = Case("c", 2, 100)
    found = [Figure("evcosim", "0", case, 0.5), Figure("ecospy", "", case, reason="not installed (ecospy)")]
    text = ring.report([found])
    assert "| evcosim, compiled engine | 0.5 |" in text
    assert "- ecospy: not installed (ecospy)" in text


def test_a_master_in_an_environment_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    need_c_compiler()
    monkeypatch.chdir(ROOT)
    other = tmp_path / "python"
    other.write_text(f'#!/bin/sh\ntouch {tmp_path / "used"}\nexec {sys.executable} "$@"\n')
    other.chmod(0o755)
    case = Case("c", 1, 50)
    (there,) = measured(["evcosim"], case, 1, {"evcosim": str(other)})
    assert there.microseconds is not None
    assert (tmp_path / "used").exists()
    (nowhere,) = measured(["evcosim"], case, 1, {"evcosim": str(tmp_path / "none")})
    assert nowhere.reason == f"{tmp_path / 'none'} cannot be started: No such file or directory"


def test_what_a_master_leaves_in_the_temporary_folder_is_deleted(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(ROOT)
    messy = tmp_path / "python"
    messy.write_text(f'#!/bin/sh\necho "$TMPDIR" > {tmp_path / "where"}\ntouch "$TMPDIR/left"\n')
    messy.chmod(0o755)
    (found,) = measured(["evcosim"], Case("c", 1, 50), 1, {"evcosim": str(messy)})
    assert found.reason == "its process ended with code 0"
    assert not Path((tmp_path / "where").read_text().strip()).exists()


@pytest.mark.parametrize("wrong", ["cofmupi=python", "cofmupy", "cofmupy="])
def test_a_python_is_given_to_a_master(
    wrong: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", "--python", wrong])
    with pytest.raises(SystemExit, match="2"):
        ring.main()
    assert f"'{wrong}': MASTER=PATH, with one of the masters direct, evcosim" in capsys.readouterr().err


def test_a_ratio_is_to_this_project() -> None:
    case = Case("c", 2, 100)
    found = [Figure("evcosim", "0", case, 0.5), Figure("ecospy", "1", case, 2.0, one_core=True)]
    assert r"| ecospy 1 | 2\* (4 x) |" in ring.report([found])


def test_a_page_keeps_what_stands_round_the_place(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- x -->\nold\n<!-- end x -->\nb\n")
    put(page, "x", "new \\1")
    assert page.read_text() == "a\n<!-- x -->\nnew \\1\n<!-- end x -->\nb\n"
    with pytest.raises(ValueError, match="no place '<!-- y -->'"):
        put(page, "y", "")


@pytest.mark.parametrize("module", [ring, scaling, slaves, native, coldstart, memory, bus, systems])
def test_help_says_what_is_measured(
    module: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", "--help"])
    with pytest.raises(SystemExit, match="0"):
        module.main()
    assert "--write" in capsys.readouterr().out


def test_each_way_over_a_bus_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    need_c_compiler()
    monkeypatch.chdir(ROOT)
    best = {way: bus.measured(way, 2, 50) for way in bus.WAYS}
    assert min(best.values()) > 0.0
    assert bus.report(best).count("|") == 5 * (2 + len(bus.WAYS))


def test_a_system_is_measured_with_native_units(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is said of it is the system's: its step, and as many variables as it records."""
    need_c_compiler()
    monkeypatch.chdir(ROOT)
    cost = systems.measured(systems.RIDES["braking"]._replace(stop_time=0.5))
    assert (cost.recorded, cost.step) == (32, 0.01)
    assert cost.microseconds > 0.0
    assert "| a name | 32 | 2.5 | 4,000 |" in systems.report({"a name": cost._replace(microseconds=2.5)})
