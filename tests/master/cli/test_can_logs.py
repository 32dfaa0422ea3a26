"""The options of CAN logs: formats, places, the start of their clock, and what is refused before a run."""

from __future__ import annotations

import sys
from datetime import UTC, datetime
from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.cli.can_logs import CanLogs
from support.small_bench import write


def test_a_name_goes_into_the_results_and_a_path_where_it_says(evcosim, tmp_path):
    answer = evcosim(
        "run", "scooter", "--stop-time", "0.2", "--no-plot", "--no-report", "-o", "out",
        "--can-log", "can.asc", "--can-log", "logs/x.log", "--can-log-start", "2026-05-04T14:00+02:00",
    )  # fmt: skip # options and their values
    assert (answer.code, answer.err) == (0, "")
    assert "can.asc, logs/x.log" in answer.out
    assert "date Mon May 04 12:00:00.000 2026" in (tmp_path / "out" / "can.asc").read_text()
    begin = datetime(2026, 5, 4, 12, tzinfo=UTC).timestamp()
    first = (tmp_path / "logs" / "x.log").read_text().splitlines()[0]
    assert first.startswith(f"({begin:.6f}) can0 ")


@pytest.mark.parametrize(
    ("paths", "start", "said"),
    [
        (["a.txt"], None, r"a\.txt: CAN logs are written as \.log, .* not as '\.txt'"),
        (["a.log", "a.log"], None, r"--can-log a\.log is given twice"),
        ([], "2026-05-04T14:00Z", "there is no --can-log whose clock it would set"),
        (["a.log"], "2026-05-04", "a date of 1971 to 2199 with a time zone is needed"),
        (["a.log"], "1970-01-01T00:00Z", "a date of 1971 to 2199"),
        (["a.log"], "tomorrow", "--can-log-start tomorrow: a date"),
    ],
)  # fmt: skip # a row for each refusal
def test_what_no_log_can_be_is_refused(paths: list[str], start: str | None, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        CanLogs.asked([Path(path) for path in paths], start)


def test_without_files_nothing_is_asked() -> None:
    assert not CanLogs.asked(None, None)
    assert CanLogs.asked([Path("a.log")], None)


def test_a_missing_library_is_known_before_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    with pytest.raises(
        ConfigError, match=r"asammdf: install evcosim with its extra, pip install 'evcosim\[mf4\]'"
    ):
        CanLogs.asked([Path("a.log"), Path("b.MF4")], None)


NEVER = {
    "taken.log": "taken.log: cannot be written: Is a directory",
    "file/x.log": "file is a file, not a folder",
    "/dev/null/x.log": "/dev/null is a file, not a folder",
}


@pytest.mark.parametrize("name", NEVER)
def test_a_place_that_takes_no_log_is_known_before_the_run(evcosim, tmp_path, name):
    (tmp_path / "out" / "taken.log").mkdir(parents=True)
    (tmp_path / "file").touch()
    answer = evcosim("run", "scooter", "--stop-time", "0.2", "-o", "out", "--can-log", name)
    assert (answer.code, NEVER[name] in answer.err) == (2, True)
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["taken.log"]


def test_a_run_that_begins_before_the_log_is_known_before_its_first_step(tmp_path):
    logs = CanLogs.asked([Path("can.log")], None)
    logs.check(tmp_path, 0.0)
    with pytest.raises(ConfigError, match=r"^can.log: a CAN log has no times .* the run begins at -1.0 s$"):
        logs.check(tmp_path, -1.0)
    assert list(tmp_path.iterdir()) == []


def test_without_matplotlib_a_figure_is_refused_before_the_run(evcosim, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    answer = evcosim("run", "scooter", "--stop-time", "0.2", "-o", "out")
    assert (answer.code, "figure and page need matplotlib" in answer.err) == (2, True)


def test_a_bus_with_a_resolution_writes_no_log(evcosim, tmp_path):
    path = write(tmp_path)
    path.write_text(path.read_text().replace('"bench.dbc" }', '"bench.dbc", resolution = 4.0 }'))
    answer = evcosim("run", str(path), "-o", "out", "--can-log", "a.log")
    assert answer.code == 2 and "buses.can0.resolution = 4: its raw values count coarser" in answer.err
    assert not (tmp_path / "out").exists()
