"""Our FMUs in a host that is no Python program: it ends well, keeps its Ctrl-C, and hears what is missing."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from evcosim.fmus.build import build_model, built, names
from support.needs import need_c_compiler

SOURCE = Path(__file__).parents[1] / "support" / "sources" / "host.c"
SITES = os.pathsep.join(path for path in sys.path if path.endswith("site-packages"))
Host = Callable[..., subprocess.CompletedProcess[str]]


def python_library() -> Path:
    """Return the shared library of this Python, which a host loads."""
    folder, file = (str(sysconfig.get_config_var(name)) for name in ("LIBDIR", "LDLIBRARY"))
    library = Path(folder) / file
    if sys.platform != "linux" or ".so" not in file or not library.is_file():
        pytest.skip(f"this Python has no shared library for Linux that a host could load ({file})")
    return library


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Host:
    """Run an FMU (of the catalog) in the host; `first` is a folder that Python looks into first."""
    need_c_compiler()
    library, folder = python_library(), tmp_path_factory.mktemp("host")
    subprocess.run(["cc", "-O1", "-o", folder / "host", SOURCE, "-ldl", "-lm"], check=True)

    def run(
        name: str, *ways: str, first: Path | None = None, fmu: Path | None = None
    ) -> subprocess.CompletedProcess[str]:
        place = folder / name if fmu is None else fmu.with_suffix("")
        if not place.is_dir():
            with zipfile.ZipFile(fmu or built(name)) as archive:
                archive.extractall(place)
        found = re.search(r'guid="(.*?)"', (place / "modelDescription.xml").read_text())
        assert found is not None
        searched = SITES if first is None else f"{first}{os.pathsep}{SITES}"
        binary = place / "binaries" / "linux64" / f"{name}.so"
        command = [folder / "host", library, binary, found[1], f"file://{place}/resources", name, *ways]
        environment = os.environ | {"PYTHONHOME": sys.base_prefix, "PYTHONPATH": searched}
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)

    return run


@pytest.mark.parametrize("name", names())
def test_the_process_ends_without_a_word(host: Host, name: str) -> None:
    for _ in range(2):
        done = host(name, "run", "run")
        assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


@pytest.mark.parametrize("ways", [("close",), ("close", "run"), ("run", "close", "close")])
def test_a_library_that_is_unloaded_ends_well_too(host: Host, ways: tuple[str, ...]) -> None:
    for name in ("LateralVehicle", "LaneKeepingController"):
        done = host(name, *ways)
        assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


@pytest.mark.parametrize("way", ["zero", "negative", "nan", "ended"])
def test_a_step_that_is_none_is_refused_with_an_error_in_the_log(host: Host, way: str) -> None:
    rule = "it was terminated" if way == "ended" else "it must be finite and longer than 0"
    done = host("Battery", way)
    assert re.fullmatch(rf"log 3 fmi2DoStep at t = 0\.1 s: .*{rule}\nstatus 2\ndone\n", done.stdout)
    assert (done.returncode, done.stderr) == (0, "")


def test_ctrl_c_is_the_hosts(host: Host) -> None:
    assert host("Battery", "interrupt").returncode == -2  # the system's default ends the process
    done = host("Battery", "handled")
    assert (done.returncode, done.stdout, done.stderr) == (0, "the host's own handler\ndone\n", "")


def test_an_older_python_is_named_in_the_log(host: Host, tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text("import sys; sys.version_info = (3, 8, 10)")
    done = host("Battery", "run", first=tmp_path)
    assert done.returncode == 4
    assert "Battery.fmu needs Python 3.11 or newer; this importer runs Python 3.8.10 in " in done.stdout
    assert "not instantiated" in done.stdout


def without(packages: tuple[str, ...], folder: Path) -> Path:
    """Write into a folder what takes packages away from every Python that starts with it."""
    code = "".join(f"import sys; sys.modules['{package}'] = None\n" for package in packages)
    (folder / "sitecustomize.py").write_text(code)
    return folder


@pytest.mark.parametrize("name", ["LateralVehicle", "LaneKeepingController"])
def test_our_fmus_need_no_package(host: Host, tmp_path: Path, name: str) -> None:
    done = host(name, "run", first=without(("numpy", "scipy"), tmp_path))
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


OF_ONES_OWN = """
from __future__ import annotations

import numpy as np

from evcosim.models.base import Model, record, var


class Needy(Model):
    \"\"\"A model that needs numpy.\"\"\"

    @record
    class Parameters:
        pass

    @record
    class Inputs:
        pass

    @record
    class State:
        value: float = var(0.0, "", "A number")

    @record
    class Outputs:
        value: float = var(0.0, "", "A number, shown")

    @staticmethod
    def initial(p: Needy.Parameters, u: Needy.Inputs) -> Needy.State:
        return Needy.State()

    @staticmethod
    def step(p: Needy.Parameters, x: Needy.State, u: Needy.Inputs, dt: float) -> Needy.State:
        return Needy.State(float(np.add(x.value, 1.0)))

    @staticmethod
    def outputs(p: Needy.Parameters, x: Needy.State) -> Needy.Outputs:
        return Needy.Outputs(x.value)
"""


@pytest.mark.parametrize("missing", ["numpy", "scipy"])
def test_a_missing_package_is_named_in_the_log(
    host: Host, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, missing: str
) -> None:
    name = f"needy_{missing}"
    source = OF_ONES_OWN if missing == "numpy" else OF_ONES_OWN.replace("numpy as np", "numpy as np, scipy")
    (tmp_path / f"{name}.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    fmu = build_model(importlib.import_module(name).Needy, tmp_path)
    done = host("Needy", "run", first=without((missing,), tmp_path), fmu=fmu)
    assert done.returncode == 4
    assert "Needy.fmu needs a Python package that Python 3." in done.stdout
    assert f"import of {missing} halted" in done.stdout
