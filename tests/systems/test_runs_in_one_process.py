"""What a process keeps from one run for the next changes no result, and hides no change of a file."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from evcosim import ConfigError, Results, simulate
from evcosim.cosim.system.system import system_names
from evcosim.cosim.system.toml import DATA
from evcosim.fmus.build import build_model
from evcosim.models.rider import Rider
from support.needs import need_c_compiler

DIGEST = """
import hashlib, sys
from evcosim import simulate
for units, name in [word.split(":") for word in sys.argv[1:]]:
    found = simulate(name, units=units, stop_time=2.0)
    print(hashlib.sha256(found.data.tobytes()).hexdigest())
"""


def digest(results: Results) -> str:
    return hashlib.sha256(results.data.tobytes()).hexdigest()


def test_a_later_run_is_that_of_a_fresh_process() -> None:
    need_c_compiler()
    runs = [(units, name) for units in ("python", "native") for name in system_names()]
    words = [f"{units}:{name}" for units, name in runs]
    call = [sys.executable, "-c", DIGEST]
    fresh = subprocess.run([*call, *words[::-1]], capture_output=True, text=True, check=True).stdout.split()
    for _ in range(2):
        later = [digest(simulate(name, units=units, stop_time=2.0)) for units, name in runs]
        assert later == fresh[::-1]


@pytest.fixture
def scooter(tmp_path: Path) -> Path:
    """The system with files of its own, which keep their sizes and times when they are changed."""
    (tmp_path / "can").mkdir()
    for name in ("systems/scooter.toml", "can/ev.dbc"):
        shutil.copy(DATA / name, tmp_path / name.removeprefix("systems/"))
    return tmp_path / "scooter.toml"


def change(path: Path, *pairs: tuple[str, str]) -> None:
    """Write a file with some text in the place of other text of the same length, with the times it has."""
    about, text = path.stat(), path.read_text()
    for old, new in pairs:
        assert len(old) == len(new) and old in text
        text = text.replace(old, new)
    path.write_text(text)
    os.utime(path, ns=(about.st_atime_ns, about.st_mtime_ns))


def changed_system(system: Path) -> None:
    change(system, ("step_size = 0.01 ", "step_size = 0.005"))


def changed_database(system: Path) -> None:
    change(system.parent / "can" / "ev.dbc", ("(0.4,0)", "(0.8,0)"))


@pytest.mark.parametrize("changed", [changed_system, changed_database])
def test_a_file_that_is_changed_under_its_name_is_seen(
    scooter: Path, changed: Callable[[Path], None]
) -> None:
    def run() -> Results:
        return simulate(scooter, DATA / "scenarios" / "scooter" / "fig8.toml", stop_time=2.0)

    first = digest(run())
    assert digest(run()) == first
    changed(scooter)
    assert digest(run()) != first


def test_an_fmu_that_is_changed_under_its_name_is_seen(tmp_path: Path) -> None:
    path = build_model(Rider, tmp_path, version="1")

    def told() -> str:
        manifest = simulate("scooter", "ece15", stop_time=1.0, fmus={"rider": path}).manifest
        return str(manifest["units"]["rider"]["sha256"])

    for version in ("1", "2", "3"):
        build_model(Rider, tmp_path, version=version)
        assert told() == told() == hashlib.sha256(path.read_bytes()).hexdigest()
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(ConfigError, match=r"Rider\.fmu"):
        told()


@pytest.mark.parametrize("units", ["python", "native"])
def test_threads_may_run_at_once(units: str) -> None:
    if units == "native":
        need_c_compiler()
    alone = {name: simulate(name, units=units, stop_time=1.0) for name in system_names()}
    found: list[tuple[str, Results]] = []

    def work(order: int) -> None:
        found.extend((name, simulate(name, units=units, stop_time=1.0)) for name in list(alone)[::order])

    threads = [threading.Thread(target=work, args=(order,)) for order in (1, -1, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 3 * len(alone)
    for name, results in found:
        assert np.array_equal(results.data, alone[name].data, equal_nan=True), name
