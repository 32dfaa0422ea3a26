"""Identification of real FMUs, alone and over the bus, and its command."""

from __future__ import annotations

import json

import pytest

from evcosim.cosim.errors import ConfigError, RunError
from evcosim.cosim.system.identification_spec import IdentificationSpec
from evcosim.master.reproduce import scooter_identification as scooter
from evcosim.master.studies.identification import each_working_point, identify
from evcosim.master.studies.identification_target import one_unit_system, spec_of

SHORT = {"sweep": (0.02, 0.6), "duration": 150.0}
ROLLING = {"initial_speed": 30.0 / 3.6}


def spec(**changes):
    known = {"input": "throttle", "output": "speed", "unit": "km/h", "amplitude": 2.0, "at_input": [28.2]}
    return IdentificationSpec(**(known | SHORT | changes))


@pytest.fixture(scope="module")
def measured():
    """The paper's experiment: over the bus, from the speed in whole km/h."""
    return scooter.at_working_point()


def test_scooter_over_the_bus_reaches_the_published_numbers(measured):
    fit = measured.fit
    assert measured.working_point == pytest.approx((28.2, 30.0), abs=0.01)
    assert fit.gain.value == pytest.approx(0.46, rel=0.05)
    assert fit.pole.value == pytest.approx(0.03, rel=0.05)
    assert fit.product.value == pytest.approx(0.46 * 0.03, rel=0.03)
    assert measured.prediction.mean_esr <= 3.18
    assert measured.gain_unit == "km/h per %"


def test_in_the_papers_band_only_the_product_is_well_conditioned(measured):
    assert not measured.fit.separable
    assert len(measured.warnings) == 1
    assert "only gain x pole is well conditioned" in measured.warnings[0]
    assert measured.fit.gain.relative > 3.0 * measured.fit.product.relative


def test_pole_gets_slower_with_speed_at_the_same_gain():
    found = [scooter.at_speed(v) for v in (25.0, 49.0)]  # all six: docs/systems/scooter.md
    assert [each.fit.gain.value for each in found] == pytest.approx([0.46, 0.46], rel=0.05)
    assert found[0].fit.pole.value == pytest.approx(0.0411, rel=0.03)
    assert found[1].fit.pole.value == pytest.approx(0.0206, rel=0.03)
    assert [each.working_point[1] for each in found] == pytest.approx([25.0, 49.0], abs=0.05)


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


def test_a_system_of_one_fmu_takes_its_step_from_it():
    assert one_unit_system("Scooter").file.experiment.step_size == 0.01
    assert one_unit_system("Scooter", 0.02).file.experiment.step_size == 0.02


def test_scenario_names_the_experiment():
    found = spec_of("scooter")
    assert found is not None
    assert (found.input, found.output, found.at) == ("ecu.throttle_request", "ecu.speed_measured", [30.0])
    assert spec_of("scooter", "fig8") is None
    assert spec_of("Scooter") is None


# ---- the command


FMU = ["identify", "Scooter", "--input", "throttle", "--output", "speed", "--unit", "km/h"]
QUICK = ["--amplitude", "2", "--sweep", "0.02,0.6", "--duration", "150", "--set", "initial_speed=8.3333"]


def test_command_writes_numbers_and_figures(evcosim, tmp_path):
    answer = evcosim(*FMU, *QUICK, "--at-input", "28.2", "--at-input", "40", "-o", "out")
    assert (answer.code, answer.err) == (0, "")
    assert "gain [km/h per %]" in answer.out
    names = {path.name for path in (tmp_path / "out").iterdir()}
    stems = ("bode-1", "bode-2", "prediction-1", "prediction-2", "working_points")
    assert names == {"identification.json", *(f"{s}.{k}" for s in stems for k in ("png", "svg"))}
    data = json.loads((tmp_path / "out" / "identification.json").read_text())
    assert [each["input"]["value"] for each in data] == [28.2, 40.0]
    assert data[0]["gain"]["unit"] == "km/h per %"
    assert data[0]["gain"]["low"] <= data[0]["gain"]["value"] <= data[0]["gain"]["high"]


def test_command_as_json(evcosim):
    answer = evcosim(*FMU, *QUICK, "--at-input", "28.2", "--band", "0.1,0.3", "--json", "--no-plot")
    assert answer.code == 0
    (found,) = answer.json
    assert found["band"] == [0.1, 0.3]
    assert not found["separable"]
    assert found["files"] == ["identification.json"]
    assert "only gain x pole is well conditioned" in answer.err


@pytest.mark.parametrize(
    ("arguments", "texts"),
    [
        (["identify", "scoter"], ["no system or FMU 'scoter' (did you mean 'scooter'?)"]),
        (["identify", "Scooter"], ["Scooter: --input is needed"]),
        (["identify", "scooter", "-s", "fig8"], ["scooter: --input is needed"]),
        (["identify", "no.fmu", "--input", "a", "--output", "b", "--amplitude", "1"], ["no such FMU file"]),
        ([*FMU, "--amplitude", "2", "--input", "throtle"], ["throtle", "(did you mean 'throttle'?)"]),
        ([*FMU, "--amplitude", "2", "--output", "sped"], ["sped", "(did you mean 'speed'?)"]),
        ([*FMU, "--amplitude", "2", "--input", "speed"], ["input speed: it is of causality output"]),
        ([*FMU, "--amplitude", "2", "--unit", "N"], ["[m/s] and [N] measure different quantities"]),
        ([*FMU, "--amplitude", "0"], ["all four are finite and above 0"]),
        ([*FMU, "--amplitude", "2", "--sweep", "0.6"], ["--sweep 0.6: it is written F0,F1"]),
        ([*FMU, "--amplitude", "2", "--sweep", "0.01,60"], ["sweep up to 60.0 Hz", "Nyquist"]),
        ([*FMU, "--amplitude", "2", "--band", "0.001,0.3"], ["band 0.001 to 0.3 Hz", "lie in the sweep"]),
        ([*FMU, "--amplitude", "2", "--duration", "10"], ["sweep of 10.0 s: 0.008 Hz needs 250 s"]),
        ([*FMU, "--amplitude", "2", "--at", "30", "--at-input", "28"], ["not of both"]),
        ([*FMU, "--amplitude", "2", "--ideal"], ["--ideal: Scooter is an FMU alone"]),
        ([*FMU, "--amplitude", "2", "--set", "mas=1"], ["(did you mean 'mass'?)"]),
        (["identify", "scooter", "--step-size", "0.1"], ["scooter is a system"]),
        (["identify", "scooter", "--output", "ecu.state"], ["output ecu.state: it is no Real"]),
    ],
)
def test_wrong_arguments(evcosim, arguments, texts):
    answer = evcosim(*arguments)
    assert answer.code == 2, answer
    assert answer.out == ""
    for text in texts:
        assert text in answer.err, answer.err


def test_interrupted_identification_ends_at_once(evcosim, monkeypatch):
    from evcosim.master.cli import interrupts

    def interrupted(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(interrupts.Interrupts, "check", interrupted)
    assert evcosim(*FMU, *QUICK, "--at-input", "28.2").code == 130
