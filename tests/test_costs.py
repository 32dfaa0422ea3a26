"""The processor seconds of files of tests, which a run shows at its end."""

from __future__ import annotations

import subprocess
import sys
import time
from types import SimpleNamespace
from typing import Any, cast

import pytest

from support import warm
from support.costs import Costs, used

_SPIN = "import time\nwhile time.process_time() < 0.3: pass"


def test_children_that_have_ended_are_counted() -> None:
    before = used()
    subprocess.run([sys.executable, "-c", _SPIN], check=True)
    assert used() - before >= 0.25  # counted in ticks of 10 ms


def test_a_warm_process_is_counted() -> None:
    forking = warm.context()
    before = used()
    process = forking.Process(target=exec, args=(_SPIN.replace("process_time", "thread_time"),))
    process.start()
    process.join()
    assert process.exitcode == 0
    deadline = time.monotonic() + 30.0
    while used() - before < 0.2 and time.monotonic() < deadline:  # it is counted once it has been waited for
        time.sleep(0.01)
    assert used() - before >= 0.2


class Written(list[str]):
    """What a plugin writes at the end of a run."""

    def write_sep(self, sep: str, title: str) -> None:
        self.append(title)

    def write_line(self, line: str) -> None:
        self.append(line)


@pytest.mark.parametrize(("count", "lines"), [(None, 0), (2, 3), (9, 4)])
def test_the_most_costly_files_come_first(count: int | None, lines: int) -> None:
    costs = Costs(cast(Any, SimpleNamespace(getoption=lambda name: count)))
    parts = [
        ("a.py::one", 1.0),
        ("b.py::one", 2.5),
        ("a.py::two", 1.0),
        ("c.py::one[x::y]", 0.2),
        ("b.py::two", 0.0),
    ]
    for test, seconds in parts:
        properties = [("other", "text"), ("processor_seconds", seconds)]
        costs.pytest_runtest_logreport(cast(Any, SimpleNamespace(nodeid=test, user_properties=properties)))
    written = Written()
    costs.pytest_terminal_summary(written)
    expected = ["processor seconds of files: 5 in 3", "    2.5 b.py", "    2.0 a.py", "    0.2 c.py"]
    assert written == expected[:lines]
