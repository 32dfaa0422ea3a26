"""An FMU is outdated when a Python file that it carries is another one now, and by nothing else."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import zipfile

import pytest

from evcosim.fmus.build import build
from evcosim.fmus.from_file import build_wanted
from evcosim.fmus.native.wanted import Wanted
from evcosim.fmus.outdated import changed_source, model_files
from support.compiled_once import compiled_once as compiled_once
from support.needs import need_c_compiler

from .test_from_file import TWICE

pytestmark = pytest.mark.usefixtures("compiled_once")

KINDS = {
    "python": (None, ""),
    "native": (Wanted(True), " --native"),
    "3": (Wanted(True, (), 3), " --native --fmi 3"),
}


@pytest.fixture(params=KINDS)
def kind(request):
    if request.param != "python":
        need_c_compiler()
    return request.param


def built(file, kind, folder=None):
    ((made, left),) = build_wanted(file, folder, KINDS[kind][0])
    assert left == ""
    return made


@pytest.fixture
def fmu(tmp_path, kind):
    (tmp_path / "my_scale.py").write_text("import math\nSCALE = 2.0\n", encoding="utf-8")
    (tmp_path / "my_twice.py").write_text(TWICE, encoding="utf-8")
    return built(tmp_path / "my_twice.py", kind)


def changed(fmu):
    found = changed_source(fmu, hashlib.sha256(fmu.read_bytes()).hexdigest())
    return found and (found.file.name, found.model.name, found.options)


@pytest.mark.parametrize("name", ["my_twice.py", "my_scale.py"])
def test_a_change_of_the_model_or_of_what_it_imports(fmu, name, kind):
    """The text counts: a date is new in each clone."""
    assert model_files(fmu) == [fmu.with_name("my_twice.py").resolve()] * 2  # beside it, where it was made
    assert changed(fmu) is None
    file = fmu.with_name(name)
    os.utime(file, (2e9, 2e9))
    assert changed(fmu) is None
    before = file.read_text(encoding="utf-8")
    for text in (before + "# another\n", "no ( python\n"):
        file.write_text(text, encoding="utf-8")
        assert changed(fmu) == (name, "my_twice.py", KINDS[kind][1])
    file.write_text(before, encoding="utf-8")
    assert changed(fmu) is None


def test_an_fmu_that_was_built_elsewhere_or_was_moved_with_its_model(fmu, tmp_path, kind):
    (tmp_path / "moved").mkdir()
    elsewhere = built(tmp_path / "my_twice.py", kind, tmp_path / "there")
    moved = shutil.copy(fmu, tmp_path / "moved")
    for name in ("my_twice.py", "my_scale.py"):
        shutil.copy(tmp_path / name, tmp_path / "moved")
    model = (tmp_path / "my_twice.py").resolve()
    model.write_text(TWICE + "# another\n", encoding="utf-8")
    assert changed(elsewhere) == ("my_twice.py", "my_twice.py", KINDS[kind][1])
    assert changed_source(tmp_path / "moved" / "Twice.fmu", "0" * 64) is None  # as beside it
    assert model_files(elsewhere) == [model]
    assert model_files(tmp_path / moved) == [(tmp_path / "moved" / "my_twice.py").resolve(), model]
    model.unlink()
    assert changed(elsewhere) is None
    assert model_files(elsewhere) == []


def test_what_is_no_fmu_of_a_file(tmp_path):
    built_in = build("Battery", tmp_path)
    broken = tmp_path / "broken.fmu"
    broken.write_bytes(built_in.read_bytes()[:1000])
    for file in (built_in, broken, tmp_path / "none.fmu"):
        assert changed_source(file, "") is None
        assert model_files(file) == []


@pytest.mark.parametrize(
    "text", ["", "\n", "no digest", "0  \n", "0  ..\n", "0  my_twice.py\x00\n", "\udcff"]
)
def test_names_of_files_that_are_none(text, tmp_path):
    fmu = tmp_path / "Twice.fmu"
    (tmp_path / "my_twice.py").write_text(TWICE, encoding="utf-8")
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.writestr("sources/python_files.txt", text.encode("utf-8", "surrogateescape"))
    assert changed(fmu) is None
    assert model_files(fmu) == []


def test_two_files_with_a_model_of_one_name(tmp_path, kind):
    """Their FMUs would have one name: the second is refused in the folder of the first."""
    where = tmp_path / "there"
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "my_scale.py").write_text("SCALE = 2.0\n", encoding="utf-8")
        (tmp_path / folder / "my_twice.py").write_text(TWICE, encoding="utf-8")
    first = built(tmp_path / "a" / "my_twice.py", kind, where)
    content = first.read_bytes()
    other = (tmp_path / "a" / "my_twice.py").resolve()
    for again in KINDS:
        with pytest.raises(
            ValueError, match=rf"Twice\.fmu is there already, of {re.escape(str(other))}: give"
        ):
            built(tmp_path / "b" / "my_twice.py", again, where)
    assert first.read_bytes() == content
    built(other, kind, where)  # of the same file
    other.unlink()
    built(tmp_path / "b" / "my_twice.py", kind, where)  # it was moved
