"""`evcosim build` writes the built-in FMUs."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path

from support.answers import refused


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


def test_a_run_warns_of_an_fmu_that_is_older_than_its_model(evcosim, tmp_path):
    """The command that the warning names ends it."""
    assert evcosim("new", "car").code == 0
    run = ("run", "car/car.toml", "--stop-time", "1", "--no-plot", "--no-report", "-o", "out")
    assert "was built before" not in evcosim(*run).out
    model = tmp_path / "car" / "models" / "vehicle.py"
    model.write_text(model.read_text(encoding="utf-8").replace("var(40.0", "var(50.0"), encoding="utf-8")
    said = " ".join(evcosim(*run).out.split())
    command = "evcosim build car/models/vehicle.py"
    assert f"car/models/Vehicle.fmu was built before car/models/vehicle.py was changed: '{command}'" in said
    assert evcosim(*command.split()[1:]).code == 0
    assert "was built before" not in evcosim(*run).out
