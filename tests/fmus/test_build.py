"""Building: reproducible, self-contained, cached."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest

from evcosim.fmus import build as building
from evcosim.fmus import cache, recipes
from evcosim.fmus.build import build, build_model, built, names
from evcosim.fmus.catalog import CATALOG, text
from evcosim.fmus.description import headline

MODEL = """
from evcosim.models.base import Model, record, var


class Thing(Model):
    "A thing."

    @record
    class Parameters:
        scale: float = var(1.0, "{unit}", "Scale")

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
        return Thing.State(0.0)

    @staticmethod
    def step(p, x, u, dt):
        return Thing.State(x.x + {constant})

    @staticmethod
    def outputs(p, x):
        return Thing.Outputs(x.x)
"""


@pytest.fixture
def thing(tmp_path, monkeypatch):
    """Load a version of the model Thing from a file of its own."""

    def load(constant, name="thing", unit="", before=""):
        folder = tmp_path / f"{name}_{constant}"
        folder.mkdir()
        file = folder / f"{name}.py"
        file.write_text(before + MODEL.format(constant=constant, unit=unit))
        spec = importlib.util.spec_from_file_location(name, file)
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, module)
        spec.loader.exec_module(module)
        return module.Thing

    return load


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    """An empty cache of the test's own."""
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.mark.parametrize("name", names())
def test_two_builds_are_the_same_bytes(name, tmp_path):
    first = build(name, tmp_path / "one").read_bytes()
    script = f"from evcosim.fmus.build import build; build({name!r}, {str(tmp_path / 'two')!r})"
    environment = {**os.environ, "PYTHONHASHSEED": "12345", "TZ": "Asia/Tokyo"}
    subprocess.run([sys.executable, "-c", script], check=True, env=environment, cwd=tmp_path)
    assert (tmp_path / "two" / f"{name}.fmu").read_bytes() == first


def test_two_versions_in_one_process_run_each_its_own_code(thing, tmp_path, load):
    paths = [build_model(thing(constant), tmp_path / f"built{constant}") for constant in (1.0, 10.0)]
    units = [load(path) for path in paths]
    for unit in units:
        unit.initialize()
    assert [unit.run([{}, {}])[-1] for unit in units] == [{"y": 2.0}, {"y": 20.0}]
    assert len({unit.description.guid for unit in units}) == 2


def test_the_archive_holds_what_is_needed_and_nothing_else(tmp_path):
    with zipfile.ZipFile(build("Battery", tmp_path)) as archive:
        files = archive.namelist()
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        package = archive.read("resources/slavemodule.txt").decode().removesuffix("_slave\n")
    carried = [f.removeprefix(f"resources/{package}/evcosim/") for f in files if "/evcosim/" in f]
    assert sorted(carried) == [
        "__init__.py",
        "fmus/__init__.py",
        "fmus/accessors.py",
        "fmus/interface.py",
        "fmus/messages.py",
        "fmus/repairs.py",
        "fmus/slave.py",
        "fmus/snapshot.py",
        "models/__init__.py",
        "models/base.py",
        "models/battery.py",
        "models/constants.py",
    ]
    assert {f for f in files if not f.startswith("resources/")} == {
        "modelDescription.xml",
        "binaries/linux64/Battery.so",
        "binaries/win64/Battery.dll",
        "documentation/licenses/evcosim.txt",
        "documentation/licenses/pythonfmu.txt",
    }


def test_an_unknown_name_is_refused_with_the_nearest(tmp_path):
    with pytest.raises(ValueError, match=r"no built-in FMU 'battery' \(did you mean 'Battery'\?\)"):
        build("battery", tmp_path)


def test_an_unknown_unit_names_model_and_variable(thing, tmp_path):
    with pytest.raises(ValueError, match=r"^Thing\.scale: unit 'furlong/h': 'furlong' is no unit symbol"):
        build_model(thing(1.0, unit="furlong/h"), tmp_path)


def test_a_version_and_a_license_of_ones_own(thing, tmp_path):
    path = build_model(thing(1.0), tmp_path, version="2.1", license="Apache-2.0")
    description = fmpy.read_model_description(path)
    assert (description.version, description.license) == ("2.1", "Apache-2.0")
    assert fmpy.read_model_description(build_model(thing(2.0), tmp_path)).license is None


def test_a_second_run_builds_nothing(own_cache, monkeypatch):
    first = built("Battery")
    assert first.parent == own_cache
    assert first.stem.startswith("Battery_")

    def fail(*_):
        raise AssertionError("built again")

    monkeypatch.setattr(building, "_content", fail)
    assert built("Battery") == first


