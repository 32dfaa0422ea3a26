"""An FMU that evcosim did not build gets a process of its own, unless someone says otherwise."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import Isolation, UnitEntry
from evcosim.fmus.build import build_model
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi.fmu import read_fmu
from evcosim.master.isolation import decision
from evcosim.master.isolation.decision import chosen, process_limits
from evcosim.master.simulation import simulate
from evcosim.models.rider import Rider
from support.c_fmu import mixed_fmu
from support.pairs import pair

pytestmark = pytest.mark.usefixtures("warm_units")


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_what_we_did_not_build_is_isolated(tmp_path: Path, fmi: int) -> None:
    path = pair(tmp_path, 0, fmi)
    results = simulate(path)
    found = {name: unit["isolation"] for name, unit in results.manifest["units"].items()}
    assert found == {"rider": "none", "a": "process"}
    assert np.array_equal(results.data, simulate(path, isolation="none").data)


def test_no_processes_where_the_system_has_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = pair(tmp_path, 0)
    monkeypatch.setattr(decision, "available", lambda: False)
    with pytest.raises(ConfigError, match=r"unit 'a': evcosim did not build mixed.fmu, .*--isolation none"):
        simulate(path)
    assert simulate(path, isolation="none").manifest["units"]["a"]["isolation"] == "none"


def entry(**keys: object) -> UnitEntry:
    return UnitEntry.model_validate({"fmu": "any.fmu"} | keys)


@pytest.mark.parametrize("own", [None, "none", "process"])
@pytest.mark.parametrize("wanted", [None, "none", "process"])
def test_the_wish_for_all_units_is_before_that_of_one(
    tmp_path: Path, wanted: Isolation | None, own: Isolation | None
) -> None:
    ours, foreign = read_fmu(fmu_file("Rider")), read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2))
    settings = entry() if own is None else entry(isolation=own)
    assert chosen("a", ours, settings, wanted) == (wanted or own or "none")
    assert chosen("a", foreign, settings, wanted) == (wanted or own or "process")


def test_a_copy_of_a_built_in_fmu_is_ours_and_a_changed_one_is_not(tmp_path: Path) -> None:
    copy = tmp_path / "Rider.fmu"
    content = fmu_file("Rider").read_bytes()
    copy.write_bytes(content)
    assert chosen("a", read_fmu(copy), entry(), None) == "none"
    copy.write_bytes(content[:-2] + b"\1\0?")  # the archive has a comment
    assert chosen("a", read_fmu(copy), entry(), None) == "process"


def test_the_limits_are_those_of_the_entry() -> None:
    limits = process_limits(entry(memory_limit=1e9, file_limit=2e6, load_timeout=3.0, step_timeout=4.0))
    assert (limits.memory, limits.file, limits.loading, limits.step) == (1e9, 2e6, 3.0, 4.0)


def own_fmu(folder: Path) -> Path:
    """A file of a model of one's own: the built-in rider as `build_model` builds it."""
    return build_model(Rider, folder, version="of my own")


def test_an_fmu_that_was_built_here_is_ours_as_long_as_it_and_its_record_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    path = own_fmu(tmp_path)
    assert chosen("a", read_fmu(path), entry(), None) == "none"
    copy = tmp_path / "copy.fmu"
    copy.write_bytes(path.read_bytes())
    assert chosen("a", read_fmu(copy), entry(), None) == "none"
    copy.write_bytes(path.read_bytes()[:-2] + b"\1\0?")
    assert chosen("a", read_fmu(copy), entry(), None) == "process"
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "of somebody else"))
    assert chosen("a", read_fmu(path), entry(), None) == "process"


@pytest.mark.skipif(os.name == "nt", reason="Windows has no modes that say who can write")
def test_a_record_that_others_can_write_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    path = own_fmu(tmp_path)
    (record,) = (tmp_path / "cache").glob("built-here-*")
    os.chmod(record, 0o666)
    assert chosen("a", read_fmu(path), entry(), None) == "process"
    own_fmu(tmp_path)
    assert chosen("a", read_fmu(path), entry(), None) == "none"
    os.chmod(tmp_path / "cache", 0o777)
    assert chosen("a", read_fmu(path), entry(), None) == "process"


def test_an_own_fmu_runs_the_same_in_both_ways_and_the_run_says_which(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    path = own_fmu(tmp_path)
    here = simulate("scooter", "ece15", stop_time=5.0, fmus={"rider": path})
    apart = simulate("scooter", "ece15", stop_time=5.0, fmus={"rider": path}, isolation="process")
    assert here.manifest["units"]["rider"]["isolation"] == "none"
    assert apart.manifest["units"]["rider"]["isolation"] == "process"
    assert here.data.tobytes() == apart.data.tobytes()


def test_a_file_alone_lets_no_foreign_fmu_into_this_process(tmp_path: Path) -> None:
    path = pair(tmp_path, 0)
    text = path.read_text()
    path.write_text(text.replace("[units.a]", '[units.a]\nisolation = "none"'))
    with pytest.raises(ConfigError) as caught:
        simulate(path)
    said = str(caught.value)
    assert said.startswith(f'{path}: units.a.isolation = "none": {tmp_path / "mixed.fmu"} is not an FMU that')
    assert "--trust (trust=True)" in said
    trusted = simulate(path, trust=True)
    assert trusted.manifest["units"]["a"]["isolation"] == "none"
    for wanted in ("none", "process"):
        found = simulate(path, isolation=wanted)
        assert found.manifest["units"]["a"]["isolation"] == wanted
        assert np.array_equal(found.data, trusted.data)
    path.write_text(text)
    assert simulate(path, trust=True).manifest["units"]["a"]["isolation"] == "process"


def test_a_swap_file_alone_lets_no_foreign_fmu_into_this_process(tmp_path: Path) -> None:
    path = pair(tmp_path, 0)
    swap = tmp_path / "swap.toml"
    swap.write_text('fmu = "mixed.fmu"\nisolation = "none"\n')
    with pytest.raises(ConfigError, match=rf'^{swap}: isolation = "none": .*mixed.fmu is not an FMU that'):
        simulate(path, swaps={"a": swap})
    found = simulate(path, swaps={"a": swap}, trust=True)
    assert found.manifest["units"]["a"]["isolation"] == "none"


def test_a_file_may_say_none_for_our_own_fmus(tmp_path: Path) -> None:
    path = pair(tmp_path, 0)
    path.write_text(path.read_text().replace("[units.rider]", '[units.rider]\nisolation = "none"'))
    assert simulate(path).manifest["units"]["rider"]["isolation"] == "none"
