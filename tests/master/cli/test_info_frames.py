"""What `evcosim info` says of the frames of a system."""

from __future__ import annotations

import json

from support.small_bench import DATABASE, SYSTEM
from support.unfilled import DATABASE as UNFILLED
from support.unfilled import EXPECTED


def messages(evcosim, system) -> dict[str, dict]:
    """Return the entries of the messages of a system by name."""
    return {m["name"]: m for m in evcosim("info", system, "--json").json["messages"]}


def test_protection_status_and_what_nothing_fills(evcosim) -> None:
    found = messages(evcosim, "lane_keeping")
    assert found["CAM_LaneStatus"]["protection"] == {
        "profile": "1A",
        "function": None,
        "checksum": "CAM_LaneStatusCrc",
        "counter": "CAM_LaneStatusCounter",
        "timeout": None,
        "on_timeout": "hold",
        "status": ["controller.camera_status"],
    }
    assert found["IMU_Motion"]["protection"] is None
    assert [s["name"] for s in found["IMU_Motion"]["unfilled"]] == ["IMU_LatAccel", "IMU_LongAccel"]
    assert [s["name"] for s in found["VCU_SteerRequest"]["unfilled"]] == ["VCU_SteerReqValid"]
    printed = evcosim("info", "lane_keeping").out
    for text in ("Protection and timeouts", "E2E 1A", "controller.camera_status", "Signals that nothing"):
        assert text in printed


def test_a_timeout_and_a_makers_checksum(evcosim, tmp_path) -> None:
    (tmp_path / "bench.dbc").write_text(DATABASE)
    (tmp_path / "maker.py").write_text("def crc(payload, identifier, counter):\n    return 1\n")
    own = 'checksum = "maker:crc", checksum_signal = "EMD_Crc", timeout = 3, on_timeout = "sna"'
    bus = f'dbc = "bench.dbc", messages = {{ EMD_Status = {{ {own} }} }}'
    (tmp_path / "s.toml").write_text(SYSTEM.replace('dbc = "bench.dbc"', bus))
    (message,) = messages(evcosim, tmp_path / "s.toml").values()
    guard = message["protection"]
    assert (guard["profile"], guard["function"], guard["checksum"]) == (None, "maker:crc", "EMD_Crc")
    assert (guard["counter"], guard["timeout"], guard["on_timeout"]) == (None, 3, "sna")
    assert [signal["name"] for signal in message["unfilled"]] == ["EMD_Counter"]
    printed = evcosim("info", tmp_path / "s.toml").out
    assert "maker:crc" in printed and "3 cycles, then sna" in printed


def test_raw_values_of_each_kind_are_listed_and_none_without_frames(evcosim, tmp_path) -> None:
    (tmp_path / "bench.dbc").write_text(UNFILLED)
    text = SYSTEM.replace("EMD_Status.EMD_VehicleSpeed", "Long.Fed")
    (tmp_path / "s.toml").write_text(text)
    listed = messages(evcosim, tmp_path / "s.toml")["Long"]["unfilled"]
    assert {s["name"]: (s["raw"], s["sent"]) for s in listed} == EXPECTED
    ideal = text.replace('dbc = "bench.dbc"', 'dbc = "bench.dbc", resolution = "ideal"')
    (tmp_path / "s.toml").write_text(ideal)
    assert json.dumps(messages(evcosim, tmp_path / "s.toml")["Long"]["unfilled"]) == "[]"
