"""`evcosim compile` prints the file that it wrote, or why there is none."""

from __future__ import annotations

from evcosim.master import builtin
from evcosim.master.fmi import compilation
from support.answers import refused


def test_the_written_file_is_printed(evcosim, monkeypatch, tmp_path):
    calls = []

    def compile_fmu(path, output):
        calls.append((path, output))
        return output or path

    monkeypatch.setattr(compilation, "compile_fmu", compile_fmu)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.fmu").touch()
    assert evcosim("compile", "own.fmu").out == "own.fmu\n"
    assert evcosim("compile", "own.fmu", "--output", "made.fmu").out == "made.fmu\n"
    assert [tuple(map(str, call)) for call in calls] == [("own.fmu", "None"), ("own.fmu", "made.fmu")]


def test_an_fmu_that_needs_none(evcosim):
    refused(
        evcosim("compile", builtin.fmu_file("Battery")), "has a binary for this machine already: binaries/"
    )


def test_c_code_is_no_fmu(evcosim, tmp_path):
    (tmp_path / "model.c").write_text("int x;\n")
    refused(evcosim("compile", "model.c"), "model.c: is C code, not an FMU", "docs/how-to/c-vehicle.md")


def test_a_file_that_is_not_there_has_a_nearest_name(evcosim, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(evcosim("compile", "Scoter"), "Scoter: there is no such file (did you mean 'Scooter'?)")
    (tmp_path / "Scooters.fmu").touch()
    refused(evcosim("compile", "Scooter.fmu"), "there is no such file (did you mean 'Scooters.fmu'?)")
