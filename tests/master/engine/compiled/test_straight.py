"""Straight-line code is made for long runs, kept, not trusted when it is damaged, and not kept for ever."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from evcosim.master.engine.compiled import cache, straight, straight_making
from evcosim.master.simulation import Simulation
from support.straight import is_straight

pytestmark = [
    pytest.mark.usefixtures("warm_units"),
    pytest.mark.skipif(not straight.POSSIBLE, reason="no code is flat on another system"),
]


@pytest.fixture
def entries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that has the entries of straight-line code alone."""
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o700)
    monkeypatch.setattr(straight, "_loaded", {})

    def kept(name: str) -> bytes | None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("EVCOSIM_CACHE", str(folder))
            return original[0](name)

    def keep(name: str, content: bytes, most: int) -> str:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("EVCOSIM_CACHE", str(folder))
            return original[1](name, content, most)

    original = straight.kept, straight.keep_some
    monkeypatch.setattr(straight, "kept", kept)
    monkeypatch.setattr(straight, "keep_some", keep)
    return folder


def run(steps: int = 5, again: int = 0, **options: object) -> tuple[bool, bool, bytes]:
    """Whether code was at hand at the start and at the end, and what a run of some steps recorded."""
    straight._loaded.clear()  # as in a new process
    with Simulation("scooter", "fig8", engine="compiled", isolation="none", **options) as simulation:
        at_start = is_straight(simulation._engine)
        for count in (steps, again):
            simulation.step(count)
        found = simulation._engine.recorded().whole().tobytes()
        return at_start, is_straight(simulation._engine), found


def test_a_long_run_makes_it_and_the_next_one_has_it(entries: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run()[:2] == (False, False)
    assert not list(entries.iterdir())
    with Simulation("scooter", "fig8", engine="compiled", isolation="none") as simulation:
        operations = len(simulation._engine._program.ops)
    monkeypatch.setattr(straight, "WORTH", 100 * operations)
    assert run(60)[:2] == (False, False)
    assert run(60, 39)[:2] == (False, False)
    short = run(60, 40)
    assert short[:2] == (False, True)
    assert run(60, 40) == (True, True, short[2])
    assert [path.suffix for path in entries.iterdir()] == [".bin"]
    assert run(2, profile=True)[:2] == (False, False)  # its parts are measured by the tables
    assert run(2, parameters={"vehicle.mass": 150.0})[0]
    assert not run(2, record=["vehicle.*"])[0]
    monkeypatch.setattr(straight, "MOST_OPERATIONS", operations - 1)
    assert not run(2)[0]


def test_damaged_code_and_that_of_another_processor_are_not_run(
    entries: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(straight, "WORTH", 0)
    assert run()[:2] == (False, True)
    (entry,) = entries.iterdir()
    whole = entry.read_bytes()
    for damaged in (whole[:-1], b"", bytes([*whole[:100], whole[100] ^ 1, *whole[101:]])):
        entry.write_bytes(damaged)
        assert run()[:2] == (False, True)
        assert "is damaged" in capsys.readouterr().err
        assert entry.read_bytes() == whole
    monkeypatch.setattr(cache, "_processor", lambda: b"another")
    cache_address = cache._made[cache.OPERATION.name].address
    assert cache_address
    assert run()[:2] == (False, True)
    assert len(list(entries.iterdir())) == 2


def test_the_oldest_entries_leave_the_cache(entries: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(straight, "WORTH", 0)
    monkeypatch.setattr(straight, "KEPT", 3)
    for i in range(4):
        (entries / f"straight-{i}.bin").write_bytes(b"")
        os.utime(entries / f"straight-{i}.bin", (i, i))
    (entries / "engine-1.bin").write_bytes(b"")
    run()
    names = sorted(path.name for path in entries.iterdir())
    assert len(names) == 4 and {"engine-1.bin", "straight-2.bin", "straight-3.bin"} < set(names)


def test_where_it_cannot_be_made_the_tables_are_followed(
    entries: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = run()[2]
    monkeypatch.setattr(straight, "WORTH", 0)
    asked = []
    monkeypatch.setattr(straight_making, "machine_code", lambda structure: asked.append(structure))
    assert run(3, 2) == (False, False, expected)
    assert len(asked) == 1
    monkeypatch.setattr(straight, "too_little_memory", lambda *of: "little memory")
    assert run() == (False, False, expected)
    assert len(asked) == 1
