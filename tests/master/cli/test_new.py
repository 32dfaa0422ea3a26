"""`evcosim new`: what it prints can be typed, and its options are completed."""

from __future__ import annotations

import shlex


def test_what_it_says_to_type_next_runs(evcosim, tmp_path):
    answer = evcosim("new", "my_car")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.startswith("made my_car: README.md, can/bus.dbc, models/Controller.fmu")
    commands = [line.strip() for line in answer.out.partition("\nnext")[2].splitlines()]
    assert len(commands) == 3
    for command in commands:
        done = evcosim(*shlex.split(command)[1:], *(["--no-plot"] if "run" in command else []))
        assert (done.code, done.err) == (0, ""), command
    assert (tmp_path / "results" / "my_car-hill" / "results.csv").is_file()


def test_a_copy_of_a_system_and_a_second_one(evcosim, tmp_path):
    assert evcosim("new", "deep/mine", "--from", "lane_keeping").code == 0
    assert (tmp_path / "deep" / "mine" / "models" / "lateral_vehicle.py").is_file()
    again = evcosim("new", "deep/mine", "--from", "lane_keeping")
    assert (again.code, again.out) == (2, "")
    assert "deep/mine: is there already, and nothing is overwritten" in again.err


def test_wrong_use(evcosim, tmp_path):
    for arguments, said in (
        ([], "Missing argument 'NAME'"),
        (["a b"], "made of letters, digits and '_', as in a_b"),
        (["car", "--from", "braker"], "(did you mean 'braking'?)"),
    ):
        answer = evcosim("new", *arguments)
        assert (answer.code, answer.out) == (2, "") and said in answer.err, answer
    assert list(tmp_path.iterdir()) == []
