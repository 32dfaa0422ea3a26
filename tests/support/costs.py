"""Processor seconds of each file of tests, shown at the end of a run: what has grown is seen.

They are those of the process that runs the test, of the processes that it has started and waited for, and of
those that are forked from the warm one (see `warm`); imports on collecting are not in them.
"""

from __future__ import annotations

import os
import sys
from collections import defaultdict
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest

_NAME = "processor_seconds"
_SHOWN = 15
"""Files that are shown without --costs, where more than so many took part."""


class Costs:
    """A plugin of pytest, in the process that runs tests and in the one that reports."""

    def __init__(self, config: pytest.Config) -> None:
        self._shown = config.getoption("costs")
        self._before = used()
        self._by_file: dict[str, float] = defaultdict(float)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Give the report of a set-up, a call or a tear-down what was used since the one before."""
        report = yield
        now = used()
        report.user_properties.append((_NAME, now - self._before))
        self._before = now
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Add what a report tells, of this process or of another one of pytest-xdist."""
        file = report.nodeid.split("::", maxsplit=1)[0]
        self._by_file[file] += sum(value for name, value in report.user_properties if name == _NAME)

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        """Write the files that cost most."""
        count = self._shown
        if count is None:
            count = _SHOWN if len(self._by_file) > _SHOWN else 0
        if not count:
            return
        whole = sum(self._by_file.values())
        terminalreporter.write_sep("=", f"processor seconds of files: {whole:.0f} in {len(self._by_file)}")
        for file, seconds in sorted(self._by_file.items(), key=lambda item: -item[1])[:count]:
            terminalreporter.write_line(f"{seconds:7.1f} {file}")


def used() -> float:
    """Return the processor seconds of this process, of its children that have ended, and of warm ones."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system + _of_warm()


def _of_warm() -> float:
    """Return those of the process that forks, which this one does not wait for, and of what it has forked."""
    module = sys.modules.get("multiprocessing.forkserver")  # imported by the first test that forks
    number = module and module._forkserver._forkserver_pid
    about = Path(f"/proc/{number}/stat")
    if number is None or not about.exists():
        return 0.0
    fields = about.read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")
