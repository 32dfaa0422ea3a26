import errno
import os
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from evcosim.cosim.clock import Clock
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.figures.draw import draw
from evcosim.cosim.results.formats import csv
from evcosim.cosim.results.results import PIECE, Results, ResultVariable
from evcosim.cosim.results.text_table import TextTable
from evcosim.cosim.row_store import Grid, RowStore
from evcosim.cosim.system.figure_spec import FigureSpec
from evcosim.cosim.system.metric_spec import MetricSpec

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


def test_times_of_an_array_keep_their_bits(tmp_path: Path) -> None:
    time = 0.01 * np.arange(100)
    results = Results(time, np.zeros((100, 1)), [ResultVariable("a.x")])
    assert np.array_equal(results.time, time)
    assert np.array_equal(Results.read(results.save(tmp_path / "a.csv")).time, time)


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
    with pytest.raises(
        ConfigError, match=r"out/results.csv: cannot be written: .*out is a file, not a folder$"
    ):
        some().write(tmp_path / "out")


def test_a_file_whose_suffix_names_no_format_is_read_as_csv(tmp_path: Path) -> None:
    path = some().to_csv(tmp_path / "x.txt")
    assert Results.read(path).data.tobytes() == some().data.tobytes()


def test_results_without_a_row_read_back(tmp_path: Path) -> None:
    Results(np.empty(0), np.empty((0, 1)), [SPEED]).write(tmp_path)
    assert Results.read(tmp_path).data.shape == (0, 1)


def test_a_missing_file_and_broken_companions_are_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"results.csv: cannot be read: No such file"):
        Results.read(tmp_path / "results.csv")
    with pytest.raises(ConfigError, match=r": is a folder without results of a run \(results\.csv\)$"):
        Results.read(tmp_path)
    some().write(tmp_path)
    (tmp_path / "results.csv").write_bytes(b"time,\x81\n0,1\n")
    with pytest.raises(ConfigError, match="is not UTF-8 or Windows-1252 text"):
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


# ---- of a long run: rows in a file, times on a grid

WIDTH = 3
VARIABLES = [
    ResultVariable("a.x"),
    ResultVariable("a.n", type="Integer"),
    ResultVariable("a.b", type="Boolean"),
]
LINE = FigureSpec.model_validate({"panels": [{"label": "x", "signals": ["a.x"]}]})
SPECS = [
    MetricSpec(name=how, signal="a.n", unit="1", reduce=how) for how in ("final", "max", "range", "changes")
]


def test_results_read_the_same_from_a_file(tmp_path: Path) -> None:
    rows = np.round(np.random.default_rng(1).normal(size=(5000, WIDTH)))
    rows[:, 2] = rows[:, 0] > 0.0
    store = RowStore(WIDTH, memory=0)
    store.append(rows)
    time = 0.01 * np.arange(len(rows))
    kept, stored = Results(time, rows, VARIABLES), Results(time, store.table(), VARIABLES)
    assert stored.to_csv(tmp_path / "a.csv").read_bytes() == kept.to_csv(tmp_path / "b.csv").read_bytes()
    assert stored.final() == kept.final() == {name: kept[name][-1].item() for name in kept.names}
    assert [type(x) for x in stored.final().values()] == [float, int, bool]
    part, same = stored.part(time > 10.0, ["a.b", "a.x"]), kept.part(time > 10.0, ["a.b", "a.x"])
    assert part.names == ("a.b", "a.x")
    assert np.array_equal(part.data, same.data)
    assert np.array_equal(part.time, kept.time[time > 10.0])
    for rows in (slice(None), slice(-7, None), slice(4000, 9000), slice(7, 5), slice(None, None, 3)):
        part = stored.part(rows, ["a.b", "a.x"])
        assert np.array_equal(part.data, kept.data[rows][:, [2, 0]])
        assert np.array_equal(part.time, kept.time[rows])


def test_texts_stay_in_a_part_and_are_among_the_last_values(tmp_path: Path) -> None:
    table = TextTable([ResultVariable("a.s", type="String")], [(0, ("on",)), (3, ("off",))])
    results = Results(0.1 * np.arange(5), np.zeros((5, WIDTH)), VARIABLES, texts=table)
    assert results.final() == {"a.x": 0.0, "a.n": 0, "a.b": False, "a.s": "off"}
    part = results.part(slice(2, None), ["a.s", "a.b"])
    assert (part.names, part.texts) == (("a.b",), ("a.s",))
    assert part["a.s"].tolist() == ["on", "off", "off"]
    assert results.part(slice(None), results.names).texts == ()
    only = results.part(results.time > 0.25, ["a.s"])
    assert only.save(tmp_path / "only.csv").read_text() == "time\n0.30000000000000004\n0.4\n"
    assert Results.read(tmp_path / "only.csv")["a.s"].tolist() == ["off", "off"]
    assert Results([], np.empty((0, 0)), [], texts=TextTable(table.variables)).final() == {}


def test_times_on_a_grid_are_those_of_an_array() -> None:
    grid = Grid(Clock.counted(-1.0, 0.01, 70_000), 70_001)
    rows = np.zeros((len(grid), WIDTH))
    kept, made = Results((np.arange(len(rows)) - 100) / 100, rows, VARIABLES), Results(grid, rows, VARIABLES)
    assert made.span == kept.span == (-1.0, 699.0)
    assert np.array_equal(made.times(69_990, 70_500), kept.time[69_990:])
    assert np.array_equal(made.time, kept.time)
    assert np.array_equal(made.times(3, 5), kept.times(3, 5))
    assert len(Results(Grid(Clock.counted(0.0, 0.1, 0), 0), np.zeros((0, WIDTH)), VARIABLES).time) == 0


