"""FMUs of other tools: Modelica compiled by rumoca, and what the package gemseo-fmu ships."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from support.needs import give_up, need_c_compiler

EXAMPLES = Path(__file__).parents[2] / "examples" / "modelica"
SHIPPED = "gemseo-fmu==3.1.1"


@pytest.fixture(scope="session")
def modelica(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str], Path]:
    """(model, "fmi2" or "fmi3") -> its swap file of examples/modelica, copied beside the FMU just made."""
    need_c_compiler()
    spec = importlib.util.spec_from_file_location("compile_modelica", EXAMPLES / "compile.py")
    assert spec is not None and spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    made: dict[tuple[str, str], Path] = {}

    def swap(model: str, target: str = "fmi2") -> Path:
        if (model, target) not in made:
            folder = tmp_path_factory.mktemp(f"{model}-{target}")
            script.compiled(EXAMPLES / f"{model}.mo", folder, target)
            shutil.copy(EXAMPLES / f"{model.lower()}.toml", folder)
            made[model, target] = folder / f"{model.lower()}.toml"
        return made[model, target]

    return swap


@pytest.fixture(scope="session")
def shipped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of Linux FMUs in the wheel of gemseo-fmu.

    It pins an old FMPy, so it cannot be installed beside evcosim: its wheel alone is downloaded and unpacked.
    """
    folder = tmp_path_factory.mktemp("gemseo-fmu")
    command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "-d", str(folder), SHIPPED]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        give_up(f"{SHIPPED} cannot be downloaded: {done.stderr.strip()[-300:]}")
    with zipfile.ZipFile(next(folder.glob("*.whl"))) as wheel:
        names = [n for n in wheel.namelist() if "/fmu_files/linux/" in n and n.endswith(".fmu")]
        for name in names:
            (folder / Path(name).name).write_bytes(wheel.read(name))
    return folder
