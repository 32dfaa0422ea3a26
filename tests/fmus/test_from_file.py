"""A Python file with models becomes an FMU for each, and what is wrong with the file is named."""

from __future__ import annotations

import sys

import pytest

from evcosim.fmus.catalog import CATALOG
from evcosim.fmus.from_file import build_file, model_source
from evcosim.fmus.records import is_own

TWICE = """
from evcosim.models.base import Model, record, var
from my_scale import SCALE

class Twice(Model):
    "Two times the input."

    @record
    class Parameters:
        scale: float = var(SCALE, "", "Scale")

    @record
    class Inputs:
        u: float = var(0.0, "", "Input")

    @record
    class State:
        x: float = var(0.0, "", "State")

    @record
    class Outputs:
        y: float = var(0.0, "", "Output")

    @staticmethod
    def initial(p, u):
        return Twice.State()

    @staticmethod
    def step(p, x, u, dt):
        return Twice.State(p.scale * u.u)

    @staticmethod
    def outputs(p, x):
        return Twice.Outputs(x.x)
"""


@pytest.fixture
def file(tmp_path):
    (tmp_path / "my_scale.py").write_text("SCALE = 2.0\n", encoding="utf-8")
    path = tmp_path / "my_twice.py"
    path.write_text(TWICE, encoding="utf-8")
    return path


def test_each_model_of_the_file_is_built_and_nothing_stays_imported(file, tmp_path):
    before = (dict(sys.modules), list(sys.path))
    (made,) = build_file(file)
    assert made == tmp_path / "Twice.fmu"
    assert "my_twice" not in sys.modules and "my_scale" not in sys.modules
    assert sys.path == before[1]
    first = made.read_bytes()
    (tmp_path / "my_scale.py").write_text("SCALE = 3.0\n", encoding="utf-8")
    (tmp_path / "there").mkdir()
    (other,) = build_file(file, tmp_path / "there")
    assert other.read_bytes() != first and made.read_bytes() == first
    assert is_own(__import__("hashlib").sha256(first).hexdigest())


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a_model.py", "x = 1\n", "defines no model: a model derives from"),
        ("a_model.py", "x = 1\nif:\n", "cannot be imported: line 2: invalid syntax"),
        ("a_model.py", "x = 1\n\ny = x / 0\n", "cannot be imported: line 3: ZeroDivisionError"),
        (
            "a_model.py",
            "import there_is_none\n",
            "cannot be imported: line 1: ModuleNotFoundError",
        ),
        ("a-model.py", TWICE, "the name of a Python module is made of letters"),
        ("json.py", TWICE, "Python has a module 'json' already"),
        ("colorsys.py", TWICE.replace("from my_scale import SCALE", "SCALE = 1.0"), None),
    ],
)
def test_what_is_wrong_is_named(tmp_path, name, text, said):
    (tmp_path / name).write_text(text, encoding="utf-8")
    if said is None:  # it comes before a module of Python's that nobody has imported
        assert [path.name for path in build_file(tmp_path / name)] == ["Twice.fmu"]
        return
    with pytest.raises(ValueError, match=said):
        build_file(tmp_path / name)
    assert str(tmp_path) not in sys.path


@pytest.mark.parametrize("name", CATALOG)
def test_the_source_of_a_built_in_model_stands_alone(name):
    file, text = model_source(name)
    assert file == f"{CATALOG[name].module}.py"
    assert "\nfrom ." not in text and f"class {name}(Model)" in text
    assert "from evcosim.models.base import" in text


def test_two_files_with_a_model_of_one_name_do_not_write_over_each_other(file, tmp_path):
    (made,) = build_file(file)
    first = made.read_bytes()
    other = file.with_name("my_other.py")
    other.write_text(TWICE, encoding="utf-8")
    with pytest.raises(ValueError, match=r"Twice\.fmu is there already, of my_twice\.py"):
        build_file(other)
    assert made.read_bytes() == first
    (tmp_path / "there").mkdir()
    build_file(other, tmp_path / "there")
    file.unlink()  # it has got another name
    build_file(other)
    assert made.read_bytes() != first
