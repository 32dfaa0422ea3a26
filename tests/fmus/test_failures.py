"""A model that raises ends its simulation, with a message, and never its importer."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

IMPORTER = Path(__file__).with_name("failing_importer.py")
FATAL = "log 4  'Fatal py exception encountered: [{call}] PyObject_CallMethod\\nfmi2{text}"


@pytest.mark.parametrize(
    ("way", "expected"),
    [
        (
            "in_step",
            "log 3 logStatusError 'fmi2DoStep at t = 0.5 s: ZeroDivisionError: no 100 % step (failing.py:",
        ),
        ("in_step", "status 2\n"),
        ("in_step", "terminated 1\n"),
        ("interrupt", "log 3 logStatusError 'fmi2DoStep at t = 0.5 s: KeyboardInterrupt:  (failing.py:"),
        (
            "in_initial",
            FATAL.format(
                call="getReal",
                text="GetReal: RuntimeError: 100 % sure %s %n \u00fc \\\\udc80 \\\\0 (failing.py:",
            ),
        ),
        (
            "out_of_range",
            FATAL.format(
                call="exitInitializationMode",
                text="ExitInitializationMode: throttle = 120.0 % is above its maximum 100.0 %'",
            ),
        ),
        ("in_outputs", FATAL.format(call="getReal", text="GetReal: KeyError: ").replace("'F", '"F')),
        ("in_outputs", "status 2\n"),
        (
            "no_number",
            "log 3 logStatusError 'fmi2DoStep at t = 0.5 s: output total is None, which is no Real'",
        ),
        ("setting", FATAL.format(call="setReal", text="SetReal: throttle is a fixed parameter")),
        ("state", "status 4\n"),
    ],
)
def test_the_importer_lives_and_knows_why(toy, tmp_path, way, expected):
    arguments = [toy("Failing").path, tmp_path / "unpacked", way]
    done = subprocess.run(
        [sys.executable, IMPORTER, *arguments], capture_output=True, text=True, timeout=60, encoding="utf-8"
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.splitlines()[-1] == "alive"
    assert done.stdout.count("after reset [2.0]\n") == 2
    assert expected in done.stdout
    assert done.stderr == ""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems destroy in the right order")
def test_the_library_is_settled_before_the_process_ends(toy, tmp_path):
    script = f"""
import atexit, ctypes, fmpy
from fmpy.fmi2 import FMU2Slave
called = []
class Recording(ctypes.CDLL):
    def __getattr__(self, name):
        called.append((self._name, name))
        return super().__getattr__(name)
atexit.register(lambda: print(called))
folder = {str(tmp_path / "unpacked")!r}
fmpy.extract({str(toy("Failing").path)!r}, folder)
for _ in range(2):
    unit = FMU2Slave(guid="", unzipDirectory=folder, modelIdentifier="Failing", instanceName="it")
    unit.instantiate()
ctypes.CDLL = Recording
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    library = str(tmp_path / "unpacked" / "binaries" / "linux64" / "Failing.so")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{[(library, 'finalizePythonInterpreter')]}\n"


def test_a_thousand_instances_in_one_process(toy, tmp_path):
    script = f"""
import fmpy, gc, sys
from fmpy.fmi2 import FMU2Slave
folder = {str(tmp_path / "unpacked")!r}
fmpy.extract({str(toy("Failing").path)!r}, folder)
path = list(sys.path)
for k in range(1000):
    unit = FMU2Slave(guid="", unzipDirectory=folder, modelIdentifier="Failing", instanceName=f"i{{k}}")
    unit.instantiate()
    unit.setupExperiment()
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.fmi2FreeInstance(unit.component)
gc.collect()
from collections import Counter
living = Counter(type(o).__name__ for o in gc.get_objects())
assert living["Failing"] == 0, living["Failing"]
assert sys.path == path
print("alive")
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "alive\n", "")
