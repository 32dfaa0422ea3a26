"""Our FMUs in other importers: FMPy and a host in C; of all others the record of docs/fmus-elsewhere.md."""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from evcosim.fmus.build import names
from support.importers import importers, pages, systems, trials
from support.needs import need_c_compiler, need_linux

PAGE = pages.PAGE.read_text(encoding="utf-8")
NATIVE = Path(__file__).parents[2] / "fmus" / "native" / "c"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The host in C."""
    need_linux()
    need_c_compiler()
    made = tmp_path_factory.mktemp("host") / "c_host"
    source = importers.HOSTS.parent / "c_host.c"
    words = ["cc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-o", made, f"-I{NATIVE}", source, "-ldl"]
    subprocess.run(words, check=True)
    return made


@pytest.fixture(scope="module")
def host(program: Path) -> trials.Run:
    """Run a job in the host in C."""
    return importers.c_host(program)


def need_shared_python(kind: str) -> None:
    file = str(sysconfig.get_config_var("LDLIBRARY"))
    if kind == "python" and ".so" not in file:
        pytest.skip(f"this Python has no shared library that a host in C could load ({file})")


@pytest.mark.parametrize("kind", trials.KINDS)
@pytest.mark.parametrize("model", trials.DEEP)
def test_a_host_in_c_has_the_same_bits(host: trials.Run, model: str, kind: str) -> None:
    need_shared_python(kind)
    for what in ("two", "state"):
        job = trials.jobs(model, kind)[what]._replace(count=40)
        said = host(job)
        assert said.rows is not None, said.text
        assert trials.difference(job, said.rows) == 0.0, what


def test_a_host_in_c_runs_all_native_ones(host: trials.Run) -> None:
    jobs = [trials.first_steps(name, "native 2") for name in names()]
    jobs.append(trials.first_steps("LaneKeepingController", "native 3"))  # it has an input that is no Real
    for job in jobs:
        said = host(job)
        assert said.rows is not None, (job.model, said.text)
        assert trials.difference(job, said.rows) == 0.0, (job.model, job.kind)


@pytest.mark.parametrize("kind", trials.KINDS)
def test_a_host_in_c_hears_the_text_of_a_refusal(host: trials.Run, kind: str) -> None:
    need_shared_python(kind)
    said = host(trials.refused("Scooter", kind))
    status = 4 if kind == "python" else 3
    assert said.rows is None
    assert trials.DEEP["Scooter"].said in said.text
    assert f"ExitInitializationMode: status {status}\n" in said.text


def test_a_host_in_c_without_python_cannot_load_one_in_python(program: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(trials.fmu("Scooter", "python")) as archive:
        library = archive.extract("binaries/linux64/Scooter.so", tmp_path)
    words = [program, library, "2", "token", "", "0.01", "1", "0", "("]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 3
    assert re.fullmatch(r".*Scooter\.so: undefined symbol: _?Py\w+\n", done.stdout)
    assert "undefined symbol: _Py_NoneStruct" in PAGE


@pytest.mark.parametrize("kind", trials.KINDS)
def test_fmpy_has_the_same_bits_where_steps_are_exact(kind: str) -> None:
    run = importers.hosted(Path(sys.executable), importers.HOSTS / "by_fmpy.py")
    job = trials.jobs("BoundController", kind)["exact"]
    said = run(job)
    assert said.rows is not None, said.text
    assert trials.difference(job, said.rows) == 0.0


def test_fmpy_needs_the_factor_between_units(tmp_path: Path) -> None:
    units = systems.units(tmp_path)
    files = [systems.write(tmp_path / f"{name}.ssp", name, units) for name in ("factor", "gain")]
    speeds = [systems.speed(Path(sys.executable), "ssp_by_fmpy.py", file) for file in files]
    recorded = pages.recorded()["speeds"]["FMPy `simulate_ssp`"]
    assert speeds == pytest.approx([recorded["factor"], recorded["gain"]], rel=1e-9)
    assert speeds == pytest.approx([49.8, 30.2], abs=0.05)


def test_the_difference_of_a_trial_is_that_of_its_rows() -> None:
    job = trials.jobs("BoundController", "python")["run"]._replace(count=4)
    ((*rows, last),) = trials.reference(job)
    assert trials.difference(job, [[*rows, last]]) == 0.0
    assert trials.difference(job, [[*rows, last | {"throttle": 1.001 * last["throttle"]}]]) > trials.RIGHT
    assert trials.difference(job, [[*rows, last | {"throttle": float("nan")}]]) == float("inf")
    assert trials.difference(job, [rows]) == "[3] rows instead of 4 for each instance"


def test_the_tables_of_the_page_are_what_was_recorded() -> None:
    for name, text in pages.tables(pages.recorded()).items():
        assert f"<!-- {name} -->\n{text}\n<!-- end {name} -->" in PAGE, name


def summaries() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield each recorded trial."""
    for importer, found in pages.recorded()["importers"].items():
        for kind in trials.KINDS:
            for what in ("loaded", *trials.TRIALS):
                if what in found[kind]:
                    yield f"{importer}, {kind}, {what}", found[kind][what]


def test_what_was_recorded_differs_by_rounding_at_most() -> None:
    found = {where: one["largest"] for where, one in summaries() if one["models"]}
    assert len(found) > 100
    assert {where: value for where, value in found.items() if not value < 1e-11} == {}


def test_every_built_in_model_is_counted() -> None:
    for where, one in summaries():
        right, others = one["models"], [name for of_one in one["others"].values() for name in of_one]
        if where.endswith("loaded"):
            assert right + len(others) == len(names()), where
        assert set(others) <= set(names()), where


def test_every_importer_of_the_record_is_one_that_can_be_tried() -> None:
    in_c = {"a host in C", "fmusim", "fmuCheck"}
    known = {one.name for one in importers.IN_PYTHON} | in_c | {"FMPy's command line"}
    assert set(pages.recorded()["importers"]) == known


def where(kind: str, is_so: Callable[[dict[str, Any]], bool]) -> set[str]:
    """Return the importers of which something holds with a kind of FMU."""
    return {name for name, found in pages.recorded()["importers"].items() if is_so(found[kind])}


@pytest.mark.parametrize("kind", trials.KINDS)
def test_the_page_says_in_words_what_was_recorded(kind: str) -> None:
    none = {"native 3": {"libcosimpy", "fmuCheck", "sofirpy"}}.get(kind, {"fmuloader"})
    assert where(kind, lambda found: found["loaded"]["models"] == 0) == none
    rounded = {"fmusim", "fmuCheck"} - none
    assert where(kind, lambda found: (found.get("exact", {}).get("largest") or 0.0) > 0.0) == rounded
    assert where(kind, lambda found: "nothing" in found.get("refusal", ())) == {"ecospy"}
    assert where(kind, lambda found: bool(found.get("state", {}).get("others"))) == {"fmusim"}
    for what in ("run", "exact", "parameters", "two"):
        assert where(kind, lambda found: bool(found.get(what, {}).get("others"))) == set(), what  # noqa: B023
    assert f"All {len(names())} built-in models" in PAGE
