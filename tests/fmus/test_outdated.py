"""An FMU is outdated when a Python file that it carries is another one now, and by nothing else."""

from __future__ import annotations

import hashlib
import os
import shutil

import pytest

from evcosim.fmus.build import build
from evcosim.fmus.from_file import build_file
from evcosim.fmus.outdated import carried_model, changed_source

from .test_from_file import TWICE


@pytest.fixture
def fmu(tmp_path):
    (tmp_path / "my_scale.py").write_text("import math\nSCALE = 2.0\n", encoding="utf-8")
    (tmp_path / "my_twice.py").write_text(TWICE, encoding="utf-8")
    (made,) = build_file(tmp_path / "my_twice.py")
    return made


def changed(fmu):
    found = changed_source(fmu, hashlib.sha256(fmu.read_bytes()).hexdigest())
    return found and tuple(path.name for path in found)


@pytest.mark.parametrize("name", ["my_twice.py", "my_scale.py"])
def test_a_change_of_the_model_or_of_what_it_imports(fmu, name):
    """The text counts: a date is new in each clone."""
    assert carried_model(fmu) == "my_twice"
    assert changed(fmu) is None
    file = fmu.with_name(name)
    os.utime(file, (2e9, 2e9))
    assert changed(fmu) is None
    before = file.read_text(encoding="utf-8")
    for text in (before + "# another\n", "no ( python\n"):
        file.write_text(text, encoding="utf-8")
        assert changed(fmu) == (name, "my_twice.py")
    file.write_text(before, encoding="utf-8")
    assert changed(fmu) is None


def test_an_fmu_that_was_built_elsewhere_or_was_moved_with_its_model(fmu, tmp_path):
    for folder in ("there", "moved"):
        (tmp_path / folder).mkdir()
    (elsewhere,) = build_file(tmp_path / "my_twice.py", tmp_path / "there")
    moved = shutil.copy(fmu, tmp_path / "moved")
    for name in ("my_twice.py", "my_scale.py"):
        shutil.copy(tmp_path / name, tmp_path / "moved")
    (tmp_path / "my_twice.py").write_text(TWICE + "# another\n", encoding="utf-8")
    assert changed(elsewhere) == ("my_twice.py", "my_twice.py")
    assert changed_source(tmp_path / "moved" / "Twice.fmu", "0" * 64) is None  # as beside it
    assert carried_model(elsewhere) == carried_model(tmp_path / moved) == "my_twice"
    (tmp_path / "my_twice.py").unlink()
    assert changed(elsewhere) is None


def test_what_is_no_fmu_of_a_file(tmp_path):
    built_in = build("Battery", tmp_path)
    broken = tmp_path / "broken.fmu"
    broken.write_bytes(built_in.read_bytes()[:1000])
    for file in (built_in, broken, tmp_path / "none.fmu"):
        assert changed_source(file, "") is None
    assert carried_model(broken) == carried_model(tmp_path / "none.fmu") == ""
