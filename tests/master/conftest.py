"""The command line in this process and as a process of its own, and FMUs that misbehave."""

from __future__ import annotations

import dataclasses
import json
import multiprocessing
import os
import subprocess
import sys

import pytest

from evcosim.fmus.build import build_model
from evcosim.master.cli import main
from support import cli_models, warm

COMMAND = [sys.executable, "-m", "evcosim"]


@dataclasses.dataclass
class Answer:
    """What a command answered."""

    code: int
    out: str
    err: str

    @property
    def json(self):
        """The whole of stdout as JSON: --json prints nothing beside it."""
        return json.loads(self.out)


def in_a_screen(answer):
    """Every error is plain text, a screen at most, and no traceback."""
    assert "Traceback" not in answer.out + answer.err
    assert len(answer.err.splitlines()) <= 24
    assert not answer.err or answer.err.startswith("evcosim: ")
    return answer


@pytest.fixture
def evcosim(capsys, monkeypatch, tmp_path):
    """Run a command line in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.delenv("EVCOSIM_DEBUG", raising=False)

    def run(*arguments):
        capsys.readouterr()
        code = main([str(a) for a in arguments])
        captured = capsys.readouterr()
        return in_a_screen(Answer(code, captured.out, captured.err))

    return run


@pytest.fixture
def process(tmp_path):
    """Start a command line as a process, in an empty folder."""
    started = []

    def start(*arguments, **options):
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True} | options
        options["env"] = os.environ | {"TMPDIR": str(tmp_path)}  # a killed process leaves its FMUs there
        started.append(subprocess.Popen([*COMMAND, *map(str, arguments)], cwd=tmp_path, **options))
        return started[-1]

    yield start
    for each in started:
        each.kill()
        each.wait()
        for pipe in (each.stdout, each.stderr):
            if pipe is not None:
                pipe.close()


@pytest.fixture
def warm_units(monkeypatch):
    """Fork the processes of isolated units from one that has imported what they need, ten times as fast."""
    warm.context()  # now: what it opens stays open
    monkeypatch.setattr(subprocess, "Popen", warm.popen)


@pytest.fixture
def warm_workers(monkeypatch):
    """Fork the workers of `run_all` from a process that has imported what they need."""
    forking = warm.context()
    monkeypatch.setattr(multiprocessing, "get_context", lambda method=None: forking)


@pytest.fixture(scope="session")
def broken_fmus(tmp_path_factory):
    """A folder with an FMU of each model in `support.cli_models`."""
    folder = tmp_path_factory.mktemp("fmus")
    for model in (cli_models.Fragile, cli_models.Through, cli_models.Poison, cli_models.Stuck):
        build_model(model, folder)
    return folder


@pytest.fixture
def system(tmp_path, broken_fmus):
    """Write a system file of units, with FMUs of `broken_fmus`, and the rest as text; return its path."""

    def write(units, rest="", stop_time=10.0):
        lines = ['name = "bench"', "[experiment]", f"stop_time = {stop_time}"]
        for name, fmu in units.items():
            lines += [f"[units.{name}]", f"fmu = '{broken_fmus / fmu}.fmu'"]
        path = tmp_path / "bench.toml"
        path.write_text("\n".join(lines) + "\n" + rest)
        return path

    return write


@pytest.fixture
def two_runs(evcosim, tmp_path):
    """Two short runs that differ in the vehicle's mass."""
    for name, mass in (("a", 200), ("b", 150)):
        options = ["--stop-time", "3", "--no-plot", "-q", "-o", name]
        assert evcosim("run", "scooter", "--set", f"vehicle.mass={mass}", *options).code == 0
    return tmp_path
