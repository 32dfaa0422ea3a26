"""What holds for every test."""

from __future__ import annotations

import signal

import pytest
from hypothesis import settings

from support import bytecode, scratch

# an example that a busy machine slows down has failed nothing: speed is shown by benchmarks
settings.register_profile("evcosim", deadline=None)
settings.load_profile("evcosim")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in a background job, whose children ignore it too
    signal.signal(signal.SIGINT, signal.default_int_handler)

bytecode.compile_sources()
scratch.use()


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    with bytecode.written():
        return (yield)


def pytest_sessionfinish(exitstatus):
    scratch.failed = exitstatus != 0
