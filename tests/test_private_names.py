"""The names that we use of libraries which do not promise them: each is there in what is installed.

A new version of a library may take one away without a word. pyproject.toml therefore bounds these libraries
from above; before a bound is raised, this file shows what has to be looked at. Each entry says who uses what.
"""

from __future__ import annotations

import ast
import functools
import importlib
import inspect
import io
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ("api", "models", "fmus", "cosim", "master")

# module of a library: who uses it, and the names, with dots where a name is looked up in a name
NAMES = {
    "fmpy.logging": ("master/fmi/callbacks.py", "addLoggerProxy"),  # its library, by its path
    "fmpy.model_description": (
        "master/fmi/description.py, supplement.py, validation.py",
        "Unknown ValidationError read_model_description",
    ),
    "fmpy.sundials": ("master/fmi/cvode.py", "libraries"),
    "fmpy.sundials.libraries": (
        "master/fmi/cvode.py",
        "sundials_core._handle sundials_nvecserial._handle sundials_sunmatrixdense._handle "
        "sundials_sunlinsoldense._handle sundials_cvode._handle",
    ),
    "fmpy.sundials.nvector_serial": ("master/fmi/cvode.py", "_N_VectorContent_Serial.data.offset"),
    "can": (
        "cosim/can/logs/vector.py",
        "Message BLFWriter.on_message_received BLFWriter.stop ASCWriter._format_header_datetime "
        "ASCWriter.log_event ASCWriter.on_message_received ASCWriter.stop",
    ),
    "numba": ("master/engine/compiled", "cfunc njit types.intp config.CACHE_DIR extending.intrinsic"),
    "numba.core.cgutils": (
        "master/engine/compiled/wire_types.py",
        "create_struct_proxy unpack_tuple _StructProxy._getvalue",
    ),
    "numba.core.compiler": ("master/engine/compiled/compiling.py", "Compiler.define_pipelines"),
    "numba.core.typing.templates": (
        "master/engine/compiled/wire_types.py",
        "AbstractTemplate AttributeTemplate infer_getattr infer_global signature",
    ),
    "pythonfmu.fmi2slave": (
        "fmus/slave.py",
        "Fmi2Slave._get_fmu_state Fmi2Slave._set_fmu_state Fmi2Slave._fmu_state_to_bytes "
        "Fmi2Slave._fmu_state_from_bytes Fmi2Slave.log Fmi2Slave.log_categories",
    ),
    "typer.completion": (
        "master/cli/completion.py",
        "completion_init get_completion_script install shell_complete",
    ),
    "typer.main": ("master/cli/app.py", "get_command"),
}

# class of FMPy's model_description: the attributes that master/fmi, master/cli and master/studies read
ATTRIBUTES = {
    "ModelDescription": "coSimulation defaultExperiment derivatives description fmiVersion generationTool "
    "guid initialUnknowns instantiationToken license logCategories modelExchange modelName modelVariables "
    "numberOfContinuousStates numberOfEventIndicators outputs unitDefinitions version",
    "CoSimulation": "modelIdentifier needsExecutionTool canBeInstantiatedOnlyOncePerProcess "
    "canHandleVariableCommunicationStepSize canInterpolateInputs canGetAndSetFMUstate canSerializeFMUstate "
    "providesDirectionalDerivative canRunAsynchronuously fixedInternalStepSize hasEventMode "
    "maxOutputDerivativeOrder mightReturnEarlyFromDoStep providesIntermediateUpdate",
    "ModelExchange": "modelIdentifier needsExecutionTool needsCompletedIntegratorStep",
    "ModelVariable": "name valueReference type shape description causality variability clocks declaredType "
    "dimensions unit min max start alias",
    "Unknown": "variable dependencies",
    "SimpleType": "items min max unit",
    "Item": "name value",
    "Dimension": "start variable",
    "Unit": "name baseUnit",
    "BaseUnit": "kg m s A K mol cd rad factor offset",
    "DefaultExperiment": "startTime stopTime stepSize tolerance",
}


@pytest.mark.parametrize(
    ("module", "name"), [(module, name) for module, (_, names) in NAMES.items() for name in names.split()]
)
def test_a_name_is_there(module, name):
    functools.reduce(getattr, name.split("."), importlib.import_module(module))


