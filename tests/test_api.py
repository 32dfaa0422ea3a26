"""The public face: what `from evcosim import ...` gives, how little `import evcosim` loads, and its types."""

from __future__ import annotations

import ast
import importlib
import importlib.metadata
import importlib.util
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import evcosim
from support.needs import give_up

ROOT = Path(__file__).parents[1]
FACE = ROOT / "api" / "__init__.py"
NAMES = [name for name in evcosim.__all__ if name != "__version__"]


def for_type_checkers() -> dict[str, str]:
    """Name to module of the imports below `if TYPE_CHECKING`."""
    tree = ast.parse(FACE.read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    imports = [node for node in block.body if isinstance(node, ast.ImportFrom)]
    assert all(node.level == 1 for node in imports)
    return {alias.name: str(node.module) for node in imports for alias in node.names}


def test_the_three_lists_of_names_agree():
    assert evcosim.__all__ == sorted(evcosim.__all__)
    assert sorted(evcosim._MODULES) == NAMES
    assert for_type_checkers() == evcosim._MODULES


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_the_one_of_its_module(name):
    module = f"evcosim.{evcosim._MODULES[name]}"
    found = getattr(evcosim, name)
    assert found is getattr(importlib.import_module(module), name)
    if inspect.isclass(found) or inspect.isfunction(found):  # others stand for types of other libraries
        assert found.__module__ == module


def test_names_that_there_are_and_others():
    assert dir(evcosim) == evcosim.__all__
    assert evcosim.__version__ == importlib.metadata.version("evcosim")
    with pytest.raises(AttributeError, match="module 'evcosim' has no attribute 'simulation'"):
        evcosim.simulation  # noqa: B018 - the look-up is what is tested
    with pytest.raises(ImportError, match="cannot import name 'simulation' from 'evcosim'"):
        from evcosim import simulation  # noqa: F401 - as above
    everything: dict[str, object] = {}
    exec("from evcosim import *", everything)
    assert evcosim.__all__ == sorted(everything.keys() - {"__builtins__"})


def test_importing_it_loads_nothing_else():
    code = "import sys; before = set(sys.modules); import evcosim; print(*set(sys.modules) - before)"
    loaded = set(run(code).split())
    assert {name for name in loaded if name.startswith("evcosim")} == {"evcosim"}
    heavy = {
        "numpy",
        "scipy",
        "pydantic",
        "fmpy",
        "pythonfmu",
        "cantools",
        "can",
        "numba",
        "typer",
        "inspect",
    }
    assert not heavy & loaded


def run(code: str, *options: str, folder: Path = ROOT) -> str:
    """Return the output of a program that runs in the clone, as a user's does."""
    call = [sys.executable, *options, *(["-c", code] if code else [])]
    return subprocess.run(call, capture_output=True, text=True, check=True, cwd=folder).stdout


def test_it_is_imported_inside_the_clone():
    """No folder of the project has the package's name, which would hide it there."""
    assert not (ROOT / "evcosim").exists()
    assert run("from evcosim import simulate; print(simulate.__module__)") == "evcosim.master.simulation\n"


def test_the_package_is_the_command():
    assert run("", "-m", "evcosim", "--version") == f"evcosim {evcosim.__version__}\n"


# ---- types, as a user's mypy sees them

SCRIPT = """\
from evcosim import Simulation, Task, budget, identify, load_scenario, load_system, run_all, simulate

results = simulate("scooter")
reveal_type(results)
reveal_type(results["vehicle.speed"])
reveal_type(Simulation("scooter", ideal=True).results)
reveal_type(load_scenario(load_system("scooter")))
reveal_type(budget("scooter"))
reveal_type(identify("scooter"))
reveal_type(run_all([Task("one", simulate, ("scooter",))]))
simulate("scooter", idael=True)
"""
TYPES = [
    "evcosim.cosim.results.results.Results",
    "numpy.ndarray[tuple[Any, ...], numpy.dtype[Any]]",
    "evcosim.cosim.results.results.Results",
    "evcosim.cosim.system.scenario.Scenario",
    "evcosim.cosim.analysis.bus_budget.Budget",
    "evcosim.master.studies.identification.Identification",
    "list[evcosim.master.studies.parallel.Outcome[evcosim.cosim.results.results.Results]]",
]


def test_a_users_mypy_knows_the_types(mypy_said):
    """The links in .typing stand for an installation; .ci/run does it with that of the wheel."""
    said = mypy_said["user.py"]
    assert re.findall(r'Revealed type is "(.*)"', said) == TYPES, said
    assert re.findall(r"^user.py:(\d+): error: .*idael", said, re.MULTILINE) == ["11"]
    assert said.count("error:") == 1


MISSPELLED = """\
import evcosim
from evcosim import simulat

evcosim.Simulatoin("scooter")
reveal_type(evcosim.__version__)
"""


def test_a_users_mypy_refuses_a_misspelled_name(mypy_said):
    said = mypy_said["misspelled.py"]
    begin = r"^misspelled.py:(\d+): error: Module "
    assert re.findall(begin + r'"?evcosim"? has no attribute', said, re.MULTILINE) == ["2"], said
    assert re.findall(begin + r'has no attribute "Simulatoin"', said, re.MULTILINE) == ["4"], said
    assert said.count("error:") == 2
    assert 'Revealed type is "str"' in said or 'Revealed type is "builtins.str"' in said


@pytest.fixture(scope="module")
def mypy_said(tmp_path_factory):
    """What mypy says of each of a user's scripts, all of which it checks at once."""
    if importlib.util.find_spec("mypy") is None:
        give_up("mypy is not installed")
    folder, scripts = tmp_path_factory.mktemp("user"), {"user.py": SCRIPT, "misspelled.py": MISSPELLED}
    for name, script in scripts.items():
        (folder / name).write_text(script)
    call = [sys.executable, "-m", "mypy", "--follow-imports=silent", f"--cache-dir={folder}", *scripts]
    environment = os.environ | {"MYPYPATH": str(ROOT / ".typing")}
    done = subprocess.run(call, capture_output=True, text=True, cwd=folder, env=environment)
    assert not done.stderr, done.stderr
    lines = done.stdout.splitlines()
    return {name: "\n".join(line for line in lines if line.startswith(f"{name}:")) for name in scripts}
