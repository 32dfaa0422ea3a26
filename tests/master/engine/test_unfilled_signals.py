"""Signals that nothing fills in the log of a run: as values and as frames, classic and CAN FD."""

from __future__ import annotations

from pathlib import Path

import cantools
import pytest

from evcosim.master.simulation import Simulation
from support.small_bench import bench
from support.unfilled import DATABASE, EXPECTED


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("framed", [False, True])
@pytest.mark.parametrize("name", ["Short", "Long"])
def test_every_frame_has_their_values(tmp_path: Path, name: str, framed: bool, engine) -> None:
    (tmp_path / "bench.dbc").write_text(DATABASE)
    text = bench().replace("EMD_Status.EMD_VehicleSpeed", f"{name}.Fed")
    if framed:  # a timeout makes bytes of the values
        settings = (
            f'buses = {{ can0 = {{ dbc = "bench.dbc", messages = {{ {name} = {{ timeout = 3 }} }} }} }}'
        )
        text = text.replace('buses = { can0 = { dbc = "bench.dbc" } }', settings)
    (tmp_path / "s.toml").write_text(text)
    with Simulation(tmp_path / "s.toml", engine=engine, isolation="none", log_frames=True) as simulation:
        simulation.step(3)
        assert ("can0" in simulation.manifest()["frames"]) == framed
        simulation.write_can_log(tmp_path / "bus.log")
    codec = cantools.database.load_file(tmp_path / "bench.dbc", strict=False).get_message_by_name(name)
    lines = (tmp_path / "bus.log").read_text().splitlines()
    assert len(lines) == 3
    for line in lines:
        data = line.split("#")[-1]
        payload = bytes.fromhex(data[1:] if name == "Long" else data)  # CAN FD has a digit of flags
        found = codec.decode(payload, scaling=False, decode_choices=False)
        found.pop("Fed")
        assert found == {key: raw for key, (raw, _) in EXPECTED.items() if key in found}
        assert len(found) == (7 if name == "Long" else 5)