def reached(count: int, use: Callable[[Results], object]) -> int:
    """The most bytes [B] that a use of so many rows in a file takes."""
    store = RowStore(WIDTH, memory=0)
    for start in range(0, count, 10_000):
        block = np.sin(np.arange(start, start + 10_000.0))[:, None] * [3.0, 0.0, 0.0]
        store.append(block)
    results = Results(Grid(Clock.counted(0.0, 0.01, count), count), store.table(), VARIABLES, metrics=SPECS)
    tracemalloc.start()
    use(results)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


@pytest.mark.parametrize(
    "use", [lambda r: r.metrics, lambda r: draw(r, LINE), lambda r: r.part(slice(7), ["a.x"])]
)
def test_what_reads_a_long_run_holds_a_piece_of_it(use: Callable[[Results], object]) -> None:
    """Twice the rows take no more memory: not even a column of those that came to them."""
    count = 3 * PIECE // 10_000 * 10_000
    use(Results([0.0], np.zeros((1, WIDTH)), VARIABLES, metrics=SPECS))  # what is loaded once for all
    assert reached(2 * count, use) - reached(count, use) < 0.2 * 8 * count


def test_writing_a_long_run_holds_a_piece_of_it(tmp_path: Path) -> None:
    peaks = [reached(count, lambda r: r.to_csv(tmp_path / "a.csv")) for count in (20_000, 60_000)]
    assert peaks[1] - peaks[0] < 0.2 * 8 * 40_000


@pytest.mark.parametrize(
    ("time", "said"),
    [
        ([1.0, 0.0], r"^time\[1\] = .*0\.0.* comes after .*1\.0.*: time must not decrease$"),
        ([0.0, np.nan], r"^time\[1\] = nan: times are finite$"),
        ([-np.inf, 0.0], r"^time\[0\] = -inf: times are finite$"),
        ([[0.0, 1.0]], r"^time has 2 dimensions"),
    ],
)
def test_times_that_are_none_are_refused(time: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Results(time, [[1.0], [2.0]], [ResultVariable("a.x")])


def test_a_time_may_come_twice() -> None:
    assert len(Results([0.0, 1.0, 1.0], [[1.0], [2.0], [3.0]], [ResultVariable("a.x")])) == 3


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_no_reader_takes_is_not_saved(value: float, tmp_path: Path) -> None:
    results = Results([0.0, 0.5], [[1.0, 2.0], [3.0, value]], [ResultVariable("a.x"), ResultVariable("a.y")])
    for write in (results.save, results.to_csv):
        with pytest.raises(ConfigError, match=rf"^a\.y is {value} at t = 0\.5 s: a file of results"):
            write(tmp_path / "x.csv")
    assert list(tmp_path.iterdir()) == []
    kept = results.part(slice(None), ["a.x"])
    assert Results.read(kept.save(tmp_path / "x.csv")).data.tolist() == [[1.0], [3.0]]


@pytest.mark.parametrize("line_end", [b"\n", b"\r\n"])
def test_a_file_that_was_cut_off_is_refused_wherever(line_end: bytes, tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    whole = b"time,a.x" + line_end + b"0.0,1.25" + line_end + b"0.5,2.75" + line_end
    for end in range(whole.index(b"1.25"), len(whole)):
        path.write_bytes(whole[:end])
        if whole[:end].endswith((b"\r", b"\n")):
            assert len(Results.read(path)) in (1, 2)
            continue
        with pytest.raises(ConfigError, match=r"x\.csv: line [23], the last, does not end: '0"):
            Results.read(path)


@pytest.mark.parametrize(
    "header", ["time,x", "t,a.x", "Time [s],a.x", '"time","a.x"', "time, a.x", "# made by b\ntime,a.x"]
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-8-sig"])
def test_another_tools_file_need_not_end_its_last_line(header: str, encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    whole = f"{header}\n0.0,1.25\n0.5,-2.75"
    path.write_bytes(whole.encode(encoding))
    assert Results.read(path).data.tolist() == [[1.25], [-2.75]]
    line = whole.count("\n") + 1
    for left, said in (("0.5,-", "'-' is not a number"), ("0.5,", "is missing"), ("0.", "has 1 value, the")):
        path.write_bytes(whole.replace("0.5,-2.75", left).encode(encoding))
        with pytest.raises(
            ConfigError, match=rf"x\.csv: line {line}.* {said}.* does not end: the file was cut"
        ):
            Results.read(path)
    for left in ("0.5,2.", '0.5,"2.75'):
        path.write_bytes(whole.replace("0.5,-2.75", left).encode(encoding))
        with pytest.raises(
            ConfigError, match=rf"x\.csv: line {line}, the last, does not end: .* was cut off"
        ):
            Results.read(path)
    for encoded in (f"{header}\n0.0,no\n0.5,1".encode(encoding), f"{header}\n0.0,no\n".encode(encoding)):
        path.write_bytes(encoded)
        with pytest.raises(ConfigError, match=r"'no' is not a number$"):
            Results.read(path)


def test_a_suffix_that_no_reader_has_is_refused_with_those_that_are_known(tmp_path: Path) -> None:
    for name in ("x.xlsx", "x.mat", "results.csv.gz"):
        (tmp_path / name).write_text("time,a.x\n0,1\n")
        with pytest.raises(
            ConfigError, match=r": results are read from \.csv, \.txt, \.tsv, \.dat, not from '"
        ):
            Results.read(tmp_path / name)
    for name in ("x.txt", "x.TSV", "x.dat", "x"):
        (tmp_path / name).write_text("time,a.x\n0,1\n")
        assert len(Results.read(tmp_path / name)) == 1
    with pytest.raises(ConfigError, match=r"gone\.xlsx: cannot be read: No such file"):
        Results.read(tmp_path / "gone.xlsx")
