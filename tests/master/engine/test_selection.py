"""The choice of the engine, and what happens without numba or a cache."""

from __future__ import annotations

import importlib
import sys

import pytest

from evcosim.cosim import shortage
from evcosim.cosim.errors import ConfigError, ShortageError
from evcosim.master.engine.selection import engine_class
from evcosim.master.simulation import Simulation


def test_what_is_no_engine_is_refused():
    with pytest.raises(ConfigError, match=r"there is no engine 'compild' .did you mean 'compiled'"):
        engine_class("compild")


def test_without_numba_the_python_engine_runs_with_a_notice(monkeypatch):
    for name in [n for n in sys.modules if n.startswith("evcosim.master.engine.compiled.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delattr(importlib.import_module("evcosim.master.engine.compiled"), "engine", raising=False)
    monkeypatch.setitem(sys.modules, "numba", None)
    with Simulation("scooter", stop_time=1.0) as simulation:
        simulation.run()
        assert simulation.manifest()["experiment"]["engine"] == "python"
        assert any("the compiled engine needs numba" in warning for warning in simulation.warnings)


def test_a_numba_whose_libraries_find_no_memory_is_as_none(monkeypatch):
    class NoMemory:
        def find_spec(self, name, path=None, target=None):
            if name == "numba":
                raise OSError("Could not find/load shared object file")

    for name in [n for n in sys.modules if n.startswith("evcosim.master.engine.compiled.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delattr(importlib.import_module("evcosim.master.engine.compiled"), "engine", raising=False)
    monkeypatch.delitem(sys.modules, "numba", raising=False)
    monkeypatch.setattr(sys, "meta_path", [NoMemory(), *sys.meta_path])
    found, notice = engine_class()
    assert found.name == "python" and "Could not find/load shared object file" in notice


def test_too_little_memory_for_numba_is_as_none(monkeypatch):
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


def test_a_cache_that_cannot_be_written_is_told_and_the_run_goes_on(monkeypatch, tmp_path):
    from evcosim.master.engine.compiled import cache

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
