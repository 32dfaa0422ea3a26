"""The manifest of a run names everything that made its results, and is JSON."""

from __future__ import annotations

import hashlib
import json
from importlib.metadata import version
from types import SimpleNamespace

import pytest

from evcosim import Simulation
from evcosim.cosim.system.system import load_system
from evcosim.master.builtin import fmu_file
from evcosim.master.manifest import saturations


@pytest.fixture(scope="module")
def manifest():
    with Simulation(
        "scooter", "fig9", stop_time=3.0, parameters={"vehicle.mass": 180.0}, engine="python"
    ) as sim:
        sim.step(200)
        return sim.manifest()


def test_it_is_json(manifest):
    assert json.loads(json.dumps(manifest, allow_nan=False)) == json.loads(json.dumps(manifest))


def test_versions_system_and_experiment(manifest):
    assert manifest["evcosim"] == version("evcosim")
    assert manifest["versions"]["numpy"] == version("numpy")
    assert (manifest["system"], manifest["scenario"], manifest["ideal"]) == ("scooter", "fig9", False)
    experiment = manifest["experiment"]
    assert (experiment["stop_time"], experiment["algorithm"], experiment["engine"]) == (
        3.0,
        "gauss_seidel",
        "python",
    )
    assert manifest["steps"] == 200
    assert manifest["loop_seconds"] > 0.0
    assert manifest["buses"]["can0"]["dbc"] == "can/ev.dbc"


def test_every_unit_with_its_file_and_digest(manifest):
    assert manifest["order"] == list(manifest["units"])
    assert {"planner", "ecu", "vehicle"} <= set(manifest["order"])
    assert "rider" not in manifest["order"]  # the scenario leaves it out
    vehicle = manifest["units"]["vehicle"]
    assert vehicle["sha256"] == hashlib.sha256(fmu_file("Scooter").read_bytes()).hexdigest()
    assert vehicle["file"] == fmu_file("Scooter").name
    assert vehicle["parameters"] == {"mass": 180.0}
    assert (vehicle["interface"], vehicle["isolation"]) == ("co_simulation", "none")
    assert {unit["period"] for unit in manifest["units"].values()} == {0.01}


def test_built_in_files_have_no_path_and_own_ones_have(manifest, tmp_path):
    assert manifest["files"] == {}
    path = tmp_path / "mine.toml"
    path.write_text(load_system("scooter").path.read_text())
    with Simulation(path) as sim:
        assert sim.manifest()["files"] == {"system": str(path.resolve())}


def test_signals_that_were_saturated_have_a_count_and_the_first_time():
    counts = {
        "Speed": SimpleNamespace(count=3, first_step=50),
        "State": SimpleNamespace(count=0, first_step=0),
    }
    plan = SimpleNamespace(bus="can0", message=SimpleNamespace(name="Status"))
    sender = SimpleNamespace(plan=plan, channel=SimpleNamespace(saturations=counts))
    engine = SimpleNamespace(senders=[sender], time_at=lambda k: 1.0 + 0.5 * k)
    assert saturations(engine) == {"can0.Status.Speed": {"count": 3, "first_time": 26.0}}


def test_connections_with_a_factor_and_no_others(manifest, tmp_path):
    assert manifest["connections"] == []
    path = tmp_path / "mine.toml"
    path.write_text(
        'name = "mine"\n[experiment]\nstop_time = 0.1\n[units.a]\nfmu = "Rider"\n[units.b]\nfmu = "Battery"\n'
        '[[connect]]\nfrom = "a.brake_force"\nto = ["b.power"]\nfactor = 2.5\n'
    )
    with Simulation(path) as simulation:
        assert simulation.manifest()["connections"] == [
            {"from": "a.brake_force", "to": ["b.power"], "factor": 2.5}
        ]
