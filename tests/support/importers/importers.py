"""The importers, and how each is started: a program in C, a command line, or a program of hosts/.

An environment, for those in Python, is a folder that `python -m venv` made. None of them needs evcosim.
"""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from support.importers.trials import Job, Run, Said, description, outputs, variables

ROOT = Path(__file__).parents[3]
HOSTS = Path(__file__).with_name("hosts")
ALL = frozenset({"parameters", "two", "state"})
NO_STATE = ALL - {"state"}
TYPES = {"Real": "r", "Integer": "i", "Enumeration": "e", "Boolean": "b"}


class Importer(NamedTuple):
    """An importer: its name, how it runs a job, its version, what it can."""

    name: str
    run: Run
    version: str
    can: frozenset[str] = ALL


class InPython(NamedTuple):
    """An importer in Python: its distribution and the program of hosts/."""

    name: str
    distribution: str
    program: str
    can: frozenset[str] = ALL


IN_PYTHON = (
    InPython("FMPy `simulate_fmu`", "fmpy", "by_fmpy.py"),
    InPython("fmuloader", "fmuloader", "by_fmuloader.py"),
    InPython("libcosimpy", "libcosimpy", "by_libcosimpy.py", NO_STATE),
    InPython("ecospy", "ecospy", "by_ecospy.py", NO_STATE),
    InPython("fmucontainer, then FMPy", "fmu-manipulation-toolbox", "by_fmucontainer.py", NO_STATE),
    InPython("CoFmuPy", "cofmupy", "by_cofmupy.py", NO_STATE),
    InPython("pathsim-fmi", "pathsim-fmi", "by_pathsim.py", NO_STATE),
    InPython("sofirpy", "sofirpy", "by_sofirpy.py", NO_STATE),
)


def in_environments(environments: Sequence[Path]) -> list[Importer]:
    """Return the importers in Python, each in the first environment that has it."""
    found, pythons = [], homes(environments)
    for one in IN_PYTHON:
        if one.distribution in pythons:
            python = pythons[one.distribution]
            version = _version(python, one.distribution)
            found.append(Importer(one.name, hosted(python, HOSTS / one.program), version, one.can))
            if one.distribution == "fmpy":
                run = _command_line_of_fmpy(python)
                found.append(Importer("FMPy's command line", run, version, frozenset({"parameters"})))
    return found


def homes(environments: Sequence[Path]) -> dict[str, Path]:
    """Return the Python that has each distribution: the first of the environments."""
    found: dict[str, Path] = {}
    for folder in environments:
        for one in IN_PYTHON:
            if one.distribution not in found and _version(_python(folder), one.distribution):
                found[one.distribution] = _python(folder)
    return found


def in_c(programs: dict[str, Path]) -> list[Importer]:
    """Return the importers that are programs: `c_host`, `fmusim`, `fmuCheck`, by their files."""
    found = []
    if "c_host" in programs:
        found.append(Importer("a host in C", c_host(programs["c_host"]), ""))
    if "fmusim" in programs:
        program = programs["fmusim"]
        version = _said([program, "--version"]).split()[1]
        found.append(Importer("fmusim", _fmusim(program), version, frozenset({"parameters", "state"})))
    if "fmuCheck" in programs:
        program = programs["fmuCheck"]
        version = _said([program]).split("checker ")[1].split()[0]
        found.append(Importer("fmuCheck", _fmu_check(program), version, frozenset()))
    return found


def python_of_a_host() -> dict[str, str]:
    """Return the variables that let a program that is not Python run an FMU in Python: this one."""
    folder, file = (str(sysconfig.get_config_var(name)) for name in ("LIBDIR", "LDLIBRARY"))
    return {"LD_PRELOAD": str(Path(folder, file)), "PYTHONHOME": sys.base_prefix}


def _environment(job: Job) -> dict[str, str] | None:
    """Return the environment of a program in C for a job."""
    return os.environ | python_of_a_host() if job.kind == "python" else None


