"""The parts of an installation: packages, dependencies, version; and the check of the wheel."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from evcosim.fmus.catalog import CATALOG

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
FOLDERS = ("api", "models", "fmus", "cosim", "master")
DISTRIBUTIONS = {"can": "python-can"}  # whose name is not that of the package; the others' names are equal
CHOSEN_BY_ANOTHER = {"llvmlite": "numba"}  # each numba works with one llvmlite, and brings it


def package_of(folder: Path) -> str:
    """The package that stands in a folder of the project."""
    return ".".join(("evcosim", *(part for part in folder.relative_to(ROOT).parts if part != "api")))


def test_every_package_is_listed_with_its_folder():
    folders = [file.parent for top in FOLDERS for file in sorted((ROOT / top).rglob("__init__.py"))]
    listed = PROJECT["tool"]["setuptools"]
    assert sorted(listed["packages"]) == sorted(map(package_of, folders))
    assert listed["package-dir"] == {package_of(f): f.relative_to(ROOT).as_posix() for f in folders}


def third_party(tree: ast.Module) -> Iterator[str]:
    """The packages, neither Python's nor ours, that a module imports anywhere."""
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names = [node.module or ""]
        yield from (top for name in names if (top := name.partition(".")[0]) not in sys.stdlib_module_names)


def test_dependencies_are_what_is_imported():
    imported = {
        name
        for folder in FOLDERS
        for file in (ROOT / folder).rglob("*.py")
        for name in third_party(ast.parse(file.read_text(encoding="utf-8")))
    }
    needed = {DISTRIBUTIONS.get(name, name) for name in imported} - CHOSEN_BY_ANOTHER.keys()
    project = PROJECT["project"]
    extras = project["optional-dependencies"]
    declared, optional = (
        {re.split(r"[<>=!~\[; ]", text)[0] for text in texts}
        for texts in (project["dependencies"], [*extras["data"], *extras["mf4"]])
    )
    # the runtime of a built FMU is copied from pythonfmu's files, which are found without an import
    assert declared | optional == needed | {"pythonfmu"}
    assert not declared & optional


