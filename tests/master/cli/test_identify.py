"""`evcosim identify`: its files, JSON, wrong arguments and Ctrl-C."""

from __future__ import annotations

import json

import pytest

from support.small_disk import small_disk

FMU = ["identify", "Scooter", "--input", "throttle", "--output", "speed", "--unit", "km/h"]


def fmu(*more):
    """Return the arguments for an FMU alone, some of them others."""
    given = dict(zip(FMU[2::2], FMU[3::2], strict=True)) | dict(zip(more[::2], more[1::2], strict=True))
    return [*FMU[:2], *(text for pair in given.items() for text in pair)]


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


def test_a_full_disk_hides_no_number(evcosim, tmp_path):
    with small_disk(tmp_path / "disk", 5):
        answer = evcosim(*FMU, *QUICK, "--at-input", "28.2", "--band", "0.1,0.3", "-o", "disk/out")
    assert answer.code == 1
    assert "gain x pole" in answer.out
    assert "in disk/out" not in answer.out
    lines = answer.err.splitlines()
    assert lines[-2].startswith("evcosim: disk/out/")
    assert lines[-2].endswith(": cannot be written: No space left on device: make room on the disk")
    assert lines[-1] == "in disk/out: identification.json"


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
        (fmu("--amplitude", "2", "--input", "throtle"), ["throtle", "(did you mean 'throttle'?)"]),
        (fmu("--amplitude", "2", "--output", "sped"), ["sped", "(did you mean 'speed'?)"]),
        (fmu("--amplitude", "2", "--input", "speed"), ["input speed: it is of causality output"]),
        (fmu("--amplitude", "2", "--unit", "N"), ["[m/s] and [N] measure different quantities"]),
        ([*FMU, "--amplitude", "0"], ["Scooter: amplitude: Input should be greater than 0, not 0.0"]),
        (
            [*FMU, "--amplitude", "1e308"],
            ["Scooter: amplitude: Input should be less than"],
        ),
        (
            [*FMU, "--amplitude", "2", "--step-size", "0"],
            ["--step-size = 0.0: must be a number of seconds above 0"],
        ),
        (
            [*FMU, "--amplitude", "2", "--step-size", "nan"],
            ["--step-size = nan: must be a number of seconds above 0"],
        ),
        ([*FMU, "--amplitude", "nan"], ["Scooter: amplitude: Input should be a finite number, not nan"]),
        ([*FMU, "--amplitude", "2", "--repeats", "0"], ["Scooter: repeats: Input should be greater than or"]),
        ([*FMU, "--amplitude", "2", "--sweep", "0,1"], ["Scooter: sweep 1: Input should be greater than 0"]),
        ([*FMU, "--amplitude", "2", "--sweep", "0.6"], ["--sweep 0.6: it is written F0,F1"]),
        ([*FMU, "--amplitude", "2", "--sweep", "0.01,60"], ["sweep up to 60.0 Hz", "Nyquist"]),
        ([*FMU, "--amplitude", "2", "--band", "0.001,0.3"], ["band 0.001 to 0.3 Hz", "lie in the sweep"]),
        ([*FMU, "--amplitude", "2", "--duration", "10"], ["sweep of 10.0 s: 0.008 Hz needs 250 s"]),
        ([*FMU, "--amplitude", "2", "--at", "30", "--at-input", "28"], ["not of both"]),
        ([*FMU, "--amplitude", "2", "--ideal"], ["--ideal: Scooter is an FMU alone"]),
        ([*FMU, "--amplitude", "2", "--algorithm", "jacobi"], ["--algorithm: Scooter is an FMU alone"]),
        ([*FMU, "--amplitude", "2", "--set", "mas=1"], ["(did you mean 'mass'?)"]),
        (
            ["identify", "scooter", "--step-size", "nan"],
            ["--step-size = nan: must be a number of seconds above 0"],
        ),
        (
            ["identify", "scooter", "--step-size", "1e400"],
            ["--step-size = inf: must be a number of seconds above"],
        ),
        (
            ["identify", "scooter", "--step-size", "0"],
            ["--step-size = 0.0: must be a number of seconds above 0"],
        ),
        (
            ["identify", "scooter", "--step-size", "0.1"],
            ["--step-size = 0.1 s, where the files have 0.01 s: "],
        ),
        (["identify", "scooter", "--start", "ecu.x=1"], ["--start ecu.x=1: unit 'ecu' has no variable 'x'"]),
        ([*FMU, "--amplitude", "2", "--start", "mass=1"], ["--start mass=1: fmu.mass is a parameter"]),
        ([*FMU, "--amplitude", "2", "--delay", "0.1"], ["--delay: Scooter is an FMU alone"]),
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
