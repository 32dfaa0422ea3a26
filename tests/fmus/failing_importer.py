"""An importer that is told how the toy Failing.fmu shall fail, and must be alive afterwards.

Run as `python failing_importer.py FMU FOLDER WAY`; test_failures.py reads what it prints. It talks to the
library by FMPy's thinnest wrapper and frees the instance in the end.
"""

from __future__ import annotations

import gc
import sys
from ctypes import byref, c_int

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.logging import addLoggerProxy

TERMINATED = 3  # fmi2StatusKind


def attempt(call, *arguments):
    """Print the status of a call that fails."""
    try:
        call(*arguments)
        print("status 0")
    except FMICallException as error:
        print("status", error.status)


def fail(unit: FMU2Slave, reference: dict[str, int], way: str) -> None:
    """Bring the FMU to fail in one way."""
    unit.setupExperiment()
    if way in ("in_initial", "in_step", "interrupt"):
        unit.setBoolean([reference[way]], [True])
    if way == "out_of_range":
        unit.setReal([reference["throttle"]], [120.0])
    unit.enterInitializationMode()
    if way in ("in_initial", "out_of_range"):
        attempt(unit.getReal, [reference["total"]])
        for _ in range(3):
            attempt(unit.exitInitializationMode)
        return
    unit.exitInitializationMode()
    if way in ("in_step", "interrupt"):
        for _ in range(3):
            attempt(unit.doStep, 0.5, 0.01)
        terminated = c_int()
        unit.fmi2GetBooleanStatus(unit.component, TERMINATED, byref(terminated))
        print("terminated", terminated.value)
    if way == "in_outputs":
        unit.setReal([reference["command"]], [666.0])
        for _ in range(3):
            attempt(unit.getReal, [reference["total"]])
        attempt(unit.doStep, 0.5, 0.01)
    if way == "no_number":
        unit.setReal([reference["command"]], [1.0])
        attempt(unit.doStep, 0.5, 0.01)
        attempt(unit.getReal, [reference["total"]])
    if way == "setting":
        attempt(unit.setReal, [reference["throttle"]], [3.0])
        attempt(unit.setInteger, [99], [3])
        attempt(unit.setBoolean, [99], [True])
        attempt(unit.setString, [99], ["x"])
    if way == "state":
        attempt(unit.deSerializeFMUstate, b"Failing_0\nrubbish")
        attempt(unit.deSerializeFMUstate, b"")


def main() -> None:
    """Fail, reset, work, fail again, free; twice in one process."""
    file, folder, way = sys.argv[1:]
    fmpy.extract(file, folder)
    description = fmpy.read_model_description(file)
    reference = {v.name: v.valueReference for v in description.modelVariables}

    def note(_, instance, status, category, message):
        print("log", status, (category or b"").decode(), repr(message.decode()))

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = fmi2CallbackLoggerTYPE(note)
    callbacks.allocateMemory = defaultCallbacks.allocateMemory
    callbacks.freeMemory = defaultCallbacks.freeMemory
    addLoggerProxy(byref(callbacks))
    for _ in range(2):
        unit = FMU2Slave(
            guid=description.guid, unzipDirectory=folder, modelIdentifier="Failing", instanceName="it"
        )
        unit.instantiate(callbacks=callbacks, loggingOn=True)
        fail(unit, reference, way)
        unit.reset()
        unit.setupExperiment()
        unit.enterInitializationMode()
        unit.exitInitializationMode()
        unit.setReal([reference["command"]], [2.0])
        unit.doStep(0.0, 0.01)
        print("after reset", unit.getReal([reference["total"]]))
        unit.reset()
        fail(unit, reference, way)
        unit.fmi2FreeInstance(unit.component)
        gc.collect()
    print("alive")


main()
