"""Studies of units in C that refuse a step beyond the stop time that they were told."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.cosim.system.identification_spec import IdentificationSpec
from evcosim.cosim.system.metric_spec import MetricSpec
from evcosim.master.studies.bus_budget import measure
from evcosim.master.studies.identification import identify
from support.c_fmu import vehicle_fmu
from support.databases import WAY
from support.watch import watch_fmu

LINE = """name = "line"
[experiment]
stop_time = 0.29
[units.a]
fmu = "watch.fmu"
start = { u = 3.0 }
[units.b]
fmu = "watch.fmu"
period = 0.02
substeps = 3
[buses.can0]
dbc = "line.dbc"
[[connect]]
from = "a.y"
to = ["b.u"]
via = "can0.Way.Meters"
"""


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_identification_ends_when_it_is_done(tmp_path: Path, fmi: int) -> None:
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", fmi)
    sweep = {"input": "pedal", "output": "v", "amplitude": 0.02, "at_input": [0.6], "sweep": (0.05, 1.0)}
    spec = IdentificationSpec.model_validate(sweep | {"duration": 60.0})
    assert identify(str(fmu), spec, step_size=0.05).fit.gain.value > 0.0


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_the_runs_of_a_budget_end_at_the_stop_time(tmp_path: Path, fmi: int) -> None:
    watch_fmu(tmp_path / "watch.fmu", fmi)
    (tmp_path / "line.dbc").write_text(WAY)
    (tmp_path / "line.toml").write_text(LINE)
    system = tmp_path / "line.toml"
    spec = MetricSpec.model_validate({"name": "seen", "signal": "b.y"})
    for bus in (BusVariation(), BusVariation(delay_steps=3), BusVariation(cycle=4)):
        assert measure(system, None, spec, bus=bus).value == 3.0
