"""The FMUs of the benchmarks, made on this machine: in C with its compiler, in Python with pythonfmu."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from .case import Case

SOURCES = Path(__file__).with_name("sources")
_FLAGS = ("-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-w")


class CannotBuild(RuntimeError):
    """What the benchmarks need cannot be made here. The message says why."""


def c_library(source: str, out: Path, *flags: str) -> Path:
    """Compile one of the C sources into a shared library. Raises CannotBuild."""
    return _compiled(source, out, *_FLAGS, *flags)


def c_program(source: str, out: Path) -> Path:
    """Compile one of the C sources into a program. Raises CannotBuild."""
    return _compiled(source, out, "-O2")


def _compiled(source: str, out: Path, *flags: str) -> Path:
    compile_c([*flags, str(SOURCES / source), "-o", str(out)])
    return out


def compile_c(arguments: list[str]) -> None:
    """Call the C compiler. Raises CannotBuild."""
    compiler = os.environ.get("CC") or shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        raise CannotBuild("there is no C compiler: install one or set CC")
    made = subprocess.run([compiler, *arguments], capture_output=True, text=True, check=False)
    if made.returncode:
        raise CannotBuild(f"{' '.join([compiler, *arguments])}: {made.stderr.strip()[-500:]}")


def c_fmu(folder: Path, signals: int) -> Path:
    """Node<signals>.fmu: the unit in C with so many inputs and outputs."""
    name = f"Node{signals}"
    path = folder / f"{name}.fmu"
    if not path.exists():
        library = c_library("node.c", folder / f"{name}.so", f"-DSIGNALS={signals}")
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("modelDescription.xml", _description(name, signals))
            archive.write(library, f"binaries/linux64/{name}.so")
    return path


def _description(name: str, signals: int) -> str:
    """The model description of Node<signals>; value references as node.c says."""
    real, n = '<Real start="0"/>', signals
    variables = [_scalar(f"u{i}", i, "input", "continuous", real) for i in range(n)]
    variables += [_scalar(f"y{i}", n + i, "output", "continuous", real, 'initial="exact" ') for i in range(n)]
    variables.append(_scalar("gain", 2 * n, "parameter", "fixed", '<Real start="1"/>'))
    variables += [_scalar(f"bias{i}", 2 * n + 1 + i, "parameter", "fixed", real) for i in range(n)]
    structure = [f'<Unknown index="{n + i + 1}" dependencies=""/>' for i in range(n)]
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{{{name}}}" numberOfEventIndicators="0">
<CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true"/>
<ModelVariables>
{chr(10).join(variables)}
</ModelVariables>
<ModelStructure><Outputs>{"".join(structure)}</Outputs></ModelStructure>
</fmiModelDescription>
"""


def _scalar(name: str, reference: int, causality: str, variability: str, kind: str, more: str = "") -> str:
    return (
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="{variability}" {more}>{kind}</ScalarVariable>'
    )


def python_fmu(folder: Path) -> Path:
    """PyNode.fmu: the same unit with one signal, made with pythonfmu."""
    path = folder / "PyNode.fmu"
    if not path.exists():
        with tempfile.TemporaryDirectory() as scratch:
            source = shutil.copy(SOURCES / "node.py", Path(scratch) / "pynode.py")
            command = [sys.executable, "-m", "pythonfmu", "build", "-f", str(source), "-d", str(folder)]
            made = subprocess.run(command, capture_output=True, text=True, check=False)
        if not path.exists():
            raise CannotBuild(f"pythonfmu cannot build {source}: {made.stderr.strip()[-500:]}")
    return path


def fmu_of(case: Case, folder: Path) -> Path:
    """The FMU of which all units of a case are."""
    return c_fmu(folder, case.signals) if case.kind == "c" else python_fmu(folder)
