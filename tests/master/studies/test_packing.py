"""Tasks of a notebook: what no worker could import is refused with what to do, the rest runs."""

from __future__ import annotations

import subprocess
import sys

import pytest

from evcosim.master.studies.packing import packed

# as a notebook: a main module that no file holds
CELLS = """
import dataclasses, functools, pathlib
from evcosim import Task, run_all

def speed(mass): return mass

@dataclasses.dataclass
class Car:
    mass: float

refused = [Task("a", speed, (1,)), Task("b", functools.partial(speed, 1)), Task("c", len, ([Car(1.0)],))]
refused += [Task("d", Car, (1.0,)), Task("e", lambda: 1)]
for task in refused:
    try:
        run_all([Task("good", abs, (-1,)), task])
    except TypeError as error:
        print(error)
pathlib.Path("own_tasks.py").write_text("def speed(mass): return 2 * mass")
from own_tasks import speed
print([outcome.result() for outcome in run_all([Task("a", speed, (21,))])])
"""
WHAT_TO_DO = (
    "{} is defined in a notebook or at a prompt, from where the processes that do the tasks cannot import "
    "it: write it into a file beside, as tasks.py, with the imports that it needs, and take it from there: "
    "from tasks import {}"
)


@pytest.mark.parametrize("given", ["by -c", "on stdin"])  # the latter calls its file "<stdin>"
def test_a_function_of_a_notebook_is_refused_with_what_to_do(tmp_path, given):
    call, cells = ([sys.executable, "-c", CELLS], "") if given == "by -c" else ([sys.executable, "-"], CELLS)
    done = subprocess.run(call, input=cells, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    a, b, c, d, e, results = done.stdout.splitlines()
    named = {"a": (a, "speed"), "b": (b, "speed"), "c": (c, "Car"), "d": (d, "Car")}
    for task, (line, name) in named.items():
        assert line == f"task '{task}': {WHAT_TO_DO.format(name, name)}"
    assert e.startswith("task 'e' cannot be sent to a process: ")
    assert "lambda" in e
    assert results == "[42]"


def test_a_script_sends_its_own_functions(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from evcosim.master.studies.packing import main_is_a_file, packed\n"
        "def square(x):\n    return x * x\n"
        "print(main_is_a_file(), bool(packed(square, 'square')))\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("True True\n", "")


def test_what_cannot_be_pickled_is_named_by_its_task():
    with pytest.raises(TypeError, match=r"^task 'open' cannot be sent to a process: "):
        packed(sys.stdout.buffer, "open")
