"""FMUs of other tools: Modelica compiled by rumoca, and what the package gemseo-fmu ships."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples" / "modelica"
SHIPPED = "gemseo-fmu==3.1.1"


def _give_up(reason: str) -> None:
    """Skip for want of a tool or a network; fail where CI says that it has them."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(reason)


@pytest.fixture(scope="session")
def modelica(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str], Path]:
    """(model, "fmi2" or "fmi3") -> its swap file of examples/modelica, copied beside the FMU just made."""
    if shutil.which("cc") is None:
        _give_up("there is no C compiler (cc)")
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
        _give_up(f"{SHIPPED} cannot be downloaded: {done.stderr.strip()[-300:]}")
    with zipfile.ZipFile(next(folder.glob("*.whl"))) as wheel:
        names = [n for n in wheel.namelist() if "/fmu_files/linux/" in n and n.endswith(".fmu")]
        for name in names:
            (folder / Path(name).name).write_bytes(wheel.read(name))
    return folder
