"""`evcosim bus`: the report, its files, and its JSON."""

from __future__ import annotations

import json


def test_bus_shows_load_latencies_and_bounds(evcosim, tmp_path):
    answer = evcosim("bus", "scooter", "--stop-time", "0.5", "-o", "out")
    assert (answer.code, answer.err) == (0, "")
    assert "can0 at 500000 bit/s: busy " in answer.out
    for name in ("VCU_Request", "EMD_Status", "BMS_Status", "VCU_State", "bound"):
        assert name in answer.out
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"bus.json", "can0.png", "can0.svg"}
    data = json.loads((tmp_path / "out" / "bus.json").read_text(encoding="utf-8"))
    assert data["buses"][0]["bus"] == "can0"
    again = evcosim("bus", "scooter", "--stop-time", "0.5", "-o", "out")
    assert "in out: bus.json" in again.out  # a study of the same settings is replaced


def test_a_system_without_a_bus_has_no_times(evcosim, tmp_path):
    (tmp_path / "s.toml").write_text('name = "s"\n[units.b]\nfmu = "Battery"\n', encoding="utf-8")
    answer = evcosim("bus", "s.toml")
    assert answer.code == 2 or answer.code == 1
    assert "the system has none" in answer.err
