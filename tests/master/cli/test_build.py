"""`evcosim build` writes the built-in FMUs."""

from __future__ import annotations

import hashlib
import json
import zipfile
from pathlib import Path

import pytest

from evcosim.fmus.native import toolchain
from support.answers import refused
from support.compiled_once import compiled_once as compiled_once
from support.needs import need_c_compiler


def test_build(evcosim, tmp_path):
    answer = evcosim("build", "Battery", "--output", "made")
    assert answer.out.strip() == "made/Battery.fmu"
    assert zipfile.is_zipfile(tmp_path / "made" / "Battery.fmu")
    cached = evcosim("build", "Battery").out.strip()
    assert (tmp_path / "made" / "Battery.fmu").read_bytes() == Path(cached).read_bytes()


def test_build_needs_a_cache_that_lasts(evcosim, tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("EVCOSIM_CACHE", str(blocked))
    refused(evcosim("build", "Battery"), f"{blocked}: Battery.fmu cannot be kept there", "--output DIR")
    assert evcosim("build", "Battery", "-o", "made").out.strip() == "made/Battery.fmu"


def test_build_repairs_the_cache(evcosim, tmp_path, monkeypatch):
    """Also what was changed together with its digest."""
    monkeypatch.setenv("EVCOSIM_CACHE", str(tmp_path / "cache"))
    path = Path(evcosim("build", "Battery").out.strip())
    whole, other = path.read_bytes(), b"something else"
    path.write_bytes(other)
    record = path.with_name(f"{path.name}.sha256")
    record.write_text(f"{hashlib.sha256(other).hexdigest()}  {path.name}\n")
    assert evcosim("build", "Battery").code == 0
    assert path.read_bytes() == whole


def test_build_of_a_file_of_ones_own(evcosim, tmp_path):
    assert evcosim("new", "car").code == 0
    made = evcosim("build", "car/models/vehicle.py", "-o", "made")
    assert (made.code, made.out.strip()) == (0, "made/Vehicle.fmu")
    (tmp_path / "none.py").write_text("x = 1\n")
    refused(evcosim("build", "none.py"), "none.py: defines no model")
    refused(evcosim("build", "gone.py"), "gone.py: there is no such file")
    refused(evcosim("build", "Batery"), "(did you mean 'Battery'?)", "is a Python file")
    (tmp_path / "model.c").write_text("int x;\n")
    refused(evcosim("build", "model.c"), "model.c: is C code, not a model", "docs/how-to/c-vehicle.md")


@pytest.mark.parametrize("native", [(), ("--native",)])
def test_a_run_warns_of_an_fmu_that_is_older_than_its_model(native, evcosim, tmp_path):
    """The command that the warning names ends it."""
    if native:
        need_c_compiler()
    assert evcosim("new", "car").code == 0
    assert evcosim("build", "car/models/vehicle.py", *native).out.endswith("car/models/Vehicle.fmu\n")
    run = ("run", "car/car.toml", "--stop-time", "1", "--no-plot", "--no-report", "-o", "out")
    assert "was built before" not in evcosim(*run).out
    model = tmp_path / "car" / "models" / "vehicle.py"
    model.write_text(model.read_text(encoding="utf-8").replace("var(40.0", "var(50.0"), encoding="utf-8")
    said = " ".join(evcosim(*run).out.split())
    command = " ".join(("evcosim build car/models/vehicle.py", *native))
    assert f"car/models/Vehicle.fmu was built before car/models/vehicle.py was changed: '{command}'" in said
    assert evcosim(*command.split()[1:]).code == 0
    assert "was built before" not in evcosim(*run).out


# -- native --------------------------------------------------------------------------------------------------

TAKEN, LEFT = "x.x + u.u", "x.x + sum([u.u, dt])"
MODEL = """
from evcosim.models.base import Model, record, var

class {name}(Model):
    "The sum of an input."

    @record
    class Parameters:
        scale: float = var(1.0, "", "Scale")

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
        return {name}.State()

    @staticmethod
    def step(p, x, u, dt):
        return {name}.State({step})

    @staticmethod
    def outputs(p, x):
        return {name}.Outputs(p.scale * x.x)
"""


@pytest.fixture
def own(tmp_path, compiled_once):
    """A file with a model that has a native form, and one that has none."""
    need_c_compiler()
    (tmp_path / "mine.py").write_text(MODEL.format(name="Taken", step=TAKEN))
    (tmp_path / "two.py").write_text(
        MODEL.format(name="First", step=TAKEN) + MODEL.format(name="Second", step=LEFT)
    )
    return tmp_path


def entries(path):
    with zipfile.ZipFile(path) as archive:
        return archive.namelist()


def test_a_model_of_ones_own_becomes_native(evcosim, own):
    made = evcosim("build", "mine.py", "--native")
    compiler = toolchain.named(toolchain.compiler(toolchain.here()))
    lines = [f"Taken: compiled by {compiler}", str(own / "Taken.fmu")]
    assert (made.code, made.out.splitlines()) == (0, lines)
    assert "sources/model.c" in entries("Taken.fmu")
    assert not [entry for entry in entries("Taken.fmu") if entry.endswith(".py")]
    shown = evcosim("info", "Taken.fmu").out
    assert "FMI 2.0 Co-Simulation" in shown and "python" not in shown.lower()
    assert f"compiled by {compiler}\n" in shown
    assert evcosim("build", "mine.py", "--native", "--fmi", "3", "-o", "three").code == 0
    assert "FMI 3.0 Co-Simulation" in evcosim("info", "three/Taken.fmu").out


def test_it_runs_as_the_one_in_python_does_in_the_process_of_evcosim(evcosim, own):
    assert evcosim("build", "mine.py", "--native", "-o", "native").code == 0
    assert evcosim("build", "mine.py", "-o", "python").code == 0
    tables = []
    for folder in ("native", "python"):
        run = ("run", f"{folder}/Taken.fmu", "--set", "u=0.1", "--stop-time", "1", "--no-plot", "--no-report")
        assert evcosim(*run, "-o", f"out-{folder}").code == 0
        units = json.loads(Path(f"out-{folder}/run.json").read_text())["units"]
        assert [unit["isolation"] for unit in units.values()] == ["none"]
        assert ["library" in unit for unit in units.values()] == [folder == "native"]
        tables.append(Path(f"out-{folder}/results.csv").read_bytes())
    assert tables[0] == tables[1]


def test_a_native_fmu_without_its_library_is_compiled_again(evcosim, own):
    assert evcosim("build", "mine.py", "--native").code == 0
    with zipfile.ZipFile("Taken.fmu") as whole, zipfile.ZipFile("bare.fmu", "w") as bare:
        for entry in whole.namelist():
            if not entry.startswith("binaries/"):
                bare.writestr(entry, whole.read(entry))
    assert evcosim("compile", "bare.fmu").code == 0
    tables = []
    for fmu in ("Taken", "bare"):
        run = ("run", f"{fmu}.fmu", "--set", "u=0.1", "--stop-time", "1", "--no-plot", "--no-report")
        assert evcosim(*run, "-o", f"out-{fmu}").code == 0
        tables.append(Path(f"out-{fmu}/results.csv").read_bytes().replace(b"bare", b"Taken"))
    assert tables[0] == tables[1]


def test_a_model_without_a_native_form_is_left_in_python_with_the_reason(evcosim, own):
    line = own.joinpath("two.py").read_text().partition("sum(")[0].count("\n") + 1
    made = evcosim("build", "two.py", "--native")
    origin, first, second, path = made.out.splitlines()
    assert origin.startswith("First: compiled by ")
    assert (made.code, first, path) == (0, str(own / "First.fmu"), str(own / "Second.fmu"))
    assert second.startswith(f"Second: left in Python, because two.py:{line}: sum(")
    assert "sources/model.c" in entries("First.fmu")
    assert "resources/slavemodule.txt" in entries("Second.fmu")


def test_what_is_required_and_cannot_be_had_leaves_nothing(evcosim, own):
    refused(evcosim("build", "two.py", "--native=require", "-o", "made"), "two.py: two.py:", "sum(")
    assert not (own / "made").exists()
    assert evcosim("build", "mine.py", "--native=require", "-o", "made").code == 0


def test_a_compiler_that_fails_or_is_not_there_leaves_nothing(evcosim, own, monkeypatch):
    broken = own / "brokencc"
    broken.write_text("#!/bin/sh\necho 'model.c:7: it is broken' >&2\nexit 4\n")
    broken.chmod(0o755)
    monkeypatch.setenv("CC", str(broken))
    for target in ("mine.py", "Battery"):
        answer = evcosim("build", target, "--native", "-o", "made")
        refused(answer, target, "exit code 4")
        assert "model.c:7: it is broken" in answer.err.splitlines()[1]
    monkeypatch.setenv("CC", "/nowhere/cc")
    refused(evcosim("build", "mine.py", "--native", "-o", "made"), "there is no C compiler '/nowhere/cc'")
    assert not (own / "made").exists()


def test_options_of_native_fmus(evcosim, own, monkeypatch):
    for option, value in (("--platform", "win64"), ("--fmi", "3"), ("--fmi", "2")):
        refused(evcosim("build", "Battery", option, value), f"{option} is for native FMUs: add --native")
    refused(evcosim("build", "mine.py", "--native=requir"), "did you mean 'require'")
    refused(evcosim("build", "mine.py", "--native", "--fmi", "1"), "native FMUs are of FMI 2 or 3")
    refused(evcosim("build", "mine.py", "--native", "--native=require"), "it is given already")
    unknown = evcosim("build", "mine.py", "--native", "--platform", "linux32")
    refused(unknown, "there is no platform 'linux32'; the platforms are linux64, win64")
    monkeypatch.setattr(toolchain, "has_zig", lambda: False)
    other = "darwin64" if toolchain.here().fmi2 != "darwin64" else "win64"
    answer = evcosim("build", "mine.py", "--native", "--platform", other)
    refused(answer, f"libraries for {other} are made by zig", 'pip install "evcosim[native]"')
    assert not list(own.glob("*.fmu"))


def test_a_library_for_each_platform(evcosim, own, monkeypatch):
    """Those of other platforms make no difference here."""
    monkeypatch.setattr(toolchain, "compiler", lambda target: ["cc"])
    named = ("--platform", "linux64", "--platform", "aarch64-linux", "--platform", "linux64")
    assert evcosim("build", "mine.py", "--native", *named).code == 0
    libraries = [entry for entry in entries("Taken.fmu") if entry.startswith("binaries/")]
    assert libraries == ["binaries/aarch64-linux/Taken.so", "binaries/linux64/Taken.so"]
    run = ("run", "Taken.fmu", "--stop-time", "0.1", "--no-plot", "--no-report", "-o", "out")
    assert evcosim(*run).code == 0


def test_half_a_native_fmu_is_refused(evcosim, own):
    assert evcosim("build", "mine.py", "--native").code == 0
    content = Path("Taken.fmu").read_bytes()
    Path("half.fmu").write_bytes(content[: len(content) // 2])
    refused(evcosim("info", "half.fmu"), "half.fmu")
    refused(evcosim("run", "half.fmu", "-o", "out"), "half.fmu")


def test_a_built_in_model_becomes_native_in_the_cache_and_in_a_folder(evcosim, own, monkeypatch):
    monkeypatch.setenv("EVCOSIM_CACHE", str(own / "cache"))
    cached = Path(evcosim("build", "Battery", "--native").out.splitlines()[-1])
    assert cached.parent == own / "cache" and cached.name.startswith("Battery_native_")
    assert (
        evcosim("build", "Battery", "--native=require", "-o", "made").out.splitlines()[-1]
        == "made/Battery.fmu"
    )
    assert Path("made/Battery.fmu").read_bytes() == cached.read_bytes()
    three = Path(evcosim("build", "Battery", "--native", "--fmi", "3").out.splitlines()[-1])
    assert three != cached and "FMI 3.0" in evcosim("info", str(three)).out