def called(command: Sequence[str | Path], environment: dict[str, str] | None = None) -> tuple[int, str]:
    """Return exit code and all that a command printed."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = subprocess.run(
                command,
                env=environment,
                cwd=folder,
                capture_output=True,
                timeout=120,
                stdin=subprocess.DEVNULL,
            )
        except subprocess.TimeoutExpired:
            return -1, "an error: no end within 120 s"
    text = (done.stdout + b"\n" + done.stderr).decode(errors="replace")
    if done.returncode < 0:
        text += f"\nended by signal {-done.returncode}"
    return done.returncode, text


def _said(command: Sequence[str | Path]) -> str:
    return called(command)[1]


def _python(environment: Path) -> Path:
    return environment / ("Scripts" if os.name == "nt" else "bin") / "python"


def _version(python: Path, distribution: str) -> str:
    code = f"import importlib.metadata as m; print(m.version({distribution!r}))"
    if not python.is_file():
        raise SystemExit(f"{python.parent.parent} is no environment: it has no {python.name}")
    status, text = called([python, "-c", code])
    return "" if status else text.strip()


def hosted(python: Path, program: Path) -> Run:
    """Return how a program of hosts/ runs a job, in the environment of a Python."""

    def run(job: Job) -> Said:
        given = {
            "fmu": str(job.fmu),
            "fmi": job.fmi,
            "step": job.step,
            "count": job.count,
            "parameters": dict(job.parameters),
            "inputs": [dict(inputs) for inputs in job.inputs],
            "outputs": outputs(job.model),
            "variables": variables(job.model, job.kind),
            "saves": job.saves,
        }
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "job.json")
            path.write_text(json.dumps(given), encoding="utf-8")
            _, text = called([python, program, path])
        found = re.search(r"^ANSWER (.*)$", text, re.MULTILINE)
        return Said(json.loads(found[1])["instances"] if found else None, text)

    return run


def c_host(program: Path) -> Run:
    """Return how the host of c_host.c runs a job."""

    def run(job: Job) -> Said:
        known, told = variables(job.model, job.kind), outputs(job.model)
        units: list[str] = []
        for inputs in job.inputs:
            units += [
                "(",
                *(_given(known, name, value) for name, value in {**job.parameters, **inputs}.items()),
            ]
            units += [f"o{known[name][0]}:{TYPES[known[name][1]]}" for name in told]
        with tempfile.TemporaryDirectory() as folder:
            with zipfile.ZipFile(job.fmu) as archive:
                archive.extractall(folder)
            platform = "linux64" if job.fmi == 2 else "x86_64-linux"
            library = Path(folder, "binaries", platform, f"{job.model}.so")
            resources = f"file://{folder}/resources" if job.fmi == 2 else f"{folder}/resources/"
            token = description(job.model, job.kind)
            token = token.guid if job.fmi == 2 else token.instantiationToken
            command = [program, library, str(job.fmi), token, resources]
            command += [repr(job.step), str(job.count), str(int(job.saves)), *units]
            status, text = called(command, _environment(job))
        if status:
            return Said(None, text)
        rows = [
            dict(zip(told, map(float, line.split()[1:]), strict=True))
            for line in text.splitlines()
            if line.startswith("ROW")
        ]
        return Said([rows[n :: len(job.inputs)] for n in range(len(job.inputs))], text)

    return run


def _given(known: dict[str, tuple[int, str]], name: str, value: object) -> str:
    reference, kind = known[name]
    return f"p{reference}:{TYPES[kind]}={value!r}"


def _read_rows(path: Path, job: Job, text: str) -> Said:
    """Return the rows of a file that a command line wrote, without that of the start."""
    if not path.is_file():
        return Said(None, text)
    with path.open(newline="", encoding="utf-8") as file:
        rows = [
            {
                name.strip('"'): _number(value)
                for name, value in row.items()
                if name.strip('"') in outputs(job.model)
            }
            for row in csv.DictReader(file, skipinitialspace=True)
        ]
    return Said([rows[1:]], text)


def _number(text: str) -> float:
    return {"true": 1.0, "false": 0.0}.get(text.lower()) or float(text)


def _command_line_of_fmpy(python: Path) -> Run:
    def run(job: Job) -> Said:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "out.csv")
            command: list[str | Path] = [python, "-m", "fmpy", "simulate", job.fmu]
            command += ["--stop-time", repr(job.step * job.count), "--output-interval", repr(job.step)]
            command += ["--output-file", path, "--output-variables", *outputs(job.model), "--start-values"]
            for name, value in {**job.parameters, **job.inputs[0]}.items():
                command += [name, str(value)]
            _, text = called(command)
            return _read_rows(path, job, text)

    return run


def _fmusim(program: Path) -> Run:
    def run(job: Job) -> Said:
        with tempfile.TemporaryDirectory() as folder:
            path, state = Path(folder, "out.csv"), Path(folder, "state")

            def command(start: int, stop: int, *more: str | Path) -> list[str | Path]:
                words: list[str | Path] = [program, "--interface-type", "cs", "--output-file", path]
                words += ["--start-time", repr(start * job.step), "--stop-time", repr(stop * job.step)]
                words += ["--output-interval", repr(job.step), "--logging-on", *more]
                for name in outputs(job.model):
                    words += ["--output-variable", name]
                for name, value in {**job.parameters, **job.inputs[0]}.items():
                    words += ["--start-value", name, str(value)]
                return [*words, job.fmu]

            if not job.saves:
                status, text = called(command(0, job.count), _environment(job))
                return Said(None, text) if status else _read_rows(path, job, text)
            half = job.count // 2
            status, text = called(command(0, half, "--final-fmu-state-file", state), _environment(job))
            if status:
                return Said(None, text)
            first = _read_rows(path, job, text)
            path.unlink(missing_ok=True)
            _, text = called(command(half, job.count, "--initial-fmu-state-file", state), _environment(job))
            second = _read_rows(path, job, text)
            if first.rows is None or second.rows is None:
                return Said(None, first.text + second.text)
            return Said([first.rows[0] + second.rows[0]], first.text + second.text)

    return run


def _fmu_check(program: Path) -> Run:
    def run(job: Job) -> Said:
        with tempfile.TemporaryDirectory() as folder:
            path, given = Path(folder, "out.csv"), Path(folder, "in.csv")
            inputs = job.inputs[0]
            lines = [",".join(["time", *inputs])]
            lines += [
                ",".join(map(repr, [time, *inputs.values()])) for time in (0.0, job.step * job.count * 2.0)
            ]
            given.write_text("\n".join(lines) + "\n", encoding="utf-8")
            command = [program, "-k", "cs", "-h", repr(job.step), "-s", repr(job.step * job.count), "-n", "0"]
            status, text = called([*command, "-i", given, "-o", path, job.fmu], _environment(job))
            return Said(None, text) if status else _read_rows(path, job, text)

    return run
