"""Identification of real FMUs, alone and over the bus, and its command."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.system.identification_spec import IdentificationSpec
from evcosim.master.studies.identification import each_working_point, identify

SHORT = {"sweep": (0.02, 0.6), "duration": 150.0}
ROLLING = {"initial_speed": 30.0 / 3.6}


def spec(**changes):
    known = {"input": "throttle", "output": "speed", "unit": "km/h", "amplitude": 2.0, "at_input": [28.2]}
    return IdentificationSpec(**(known | SHORT | changes))


def test_working_point_of_the_output_is_found():
    found = identify("Scooter", spec(at_input=[], at=[35.0]), parameters=ROLLING)
    assert found.working_point == pytest.approx(((35.0 - 17.03) / 0.46, 35.0), abs=0.5)


def test_units_of_measure_scale_the_gain():
    kmh, ms = (identify("Scooter", spec(unit=u), parameters=ROLLING) for u in ("km/h", None))
    assert kmh.fit.gain.value == pytest.approx(3.6 * ms.fit.gain.value, rel=1e-6)
    assert kmh.fit.pole.value == pytest.approx(ms.fit.pole.value, rel=1e-6)
    assert ms.gain_unit == "m/s per %"


def test_a_sweep_that_saturates_is_warned_of():
    slow = {"sweep": (0.008, 0.6), "duration": 260.0}
    clipped = identify("Scooter", spec(amplitude=45.0, **slow), parameters=ROLLING)
    assert any("something saturates" in w for w in clipped.warnings)
    limited = identify("Scooter", spec(amplitude=20.0, at_input=[68.0]), parameters={"initial_speed": 13.0})
    assert any("hits a limit" in w for w in limited.warnings)


def test_a_sweep_beyond_the_declared_range_is_refused():
    with pytest.raises(ConfigError, match=r"the sweep saturates fmu.brake_force: 10 N .* -90 to 110"):
        identify("Scooter", spec(input="brake_force", amplitude=100.0, at_input=[10.0]))


def test_outputs_that_do_not_rest_or_answer():
    with pytest.raises(RunError, match=r"distance does not come to rest .* integrates"):
        identify("Scooter", spec(output="distance", unit=None), parameters=ROLLING)
    with pytest.raises(RunError, match="does not answer to"):
        identify("Scooter", spec(input="road_grade", amplitude=0.001, at_input=[0.2]))  # it stands


def test_only_one_kind_of_working_point():
    with pytest.raises(ConfigError, match="not of both"):
        each_working_point(spec(at=[30.0]))
    assert [s.at_input for s in each_working_point(spec(at_input=[1.0, 2.0]))] == [[1.0], [2.0]]
    assert each_working_point(spec(at_input=[])) == [spec(at_input=[])]


MOVING = """
[parameters.ecu]
enabled = false
[parameters.vehicle]
initial_speed = 8.333333
[[stimulus]]
to = "ecu.throttle_request"
constant = 28.2
[[stimulus]]
to = "vehicle.road_grade"
unit = "deg"
sine = { mean = 0.0, amplitude = 2.0, period = 40.0 }
[[stimulus]]
to = "vehicle.brake_force"
constant = 0.0
[[event]]
time = 50.0
action = "bias"
variable = "ecu.speed_measured"
value = 10.0
"""


def test_what_else_a_scenario_moves_is_held_and_said(tmp_path):
    found = []
    for name, moving in (
        ("moving", MOVING),
        ("still", MOVING[: MOVING.index('[[stimulus]]\nto = "vehicle.r')]),
    ):
        path = tmp_path / f"{name}.toml"
        path.write_text(f'title = "{name}"\nleave_out = ["rider", "planner", "battery"]\n{moving}')
        task = spec(input="ecu.throttle_request", output="vehicle.speed", amplitude=10.0, at_input=[])
        found.append(identify("scooter", task, path))
    moving, still = found
    assert moving.fit == still.fit
    assert set(moving.warnings) - set(still.warnings) == {
        "held at 0 deg: the stimulus of vehicle.road_grade",
        "left out: the event 'bias' of ecu.speed_measured at 50 s",
    }


def test_a_fit_that_says_nothing_is_refused():
    """A sweep of 0.2 % of throttle drowns in a bus signal of whole km/h."""
    task = IdentificationSpec(
        input="ecu.throttle_request", output="ecu.speed_measured", amplitude=1.5, at_input=[29.0], **SHORT
    )
    with pytest.raises(RunError, match=r"no gain and no pole: (coherence|the 95 % interval)|does not answer"):
        identify("scooter", task)


@pytest.mark.parametrize(
    "changes", [{"repeats": 10**9}, {"duration": 1e9}, {"sweep": (1e-7, 0.6), "duration": 1e8}]
)
def test_a_sweep_without_end_is_named(changes):
    said = r"^sweep from .* steps of \S+ s with \d+ recorded variables are more than"
    with pytest.raises(ConfigError, match=said):
        identify("Scooter", spec(**changes))
