"""Frames that noise ends are error frames in the logs of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import can
import pytest

from evcosim import Simulation
from evcosim.cosim.can.logs.reading.logged import DATA, ERROR
from support.logged import frames_in
from support.small_bench import DATABASE, bench

BUS = "timing = 'frame', bit_error_rate = 2e-3, seed = 3"


def run(folder: Path, engine: Any) -> tuple[int, int]:
    """Write logs of a run with noise, and return the numbers of frames carried and ended by errors."""
    (folder / "bench.dbc").write_text(DATABASE)
    text = bench().replace('dbc = "bench.dbc"', f'dbc = "bench.dbc", {BUS}').replace("0.03", "1.0")
    (folder / "bench.toml").write_text(text)
    with Simulation(folder / "bench.toml", log_frames=True, engine=engine, stop_time=1.0) as simulation:
        simulation.run()
        for suffix in (".log", ".asc", ".blf", ".pcapng", ".mf4"):
            simulation.write_can_log(folder / f"noise{suffix}")
        found = simulation.manifest()["frames"]["can0"]["messages"]["EMD_Status"]
    return found["carried"], found["errors"]


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_each_frame_that_noise_ended_is_an_error_frame(tmp_path: Path, engine: Any) -> None:
    carried, errors = run(tmp_path, engine)
    assert errors > 5
    for suffix in (".log", ".asc", ".blf", ".pcapng"):
        kinds = [frame.kind for frame in frames_in(tmp_path / f"noise{suffix}")]
        assert (kinds.count(DATA), kinds.count(ERROR)) == (carried, errors), suffix
    assert [f.kind for f in frames_in(tmp_path / "noise.mf4")] == [DATA] * carried
    for suffix in (".log", ".asc", ".blf"):
        with can.LogReader(tmp_path / f"noise{suffix}") as reader:
            assert sum(frame.is_error_frame for frame in reader) == errors, suffix
    times = [frame.time for frame in frames_in(tmp_path / "noise.blf")]
    assert times == sorted(times) and len(set(times)) == len(times)


def test_both_engines_write_the_same_error_frames(tmp_path: Path) -> None:
    for engine in ("python", "compiled"):
        (tmp_path / engine).mkdir()
        run(tmp_path / engine, engine)
    ours, theirs = ((tmp_path / engine / "noise.blf").read_bytes() for engine in ("python", "compiled"))
    assert ours == theirs
