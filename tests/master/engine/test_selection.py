"""The choice of the engine, and what happens without numba or a cache."""

from __future__ import annotations

import importlib
import subprocess
import sys

import pytest

from evcosim.cosim import shortage
from evcosim.cosim.errors import ConfigError, ShortageError
from evcosim.master.engine.compiled import cache, compiling
from evcosim.master.engine.selection import compile_engine, engine_class
from evcosim.master.machine.hands import POSSIBLE
from evcosim.master.simulation import Simulation


def test_what_is_no_engine_is_refused():
    with pytest.raises(ConfigError, match=r"there is no engine 'compild' .did you mean 'compiled'"):
        engine_class("compild")


@pytest.fixture
def nothing_compiled(monkeypatch, tmp_path):
    """A process that has no machine code, and finds none in the cache."""
    monkeypatch.setattr(cache, "_made", {})
    monkeypatch.setattr(cache, "entry", lambda piece, kind="bin": f"none-{tmp_path.name}")
    monkeypatch.delitem(sys.modules, f"{cache.__package__}.compiling", raising=False)
    monkeypatch.delattr(importlib.import_module(cache.__package__), "compiling", raising=False)


def test_without_numba_the_python_engine_runs_with_a_notice(monkeypatch, nothing_compiled):
    monkeypatch.setitem(sys.modules, "numba", None)
    with Simulation("scooter", stop_time=1.0) as simulation:
        simulation.run()
        assert simulation.manifest()["experiment"]["engine"] == "python"
        assert any("the compiled engine needs numba" in warning for warning in simulation.warnings)


def test_a_numba_whose_libraries_find_no_memory_is_as_none(monkeypatch, nothing_compiled):
    class NoMemory:
        def find_spec(self, name, path=None, target=None):
            if name == "numba":
                raise OSError("Could not find/load shared object file")

    monkeypatch.delitem(sys.modules, "numba", raising=False)
    monkeypatch.setattr(sys, "meta_path", [NoMemory(), *sys.meta_path])
    found, notice = engine_class()
    assert found.name == "python" and "Could not find/load shared object file" in notice


def test_too_little_memory_for_numba_is_as_none(monkeypatch, nothing_compiled):
    monkeypatch.setattr(shortage, "memory_left", lambda: 300e6)
    monkeypatch.delitem(sys.modules, "numba", raising=False)
    found, notice = engine_class()
    assert found.name == "python"
    assert notice.startswith("the compiled engine needs 450 MB of memory, and 300 MB are left")
    with Simulation("scooter", stop_time=1.0) as simulation:
        assert notice in simulation.warnings
    monkeypatch.setattr(shortage, "memory_left", lambda: 100e6)
    monkeypatch.delitem(sys.modules, "scipy.linalg", raising=False)
    with pytest.raises(ShortageError, match=r"^a run needs 150 MB of memory, and 100 MB are left"):
        Simulation("scooter")


@pytest.mark.skipif(not POSSIBLE, reason="elsewhere numba loads what it keeps")
def test_kept_machine_code_needs_no_numba():
    """A run with a profile, one with frames on a bus, and an isolated unit: each has code of its own."""
    compile_engine()
    code = (
        "import sys; sys.modules['numba'] = sys.modules['llvmlite'] = None\n"
        "from evcosim.master.simulation import Simulation\n"
        "for given in ({'profile': True}, {'isolation': 'process'}, {}):\n"
        "    for system in ('scooter', 'lane_keeping'):\n"
        "        with Simulation(system, stop_time=0.5, engine='compiled', **given) as simulation:\n"
        "            simulation.run()\n"
        "            print(simulation.manifest()['experiment']['engine'], bool(simulation.plan.framed_bus))\n"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said.splitlines() == ["compiled True", "compiled True"] * 3


def test_a_cache_that_cannot_be_written_is_told_and_the_run_goes_on(monkeypatch, tmp_path):
    if POSSIBLE:  # compiling takes 20 s
        compile_engine()
        codes = {piece: cache._kept(piece) for piece in cache.PIECES}
        monkeypatch.setattr(compiling, "flat_code", codes.get)
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "file" / "below"))
    monkeypatch.setattr(cache, "_made", {})
    with Simulation("scooter", stop_time=1.0, engine="compiled") as simulation:
        simulation.run()
        assert any("the engine is compiled anew" in warning for warning in simulation.warnings)


def test_the_key_of_a_system_names_the_engine(ring):
    path = ring()
    path.write_text(path.read_text().replace("[experiment]", '[experiment]\nengine = "python"'))
    with Simulation(path, trust=True) as simulation:
        assert simulation.manifest()["experiment"]["engine"] == "python"


def test_the_option_names_the_engine(evcosim):
    answer = evcosim("run", "scooter", "--stop-time", "1", "--engine", "python", "--no-plot", "--json")
    assert answer.code == 0
