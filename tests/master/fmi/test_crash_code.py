"""The handler of a crash: written out and from LLVM it writes the same texts and ends the process."""

from __future__ import annotations

import platform
import signal
import subprocess
import sys

import pytest

from evcosim.master.fmi import crash_code

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere faulthandler alone speaks")

CRASH = """
import ctypes, os, sys
from evcosim.master.fmi import crash_code
from evcosim.master.fmi.crash_code import Addresses

def text(said):
    content = ctypes.create_string_buffer(said)
    kept.append(content)
    return ctypes.addressof(content), len(content) - 1

kept, number = [], int(sys.argv[2])
table = (ctypes.c_int64 * 6)(*text(b"zero "), *text(b"first "), *text(b""))
cell, other = ctypes.c_int64(number), (ctypes.c_int64 * 2)(*text(b"all\\n"))
root = (ctypes.c_int64 * 3)(ctypes.addressof(table), ctypes.addressof(cell), ctypes.addressof(other))
library = ctypes.CDLL(None)
calls = [ctypes.cast(library[name], ctypes.c_void_p).value for name in ("write", "signal", "raise")]
about = Addresses(ctypes.addressof(root), *calls)
made = crash_code.handler(about) if sys.argv[1] == "handler" else crash_code._compiled(about)
library.signal(ctypes.c_int(int(sys.argv[3])), ctypes.c_void_p(made.address))
sys.argv.clear()
os.kill(os.getpid(), {signal})
"""


@pytest.mark.parametrize("ending", [signal.SIGSEGV, signal.SIGABRT, signal.SIGFPE])
@pytest.mark.parametrize(("number", "said"), [(0, "zero all\n"), (1, "first all\n"), (2, "all\n")])
def test_the_handler_writes_both_texts_and_the_signal_ends_the_process(
    ending: signal.Signals, number: int, said: str
) -> None:
    for way in ("handler", "compiled"):
        words = [sys.executable, "-c", CRASH.replace("{signal}", str(int(ending)))]
        done = subprocess.run([*words, way, str(number), str(int(ending))], capture_output=True, text=True)
        assert (done.returncode, done.stdout, done.stderr) == (-ending, "", said)


@pytest.mark.skipif(platform.machine() != "x86_64", reason="there LLVM compiles it")
def test_here_llvm_is_not_imported() -> None:
    code = (
        "import sys; from evcosim.master.fmi.crash_code import Addresses, handler; "
        "handler(Addresses(1, 2, 3, 4)); print('llvmlite' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "False\n"
    assert crash_code.handler(crash_code.Addresses(1, 2, 3, 4)).address