def test_a_kept_identity_is_that_of_the_recipe(own_cache, monkeypatch):
    """It is found without following imports, made anew where it is damaged, and another for another model."""
    monkeypatch.setattr(recipes, "_found", {})
    expected = built("Battery").stem
    (entry,) = own_cache.glob("digests-*")
    followed = []
    collect = recipes.collect
    monkeypatch.setattr(recipes, "collect", lambda *given: followed.append(given) or collect(*given))
    for content, count in ((entry.read_bytes(), 0), (b"", 1), (b"\n", 1), (entry.read_bytes()[:-1], 1)):
        monkeypatch.setattr(recipes, "_found", {})
        entry.write_bytes(content)
        followed.clear()
        assert built("Battery").stem == expected
        assert len(followed) == count
    other = f"Scooter {'0' * 32} {'1' * 32}".encode()
    assert cache.keep(entry.name, other) == ""  # whole, and of another model
    monkeypatch.setattr(recipes, "_found", {})
    assert built("Battery").stem == expected


def test_a_model_that_is_written_is_read_again(tmp_path, monkeypatch):
    (tmp_path / "model.py").write_text("a = 1")
    first = recipes._models(tmp_path)
    (tmp_path / "model.py").write_text("a = 2")  # within the same tick of the file system's clock
    second = recipes._models(tmp_path)
    monkeypatch.setattr(cache, "_JUST_NOW", -1)
    assert recipes._models(tmp_path) == second != first
    (tmp_path / "model.py").write_text("a = 10")
    assert len({first, second, recipes._models(tmp_path)}) == 3
    (tmp_path / "other.py").write_text("")
    assert len({first, second, recipes._models(tmp_path)}) == 3


@pytest.mark.parametrize("changed", sorted(file.name for file in recipes._HERE.glob("*.py")))
def test_another_builder_is_another_file_in_the_cache(changed, own_cache, tmp_path, monkeypatch):
    first = built("Battery")
    for folder, line, equal in (("copy", "", True), ("other", "# another line\n", False)):
        shutil.copytree(recipes._HERE, tmp_path / folder)
        with (tmp_path / folder / changed).open("a") as file:
            file.write(line)
        monkeypatch.setattr(recipes, "_HERE", tmp_path / folder)
        assert (built("Battery") == first) is equal


def test_another_source_is_another_file_in_the_cache(own_cache, monkeypatch):
    first = built("Battery")
    entry = CATALOG["Battery"]
    changed = entry._replace(experiment=entry.experiment._replace(stop_time=61.0))
    monkeypatch.setitem(CATALOG, "Battery", changed)
    assert built("Battery") != first


def test_a_cache_that_cannot_be_written_is_replaced_with_one_line(tmp_path, monkeypatch, capsys):
    blocked = tmp_path / "file"
    blocked.write_text("a file where a folder should be")
    monkeypatch.setenv("EVCOSIM_CACHE", str(blocked))
    paths = {built("Battery"), built("Battery")}
    assert len(paths) == 1
    assert fmpy.read_model_description(paths.pop()).modelName == "Battery"
    assert capsys.readouterr().err.count(f"cannot use the cache folder {blocked}") == 1


def test_four_processes_may_build_at_once(own_cache):
    script = "from evcosim.fmus.build import built; print(built('Battery'))"
    running = [
        subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) for _ in range(4)
    ]
    printed = [process.communicate(timeout=60)[0] for process in running]
    assert [process.returncode for process in running] == [0] * 4
    assert len(set(printed)) == 1
    identity = Path(printed[0].strip()).stem
    kept = {file.name for file in own_cache.iterdir()}
    assert {name for name in kept if not name.startswith("digests-Battery-")} == {
        f"{identity}.fmu",
        f"{identity}.fmu.sha256",
    }
    assert len(kept) == 3


@pytest.mark.parametrize(
    ("platform", "variable", "expected"),
    [
        ("linux", "XDG_CACHE_HOME", "evcosim"),
        ("win32", "LOCALAPPDATA", "evcosim"),
        ("any", "EVCOSIM_CACHE", ""),
    ],
)
def test_the_cache_folder_follows_the_platform(platform, variable, expected, tmp_path, monkeypatch):
    monkeypatch.delenv("EVCOSIM_CACHE", raising=False)
    monkeypatch.setattr(sys, "platform", platform)
    monkeypatch.setenv(variable, str(tmp_path))
    assert cache.folder() == tmp_path / expected


def test_names_and_texts_import_no_model(tmp_path):
    script = """
import sys
from evcosim.fmus.build import names
from evcosim.fmus.catalog import text
assert all(text(name) for name in names())
heavy = {"numpy", "scipy", "fmpy", "lxml", "pythonfmu", "evcosim.models.base"} & set(sys.modules)
assert not heavy, heavy
"""
    subprocess.run([sys.executable, "-c", script], check=True, cwd=tmp_path)


@pytest.mark.parametrize("name", names())
def test_the_text_read_without_importing_is_the_one_in_the_description(name):
    module = importlib.import_module(f"evcosim.models.{CATALOG[name].module}")
    assert text(name) == headline(getattr(module, name))


def test_finding_all_built_fmus_reads_our_own_code_once(own_cache):
    recipes.own_code.cache_clear()
    for name in names() * 2:
        built(name)
    folders = recipes.own_code.cache_info().currsize
    assert recipes.own_code.cache_info().misses == folders <= 2
