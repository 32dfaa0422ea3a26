"""The table of formats: a further one is a writer, a reader and a line."""

import json
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.formats.format import Contents, Format
from evcosim.cosim.results.formats.suffixes import CSV, FORMATS, format_of
from evcosim.cosim.results.recording import Recording
from evcosim.cosim.results.results import Results, ResultVariable

VARIABLES = [
    ResultVariable("vehicle.speed", "m/s", description="Speed"),
    ResultVariable("ecu.on", type="Boolean", variability="discrete"),
]


def write_toy(recording: Recording, file: BinaryIO) -> None:
    """A line of JSON for the head, and one for each row."""
    head = {"about": dict(recording.manifest), "variables": [[v.name, v.unit] for v in recording.variables]}
    file.write(f"{json.dumps(head)}\n".encode())
    for time, values in recording.pieces(recording.names, rows=2):
        for row in np.column_stack([time, values]).tolist():
            file.write(f"{json.dumps(row)}\n".encode())


def read_toy(path: Path) -> Contents:
    head, *rows = map(json.loads, path.read_text().splitlines())
    table = np.array(rows)
    return Contents(table[:, 0], table[:, 1:], [ResultVariable(*v) for v in head["variables"]], head["about"])


@pytest.fixture
def toy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(FORMATS, ".toy", Format(write_toy, read_toy))


@pytest.mark.usefixtures("toy")
def test_a_further_format_is_two_functions_and_a_line(tmp_path: Path) -> None:
    results = Results([0.0, 0.1, 0.2], [[1.0, 0.0], [1.5, 1.0], [0.1, 1.0]], VARIABLES, {"system": "scooter"})
    path = results.save(tmp_path / "made" / "run.TOY")
    assert path == tmp_path / "made" / "run.TOY"
    again = Results.read(path)
    assert again.time.tobytes() == results.time.tobytes()
    assert again.data.tobytes() == results.data.tobytes()
    assert again.units == results.units
    assert again.manifest == results.manifest
    assert [p.name for p in path.parent.iterdir()] == ["run.TOY"]


@pytest.mark.usefixtures("toy")
def test_the_suffix_chooses_the_format(tmp_path: Path) -> None:
    results = Results([0.0], [[1.0, 0.0]], VARIABLES)
    csv, toy = results.save(tmp_path / "a.csv"), results.save(tmp_path / "a.toy")
    assert csv.read_bytes() == results.to_csv(tmp_path / "b.txt").read_bytes() != toy.read_bytes()
    assert format_of(Path("A.CSV")) is CSV


@pytest.mark.usefixtures("toy")
@pytest.mark.parametrize("name", ["run.xyz", "run", "run.csv.gz", ".csv"])
def test_a_suffix_that_names_no_format_is_refused_before_anything_is_written(
    name: str, tmp_path: Path
) -> None:
    wrong = f"not as '{Path(name).suffix}'" if Path(name).suffix else f"and the name '{name}' has no suffix"
    with pytest.raises(ConfigError) as refusal:
        Results([0.0], [[1.0, 0.0]], VARIABLES).save(tmp_path / name)
    assert str(refusal.value) == f"{tmp_path / name}: results are written as .csv, .toy, {wrong}"
    assert list(tmp_path.iterdir()) == []


def test_every_format_reads_what_it_wrote(tmp_path: Path) -> None:
    results = Results([0.0, 0.1], [[1.0, 0.0], [1 / 3, 1.0]], VARIABLES)
    for suffix in FORMATS:
        again = Results.read(results.save(tmp_path / f"run{suffix}"))
        assert again.names == results.names
        assert again.time.tobytes() == results.time.tobytes()
        assert again.data.tobytes() == results.data.tobytes()
