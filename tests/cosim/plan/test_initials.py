"""Values of receivers before the first frame, as their messages give them."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.simulation import Simulation
from support.small_bench import SYSTEM, write

LATE = "start_delay = 0.02, "


def system(tmp_path: Path, keys: str, connection: str = "", bus: str = "") -> Path:
    """The small bench with these keys of the speed's message, of its connection and of the bus."""
    path = write(tmp_path)
    entry = f'dbc = "bench.dbc", {bus}messages = {{ EMD_Status = {{ {keys} }} }}'
    text = SYSTEM.replace('dbc = "bench.dbc"', entry)
    path.write_text(text.replace('EMD_VehicleSpeed"\n', f'EMD_VehicleSpeed"\n{connection}\n'))
    return path


def speeds(path: Path, steps: int = 3, scenario: Path | None = None, **options) -> list[float]:
    """What the controller has as its speed, in km/h, at each step."""
    options = {"engine": "compiled", "isolation": "none"} | options
    record = ["ecu.speed_measured"]
    with Simulation(path, scenario, record=record, **options) as simulation:
        simulation.step(steps)
        return simulation.results["ecu.speed_measured"].tolist()


@pytest.mark.parametrize("engine", ["python", "compiled"])
@pytest.mark.parametrize("keys", ["", "timeout = 9, "])
def test_receivers_have_it_until_the_first_frame(tmp_path: Path, engine: str, keys: str) -> None:
    path = system(tmp_path, f"{LATE}{keys}initial = {{ EMD_VehicleSpeed = 36.5 }}")
    assert speeds(path, engine=engine) == [36.5, 36.5, 0.0, 0.0]
    assert speeds(path, engine=engine, isolation="process") == [36.5, 36.5, 0.0, 0.0]


def test_the_value_is_in_the_signals_unit_and_converted(tmp_path: Path) -> None:
    meters = system(tmp_path, f"{LATE}initial = {{ EMD_VehicleSpeed = 10 }}")
    text = (tmp_path / "bench.dbc").read_text().replace('[0|254] "km/h"', '[0|254] "m/s"')
    (tmp_path / "bench.dbc").write_text(text)
    assert speeds(meters)[0] == pytest.approx(36.0, rel=1e-15)


def test_the_connections_own_counts_before_it(tmp_path: Path) -> None:
    path = system(tmp_path, f"{LATE}initial = {{ EMD_VehicleSpeed = 36.5 }}", "initial = 7.0")
    assert speeds(path) == [7.0, 7.0, 0.0, 0.0]


@pytest.mark.parametrize("engine", ["python", "compiled"])
def test_receivers_have_it_after_a_timeout(tmp_path: Path, engine: str) -> None:
    own = 'timeout = 2, on_timeout = "initial", initial = { EMD_VehicleSpeed = 36.5 }'
    (tmp_path / "lost.toml").write_text(
        '[[fault]]\naction = "lose"\ntime = 0.02\nmessage = "can0.EMD_Status"\n'
    )
    found = speeds(system(tmp_path, own), 8, tmp_path / "lost.toml", engine=engine)
    assert found[0] == 0.0  # the first frame is there at once
    assert found[-4:] == [36.5] * 4 and 36.5 not in found[:3]


@pytest.mark.parametrize(
    ("initial", "text"),
    [
        ("EMD_VehicleSped = 1.0", r"has no signal 'EMD_VehicleSped' \(did you mean 'EMD_VehicleSpeed'\?\)"),
        ("EMD_VehicleSpeed = 255", r"255 km/h is no value of the signal: \[0, 254\] km/h"),
        ("EMD_VehicleSpeed = -0.5", r"initial\.EMD_VehicleSpeed: -0\.5 km/h is no value"),
        ("EMD_VehicleSpeed = nan", "nan|finite"),
        ("EMD_VehicleSpeed = inf", "inf|finite"),
        ('EMD_VehicleSpeed = "fast"', "number"),
        ("EMD_VehicleSpeed = true", "number"),
    ],
)
@pytest.mark.parametrize("ideal", [False, True])
def test_wrong_values_are_refused(tmp_path: Path, initial: str, text: str, ideal: bool) -> None:
    path = system(tmp_path, f"initial = {{ {initial} }}")
    with pytest.raises(ConfigError, match=text) as caught:
        Simulation(path, ideal=ideal)
    assert "EMD_Status" in str(caught.value) and "s.toml" in str(caught.value)


def test_a_signal_that_nothing_receives_is_a_warning(tmp_path: Path) -> None:
    path = system(tmp_path, "initial = { EMD_Counter = 3.0, EMD_VehicleSpeed = 1.0 }")
    with Simulation(path, isolation="none") as simulation:
        said = [text for text in simulation.manifest()["warnings"] if "initial" in text]
    assert said == [
        f"{path}: buses.can0.messages.EMD_Status.initial.EMD_Counter: nothing receives this signal"
    ]
