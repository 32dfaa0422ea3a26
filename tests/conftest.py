"""What holds for every test."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys

import pytest

from support import bytecode, costs, scratch

with bytecode.written():  # of hypothesis too, whose assertions pytest rewrites, since it is a plugin
    from hypothesis import settings

# an example that a busy machine slows down has failed nothing: speed is shown by benchmarks
settings.register_profile("evcosim", deadline=None)
settings.load_profile("evcosim")

for number, handler in ((signal.SIGINT, signal.default_int_handler), (signal.SIGQUIT, signal.SIG_DFL)):
    if signal.getsignal(number) is signal.SIG_IGN:  # as in a background job, whose children ignore it too
        signal.signal(number, handler)

bytecode.compile_sources()
scratch.use()


def pytest_addoption(parser):
    parser.addoption(
        "--costs", type=int, metavar="N", help="show processor seconds of the N most costly files"
    )


def pytest_configure(config):
    config.pluginmanager.register(costs.Costs(config), "costs")


def pytest_sessionstart(session):
    """Compile what the cache lacks, once: else each worker would, and each command that a test starts."""
    if session.config.getoption("numprocesses", None) and "PYTEST_XDIST_WORKER" not in os.environ:
        code = "from evcosim.master.engine.selection import compile_engine; compile_engine()"
        subprocess.run([sys.executable, "-c", code], check=False)  # tests of the engine say what is wrong


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    gc.disable()
    try:
        with bytecode.written():
            return (yield)
    finally:
        gc.enable()
        gc.freeze()  # no later search for garbage looks at ten thousand tests, nor in a child of `fork`


def pytest_sessionfinish(exitstatus):
    scratch.failed = exitstatus != 0
