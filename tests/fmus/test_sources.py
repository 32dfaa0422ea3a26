"""Which files are embedded, and that they run under the FMU's own name."""

from __future__ import annotations

import importlib
import subprocess
import sys

import fmpy
import pytest

from evcosim.fmus.build import build_model
from evcosim.fmus.sources import collect

MODEL = """
    @record
    class Parameters:
        scale: float = var(1.0, "", "Scale")

    @record
    class Inputs:
        u: float = var(1.0, "", "Input")

    @record
    class State:
        x: float = var(0.0, "", "State")

    @record
    class Outputs:
        y: float = var(0.0, "", "Output")

    @staticmethod
    def initial(p, u):
        return Truck.State(VALUE)

    @staticmethod
    def step(p, x, u, dt):
        return x

    @staticmethod
    def outputs(p, x):
        return Truck.Outputs(x.x)
"""
HEAD = "from evcosim.models.base import Model, record, var\n"


@pytest.fixture
def project(tmp_path, monkeypatch):
    """Write files into a folder that modules are imported from; forget the modules afterwards."""
    monkeypatch.syspath_prepend(tmp_path)

    def write(files):
        for name, content in files.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content)
            monkeypatch.delitem(sys.modules, name.removesuffix(".py").replace("/", "."), raising=False)
        importlib.invalidate_caches()
        return tmp_path

    before = set(sys.modules)
    yield write
    for name in set(sys.modules) - before:
        if str(tmp_path) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


def runs(path, folder, wall):
    """The output of an FMU in a process that cannot import the model's own modules."""
    script = f"""
import sys
class Wall:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {wall!r}:
            raise ModuleNotFoundError(f"{{name}} is behind the wall")
sys.meta_path.insert(0, Wall())
import fmpy
print(fmpy.simulate_fmu({str(path)!r}, stop_time=0.1)["y"][-1])
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=folder, timeout=60
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return float(done.stdout)


PACKAGE = {
    "yard/__init__.py": "",
    "yard/parts/__init__.py": "from .wheels import WHEELS\n",
    "yard/parts/wheels.py": "WHEELS = 4\n",
    "yard/loads.py": "from yard.parts import wheels as w; LOAD = 10 * w.WHEELS\n",
    "yard/unused.py": "1/0\n",
    "yard/truck.py": "from __future__ import annotations\n"
    "from typing import TYPE_CHECKING\n"
    + HEAD
    + "from . import loads\n"
    + "from .parts import WHEELS\n"
    + "import yard.loads as same\n"
    + "if TYPE_CHECKING:\n    from .unused import nothing\n"
    + "VALUE = float(loads.LOAD + WHEELS + same.LOAD)\n"
    + "class Truck(Model):\n"
    + MODEL,
}
NAMESPACE = {  # no __init__.py
    "garage/loads.py": "LOAD = 3\n",
    "garage/truck.py": "from evcosim.models import base\nfrom evcosim import models\n"
    + HEAD
    + "from garage import loads\n"
    + "VALUE = float(loads.LOAD) if models and base.Model is Model else 0.0\n"
    + "class Truck(Model):\n"
    + MODEL,
}
SINGLE = {
    "axle.py": "import math, load_of_axle\nAXLE = math.floor(2.5) + load_of_axle.LOAD\n",
    "load_of_axle.py": "LOAD = 7\n",
    "truck.py": HEAD
    + "import axle\nfrom axle import AXLE as again\n"
    + "VALUE = float(axle.AXLE + again)\nclass Truck(Model):\n"
    + MODEL
    + "if __name__ == '__main__':\n"
    + "    from evcosim.fmus.build import build_model\n    build_model(Truck, '.')\n",
}


@pytest.mark.parametrize(
    ("files", "module", "own", "value"),
    [
        (
            PACKAGE,
            "yard.truck",
            {"yard", "yard.loads", "yard.parts", "yard.parts.wheels", "yard.truck"},
            84.0,
        ),
        (NAMESPACE, "garage.truck", {"garage.loads", "garage.truck"}, 3.0),
        (SINGLE, "truck", {"axle", "load_of_axle", "truck"}, 18.0),
    ],
)
def test_a_users_own_modules_go_with_the_model(project, files, module, own, value):
    folder = project(files)
    file = folder / (module.replace(".", "/") + ".py")
    assert {s.module for s in collect(module, file)} == own | {
        "evcosim.fmus",
        "evcosim.fmus.interface",
        "evcosim.fmus.accessors",
        "evcosim.fmus.messages",
        "evcosim.fmus.repairs",
        "evcosim.fmus.slave",
        "evcosim.fmus.snapshot",
        "evcosim.models",
        "evcosim.models.base",
    }
    path = build_model(importlib.import_module(module).Truck, folder / "out")
    assert runs(path, "/", ("evcosim", "yard", "garage", "truck", "axle", "load_of_axle")) == value


def test_a_script_builds_its_own_model(project):
    folder = project(SINGLE)
    subprocess.run([sys.executable, "truck.py"], check=True, cwd=folder, timeout=60)
    assert fmpy.read_model_description(folder / "Truck.fmu").modelName == "Truck"
    assert runs(folder / "Truck.fmu", "/", ("evcosim", "truck", "axle", "load_of_axle")) == 18.0


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "from evcosim.cosim import units\n",
            "an FMU carries no evcosim.cosim; a model imports evcosim.models",
        ),
        ("import evcosim.models.base\n", r"truck.py:1: write 'from evcosim.models import base' instead of"),
        ("import evcosim\n", "truck.py:1: import the modules of evcosim by name"),
        (
            "from \\\n  evcosim.models.base import var\n",
            "truck.py:1: write 'from evcosim.models.base import' on",
        ),
    ],
)
def test_an_import_that_cannot_be_embedded_is_refused_by_line(project, line, message):
    folder = project({"truck.py": line + HEAD + "VALUE = 0.0\nclass Truck(Model):\n" + MODEL})
    module = importlib.import_module("truck")
    with pytest.raises(ValueError, match=message):
        build_model(module.Truck, folder)


def test_a_model_inside_a_function_is_refused(project, tmp_path):
    project(
        {
            "truck.py": HEAD
            + "VALUE = 0.0\ndef make():\n    class Truck(Model):\n        pass\n    return Truck\n"
        }
    )

    class Local:
        pass

    with pytest.raises(ValueError, match="an FMU is built from a class at the top of its module"):
        build_model(Local, tmp_path)
