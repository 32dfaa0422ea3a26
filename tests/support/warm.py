"""Commands of `evcosim` in processes that are forked from one which has imported what they need.

Each has its own arguments, folder, environment, output and exit code, and finds nothing left by those before.
Only the imports, a second of each command, are done once. Tests of the start itself, of signals, and of what
an FMU may do to its process start a command afresh.
"""

from __future__ import annotations

import functools
import multiprocessing
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from multiprocessing import forkserver
from multiprocessing.context import ForkServerContext
from pathlib import Path

_OF_A_SHELL = re.compile(r"""[|&;<>()$`\\"*?\[\]{}~]""")


def run(line: str, folder: Path, environment: Mapping[str, str]) -> subprocess.CompletedProcess[str]:
    """Run a line of a shell in a folder; return its exit code, stdout and stderr.

    A shell runs it unless it is `evcosim` with arguments and no more: quotes and a comment at most.
    """
    if not line.startswith("evcosim ") or _OF_A_SHELL.search(re.sub("'[^']*'", "", line.split(" #")[0])):
        return subprocess.run(line, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
    arguments = shlex.split(line, comments=True)
    with tempfile.TemporaryDirectory() as kept:
        out, err = Path(kept, "out"), Path(kept, "err")
        given = (arguments, folder, dict(environment), out, err)
        process = _context().Process(target=_carry_out, args=given)
        process.start()
        process.join()
        assert process.exitcode is not None
        return subprocess.CompletedProcess(arguments, process.exitcode, out.read_text(), err.read_text())


@functools.cache
def _context() -> ForkServerContext:
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["support.warmed"])
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = str(Path(__file__).parents[1])  # where it finds the module
    try:
        forkserver.ensure_running()
    finally:
        os.environ.pop("PYTHONPATH")
        if before is not None:
            os.environ["PYTHONPATH"] = before
    return context


def _carry_out(arguments: list[str], folder: Path, environment: dict[str, str], out: Path, err: Path) -> None:
    """Be the process of a command, from its first line to its exit code."""
    for path, descriptor in ((out, 1), (err, 2)):
        with path.open("wb") as file:
            os.dup2(file.fileno(), descriptor)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    tempfile.tempdir = None  # is found in this environment
    sys.argv = arguments
    from evcosim.master.cli import main

    sys.exit(main())
