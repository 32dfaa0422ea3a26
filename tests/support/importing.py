"""FMPy in processes that have imported it and nothing of evcosim, forked from one that has done so."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

_FORKING = """
import os, sys, traceback
import fmpy, fmpy.cli, fmpy.simulation
told = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
for line in sys.stdin:
    code = eval(line)
    child = os.fork()
    if child == 0:
        status = 1
        try:
            exec(code, {"__name__": "__main__"})
            status = 0
        except SystemExit as end:
            status = end.code or 0
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), file=told, flush=True)
"""


@pytest.fixture(scope="session")
def in_an_importer() -> Iterator[Callable[[str], None]]:
    """Run a script in a process of its own, in an empty folder; it must end well."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Path(folder, "said").open("wb") as said,
        subprocess.Popen(
            [sys.executable, "-c", _FORKING],
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=said,
            text=True,
        ) as process,
    ):
        assert process.stdin is not None and process.stdout is not None
        to, back = process.stdin, process.stdout

        def run(script: str) -> None:
            to.write(f"{script!r}\n")
            to.flush()
            status = back.readline().strip()
            assert status == "0", Path(folder, "said").read_text()

        yield run
        to.close()
