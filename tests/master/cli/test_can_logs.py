"""The options of CAN logs: formats, places, the start of their clock, and what is refused before a run."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.cli.can_logs import CanLogs


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