@pytest.mark.parametrize("kind", ATTRIBUTES)
def test_fmpy_s_descriptions_have_what_is_read(kind):
    found = getattr(importlib.import_module("fmpy.model_description"), kind)
    assert set(ATTRIBUTES[kind].split()) <= {*dir(found), *inspect.signature(found).parameters}


def test_fmpy_has_the_headers_of_fmi():
    """For `evcosim compile` (master/fmi/compilation.py)."""
    import fmpy

    headers = {path.name for path in (Path(fmpy.__file__).parent / "c-code").iterdir()}
    assert {"fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h", "fmi3Functions.h"} <= headers


def test_python_can_s_writers_have_what_is_set():
    """cosim/can/logs/vector.py sets both, so that times count from the start of the run."""
    import can

    assert can.BLFWriter(io.BytesIO()).start_timestamp is None
    assert can.ASCWriter(io.StringIO()).header_written is False


def test_pythonfmu_has_what_an_fmu_carries():
    """fmus/runtime.py copies these; fmus/repairs.py calls a function of the library on Linux."""
    from evcosim.fmus import runtime

    assert {"linux64/.so", "win64/.dll"} <= runtime.binaries().keys()
    assert all(runtime.python_files().values())
    assert b"finalizePythonInterpreter" in runtime.binaries()["linux64/.so"]

    class Slave(importlib.import_module("pythonfmu.fmi2slave").Fmi2Slave):
        def do_step(self, current_time: float, step_size: float) -> bool:
            return True

    slave = Slave(instance_name="one", resources="here")
    assert (slave.log_queue, slave.resources) == ([], "here")


def test_typer_gives_its_errors_a_message():
    """master/cli/failures.py knows a wrong use by it, whether typer brings its own click or not."""
    import typer

    assert callable(typer.BadParameter("why").format_message)


def test_pydantic_names_its_errors():
    """cosim/system words these two by itself, and takes the prefix off the others."""
    import pydantic

    class Record(pydantic.BaseModel, extra="forbid"):
        needed: int

        @pydantic.field_validator("needed")
        @classmethod
        def _refuse(cls, value: int) -> int:
            raise ValueError("why")

    with pytest.raises(pydantic.ValidationError) as caught:
        Record.model_validate({"more": 1})
    assert sorted(problem["type"] for problem in caught.value.errors()) == ["extra_forbidden", "missing"]
    with pytest.raises(pydantic.ValidationError) as caught:
        Record.model_validate({"needed": 1})
    assert caught.value.errors()[0]["msg"] == "Value error, why"


# ---- the list is whole


@functools.cache
def sources() -> list[tuple[str, ast.AST]]:
    """Each node of our sources that has a name, with the file that it stands in."""
    return [
        (file.relative_to(ROOT).as_posix(), node)
        for folder in FOLDERS
        for file in sorted((ROOT / folder).rglob("*.py"))
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute | ast.ImportFrom | ast.FunctionDef | ast.ClassDef)
    ]


def test_what_is_imported_of_fmpy_is_listed():
    """FMPy documents little, so that each of its names counts as private."""
    for file, node in sources():
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("fmpy"):
            who, names = NAMES[str(node.module)]
            listed = {name.partition(".")[0] for name in names.split()}
            assert {alias.name for alias in node.names} <= listed, file
            assert file.startswith(who.partition(".py")[0]) or Path(file).name in who, file


def test_names_that_begin_with_an_underscore_are_listed():
    """Those of other modules: what an object, a class or this package has of its own is no matter here."""
    listed = {part for _, names in NAMES.values() for name in names.split() for part in name.split(".")}
    documented = {"_exit", "_fields_", "_missing_", "__cxa_atexit"}  # os, ctypes, enum, the C++ ABI
    ours = {node.name for _, node in sources() if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    ours |= {node.attr for _, node in sources() if isinstance(node, ast.Attribute) and set_here(node)}
    for file, node in sources():
        if isinstance(node, ast.Attribute) and node.attr.startswith("_") and not node.attr.endswith("__"):
            assert node.attr in listed | documented | ours, f"{file}: {node.attr}"
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            private = {alias.name for alias in node.names if alias.name.startswith("_")}
            assert private <= listed, f"{file}: {private}"


def set_here(node: ast.Attribute) -> bool:
    """True of an attribute of one of our own objects."""
    return isinstance(node.value, ast.Name) and node.value.id in ("self", "cls", "slave")
