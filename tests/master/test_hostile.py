"""Whatever an FMU does, the run ends with a reason, keeps its rows, and leaves the master as it was."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.master.fmi.fmu import FmuError
from support import warm
from support.hostile import page, runs
from support.hostile.case import WHOLE, Case
from support.hostile.cases import CASES, GROUPS
from support.needs import need_linux

_BEFORE = 6  # rows up to the step that goes wrong


def good_rows() -> list[float]:
    """y of the good FMU at u = 1 at each communication point: y' = u - y by explicit Euler."""
    y = [0.0]
    for _ in range(WHOLE - 1):
        y.append(y[-1] + 0.01 * (1.0 - y[-1]))
    return y


@pytest.fixture(scope="module")
def engine_loaded(tmp_path_factory: pytest.TempPathFactory) -> None:
    """The machine code of the engine is loaded, as by the first run of a process: its files stay open."""
    need_linux()
    with pytest.MonkeyPatch.context() as forking:
        warm.context()
        forking.setattr(subprocess, "Popen", warm.popen)
        outcome = runs.run(tmp_path_factory.mktemp("good"), Case("good", "", "", WHOLE), 2)
    assert outcome.rows == WHOLE, outcome.said


@pytest.mark.usefixtures("engine_loaded", "warm_units")
@pytest.mark.parametrize(("case", "fmi"), [pytest.param(*key, id=f"{key[0].name}-{key[1]}") for key in CASES])
def test_the_master_survives(tmp_path: Path, case: Case, fmi: int) -> None:
    need_linux()
    outcome = runs.run(tmp_path, case, fmi)
    assert (outcome.rows, outcome.left) == (case.rows, ()), outcome.said
    assert case.says(outcome.said), outcome.said
    if case.rows is None:
        of_the_file = case in GROUPS["Archive"] or case in GROUPS["Library"]
        assert outcome.error is not None and issubclass(
            outcome.error, FmuError if of_the_file else ConfigError
        )
    elif case.rows < WHOLE or case.ending:
        assert outcome.error is not None and issubclass(outcome.error, RunError)
    else:
        assert outcome.error is None
    if outcome.results is not None and case.exact:
        kept = min(outcome.rows or 0, _BEFORE)
        assert np.array_equal(outcome.results["bad.y"][:kept], good_rows()[:kept])
        if "bad.n" in outcome.results:  # discrete, of another tool: row k has what the step to there made
            assert np.array_equal(outcome.results["bad.n"][:kept], range(kept))


def test_the_page_shows_these_cases() -> None:
    cases = [case for group in GROUPS.values() for case in group]
    assert page.read() == page.table(cases), "python -m support.hostile, started in tests/, writes the page"


def case_named(name: str) -> Case:
    return next(case for case, _ in CASES if case.name == name)


@pytest.mark.parametrize(
    ("name", "engine", "code", "rows", "said"),
    [
        ("segfault", "compiled", 1, 5, "unit 'bad': its process was killed by SIGSEGV"),
        ("exit0", "python", 1, 5, "ended by itself with exit code 0: the FMU called exit()"),
        ("hang", "python", 1, 5, "did not answer for 0.5 s (step_timeout) and was ended"),
        ("nan", "python", 1, 5, "bad.y = nan m/s: an output must be finite"),
        ("bomb", "python", 2, None, "bad.fmu: entry 'resources/zeros' unpacks to"),
        ("huge", "python", 0, WHOLE, "bad.y reached 1e+69 m/s"),
    ],
)
def test_the_installed_command_survives(
    tmp_path: Path, name: str, engine: str, code: int, rows: int | None, said: str
) -> None:
    need_linux()
    done = runs.run_command(tmp_path, case_named(name), 2, engine)
    assert done.returncode == code, done.stderr
    assert said in done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    table = tmp_path / "out" / "results.csv"
    assert (len(table.read_text().splitlines()) - 1 if table.exists() else None) == rows
