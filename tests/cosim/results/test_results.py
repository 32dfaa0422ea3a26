import errno
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.results.formats import csv
from evcosim.cosim.results.results import Results, ResultVariable, to_nanoseconds

STATE = ResultVariable("ecu.state", type="Enumeration", items=((0, "driver"), (1, "acceleration")))
SPEED = ResultVariable("vehicle.speed", "m/s", description="Speed")
COUNT = ResultVariable("ecu.count", type="Integer", variability="discrete")
FLAG = ResultVariable("ecu.on", type="Boolean", variability="discrete")


def some(n: int = 5) -> Results:
    k = np.arange(n)
    data = np.column_stack([0.1 * k, k // 3, k, k % 2])
    return Results(k * 0.01, data, [SPEED, STATE, COUNT, FLAG], {"system": "scooter", "steps": n})


def same(a: Results, b: Results) -> None:
    assert a.time.tobytes() == b.time.tobytes()
    assert a.data.tobytes() == b.data.tobytes()
    assert a.variables == b.variables
    assert a.manifest == b.manifest


finite = st.floats(allow_nan=False, allow_infinity=False)


@settings(deadline=None)  # what a disk takes for a file is not ours
@given(data=arrays.arrays(np.float64, st.tuples(st.integers(0, 6), st.just(2)), elements=finite))
def test_what_is_written_reads_back_bit_for_bit(data: np.ndarray, tmp_path_factory) -> None:
    folder = tmp_path_factory.mktemp("run")
    time = np.arange(len(data)) * 0.01
    written = Results(time, data, [SPEED, ResultVariable("a.b[1,2]", "N")], {"steps": len(data)})
    written.write(folder)
    same(Results.read(folder), written)


def test_the_folder_and_its_csv_file_read_alike(tmp_path: Path) -> None:
    some().write(tmp_path)
    same(Results.read(tmp_path), some())
    same(Results.read(tmp_path / "results.csv"), some())


def test_more_rows_than_one_chunk(tmp_path: Path) -> None:
    long = some(10_000)
    long.write(tmp_path)
    same(Results.read(tmp_path), long)


@given(st.integers(0, 10**7), st.sampled_from([(1, 100), (1, 1000), (1, 10), (25, 10_000), (1, 100_000)]))
def test_times_are_the_doubles_nearest_to_their_decimals(k: int, step: tuple[int, int]) -> None:
    numerator, denominator = step
    assert to_nanoseconds(np.array([k * (numerator / denominator)]))[0] == k * numerator / denominator


@given(arrays.arrays(np.float64, 5))
def test_rounding_times_twice_is_rounding_once(time: np.ndarray) -> None:
    once = to_nanoseconds(time)
    assert to_nanoseconds(once).tobytes() == once.tobytes()


def test_a_step_that_is_no_decimal_keeps_its_bits() -> None:
    time = np.arange(1, 50) / 3
    third = time[np.arange(1, 50) % 3 != 0]
    assert to_nanoseconds(third).tobytes() == third.tobytes()


def test_columns_come_in_their_type() -> None:
    results = some()
    assert results["vehicle.speed"].dtype == np.float64
    assert results["ecu.state"].dtype == np.int64
    assert results["ecu.on"].tolist() == [False, True, False, True, False]
    assert np.shares_memory(results["vehicle.speed"], results.data)
    assert results["time"] is results.time
    assert len(results) == 5
    assert list(results) == list(results.names)
    assert "ecu.on" in results and "time" not in results
    assert results.units["vehicle.speed"] == "m/s"
    assert repr(results) == "<Results: 4 variables, 5 communication points, 0 to 0.04 s>"


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(ConfigError, match=r"no variable 'vehicle.sped' \(did you mean 'vehicle.speed'\?\)"):
        some()["vehicle.sped"]


def test_data_of_another_shape_or_doubled_names_are_refused() -> None:
    with pytest.raises(ValueError, match=r"data is \(2, 1\), 3 times and 1 variables need \(3, 1\)"):
        Results([0, 1, 2], [[0.0], [1.0]], [SPEED])
    with pytest.raises(ValueError, match="names"):
        Results([0], [[0.0, 1.0]], [SPEED, SPEED])


def test_two_writes_give_the_same_bytes(tmp_path: Path) -> None:
    for name in "ab":
        some(50).write(tmp_path / name)
    for file in ("results.csv", "run.json"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_a_full_disk_leaves_the_old_file_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = some(3).to_csv(tmp_path / "results.csv")
    before = path.read_bytes()

    def full(*_: object) -> None:
        assert len(os.listdir(tmp_path)) == 2  # the header is in a file of another name
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(csv, "_texts", full)
    with pytest.raises(ConfigError, match=r"results.csv: cannot be written: No space left on device"):
        some(9).to_csv(path)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["results.csv"]


def test_a_folder_that_is_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("")
    with pytest.raises(ConfigError, match=r"out/results.csv: cannot be written: File exists"):
        some().write(tmp_path / "out")


def test_a_file_whose_suffix_names_no_format_is_read_as_csv(tmp_path: Path) -> None:
    path = some().to_csv(tmp_path / "x.txt")
    assert Results.read(path).data.tobytes() == some().data.tobytes()


def test_results_without_a_row_read_back(tmp_path: Path) -> None:
    Results(np.empty(0), np.empty((0, 1)), [SPEED]).write(tmp_path)
    assert Results.read(tmp_path).data.shape == (0, 1)


def test_a_missing_file_and_broken_companions_are_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"results.csv: cannot be read: No such file"):
        Results.read(tmp_path)
    some().write(tmp_path)
    (tmp_path / "results.csv").write_bytes(b"time,\xff\n0,1\n")
    with pytest.raises(ConfigError, match="is not UTF-8 text"):
        Results.read(tmp_path)
    some().to_csv(tmp_path / "results.csv")
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(ConfigError, match=r"run.json: is not a JSON file"):
        Results.read(tmp_path)


def test_results_without_their_manifest_have_no_units(tmp_path: Path) -> None:
    some().write(tmp_path)
    (tmp_path / "run.json").unlink()
    bare = Results.read(tmp_path)
    assert bare.data.tobytes() == some().data.tobytes()
    assert set(bare.units.values()) == {""}