def test_the_version_is_the_same_everywhere():
    version = PROJECT["project"]["version"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(r"^version: (.*)$", citation, re.MULTILINE)[1] == version
    assert re.search(r"^## \[(\d.*)\] - \d{4}-\d\d-\d\d$", changelog, re.MULTILINE)[1] == version


# ---- .ci/check_wheel.py


@pytest.fixture(scope="module")
def check_wheel() -> Any:
    spec = importlib.util.spec_from_file_location("check_wheel", ROOT / ".ci" / "check_wheel.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def contents(check_wheel: Any) -> dict[str, bytes]:
    """The files of a wheel of this project."""
    files = {name: path.read_bytes() for name, path in check_wheel.wanted().items()}
    version = PROJECT["project"]["version"]
    names = ("METADATA", "WHEEL", "RECORD", "entry_points.txt", "top_level.txt", "licenses/LICENSE")
    return files | {f"evcosim-{version}.dist-info/{name}": b"" for name in names}


def test_a_whole_wheel_passes(check_wheel, tmp_path):
    assert {"evcosim/__init__.py", "evcosim/py.typed", "evcosim/cosim/data/can/ev.dbc"} <= contents(
        check_wheel
    ).keys()
    assert found_in(check_wheel, tmp_path, contents(check_wheel)) == []


def found_in(check_wheel: Any, folder: Path, files: dict[str, bytes], platform: str = "any") -> list[str]:
    """Return the defects that the check finds in a wheel of these files for a platform."""
    wheel = folder / f"evcosim-0-py3-none-{platform}.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return check_wheel.problems(wheel)


@pytest.mark.parametrize(
    "name",
    ["evcosim/cosim/left_over.py", "evcosim/old/__init__.py", "models/scooter.py", "benchmarks/case.py"],
)
def test_a_wheel_with_more_fails(check_wheel, tmp_path, name):
    found = found_in(check_wheel, tmp_path, contents(check_wheel) | {name: b""})
    assert found == [f"it has {name}, which no package has"]


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_a_wheel_with_a_stray_file_of_the_clone_fails(check_wheel, tmp_path):
    """A file that git does not track, as an editor or a trial leaves one."""
    clone = tmp_path / "clone"
    for file in ("cosim/__init__.py", "cosim/data/can/ev.dbc", "pyproject.toml"):
        (clone / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / file, clone / file)
    for command in (["init", "-q"], ["add", "."]):
        subprocess.run(["git", *command], cwd=clone, check=True)
    (clone / "cosim" / "stray.py").write_text("")
    names = {"evcosim/cosim/__init__.py", "evcosim/cosim/data/can/ev.dbc"}
    assert check_wheel.wanted(clone).keys() == names
    shutil.rmtree(clone / ".git")  # as in a source distribution
    assert check_wheel.wanted(clone).keys() == names | {"evcosim/cosim/stray.py"}


def test_the_source_distribution_leaves_all_tests_out():
    """setuptools takes tests/test*.py by itself; .ci/run looks into the archive."""
    assert "prune tests" in (ROOT / "MANIFEST.in").read_text().splitlines()


@pytest.mark.parametrize("name", ["evcosim/__main__.py", "evcosim/cosim/data/systems/scooter.toml"])
def test_a_wheel_with_less_or_another_file_fails(check_wheel, tmp_path, name):
    whole = contents(check_wheel)
    without = {key: data for key, data in whole.items() if key != name}
    assert found_in(check_wheel, tmp_path, without) == [f"it lacks {name}"]
    older = whole | {name: b"# an earlier version\n"}
    assert found_in(check_wheel, tmp_path, older) == [f"{name} is not the one of the package"]


@pytest.fixture
def shipped() -> dict[str, bytes]:
    """The libraries of a wheel for a platform, and their record."""
    content = b"a library"
    digest = hashlib.sha256(content).hexdigest()
    keys = [(name, fmi, minor) for name in CATALOG for fmi in (2, 3) for minor in (11, 12, 13, 14)]
    record = {repr(key): (f"{key[0]}_fmi{key[1]}_py311.so", digest) for key in keys}
    files = {file: content for file, _ in record.values()}
    files["record.json"] = json.dumps({"linux64": record}).encode()
    return {f"{SHIPPED}{name}": data for name, data in files.items()}


SHIPPED = "evcosim/fmus/native/shipped/"


def test_a_wheel_for_a_platform_has_the_libraries(check_wheel, tmp_path, shipped):
    whole = contents(check_wheel)
    assert found_in(check_wheel, tmp_path, whole | shipped, "manylinux_2_17_x86_64") == []
    assert found_in(check_wheel, tmp_path, whole, "manylinux_2_17_x86_64") == [
        f"it lacks {SHIPPED}record.json"
    ]
    found = found_in(check_wheel, tmp_path, whole | shipped)  # said to be a pure one
    assert len(found) == len(shipped) and all("which no package has" in text for text in found)


def test_libraries_that_are_not_the_recorded_ones_fail(check_wheel, tmp_path, shipped):
    whole, name = contents(check_wheel) | shipped, f"{SHIPPED}Scooter_fmi2_py311.so"
    changed = found_in(check_wheel, tmp_path, whole | {name: b"another"}, "manylinux_2_17_x86_64")
    assert set(changed) == {f"{name} is not the recorded one"}
    lacking = {key: data for key, data in whole.items() if key != name}
    assert found_in(check_wheel, tmp_path, lacking, "linux_x86_64") == [f"it lacks {name}"]
    more = whole | {f"{SHIPPED}Old_fmi2_py311.so": b""}
    assert found_in(check_wheel, tmp_path, more, "linux_x86_64") == [
        f"it has {SHIPPED}Old_fmi2_py311.so, which no package has"
    ]


def test_a_model_that_is_left_out_of_the_libraries_fails(check_wheel, tmp_path, shipped):
    record = json.loads(shipped[f"{SHIPPED}record.json"])
    left = {key: row for key, row in record["linux64"].items() if not row[0].startswith("Battery_fmi3")}
    files = {name: data for name, data in shipped.items() if "Battery_fmi3" not in name}
    files[f"{SHIPPED}record.json"] = json.dumps({"win64": left}).encode()
    found = found_in(check_wheel, tmp_path, contents(check_wheel) | files, "linux_x86_64")
    assert found == [
        f"{SHIPPED}record.json is of win64",
        f"{SHIPPED}record.json has 4 libraries of Battery, not 8",
    ]


def test_a_wheel_that_is_too_large_fails(check_wheel, tmp_path, monkeypatch):
    monkeypatch.setattr(check_wheel, "_MOST", 1000)
    (said,) = found_in(check_wheel, tmp_path, contents(check_wheel))
    assert re.fullmatch(r"it has \d{6,} bytes, more than 1000", said)
