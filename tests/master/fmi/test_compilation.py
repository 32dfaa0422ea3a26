"""FMUs that bring their C sources get a library for this machine."""

import zipfile
from pathlib import Path

import pytest

from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.master.fmi.compilation import compile_fmu
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.fmi.loading import load_unit
from support.c_fmu import SOURCES, mixed_fmu
from support.needs import need_c_compiler

DEFINED = "#define FMI {fmi}\n#define BEHAVIOR 0\n"
BUILD = """<fmiBuildDescription fmiVersion="3.0"><BuildConfiguration modelIdentifier="mixed"><SourceFileSet>
<SourceFile name="mixed.c"/><PreprocessorDefinition name="FMI" value="3"/>
<PreprocessorDefinition name="BEHAVIOR" value="0"/><PreprocessorDefinition name="MODEL" value="mixed"/>
</SourceFileSet></BuildConfiguration></fmiBuildDescription>"""


def bare(path: Path, fmi: int, sources: dict[str, str]) -> Path:
    """The unit of mixed.c without its library, with sources."""
    full = mixed_fmu(path.with_name("full.fmu"), fmi)
    with zipfile.ZipFile(full) as old, zipfile.ZipFile(path, "w") as new:
        new.writestr("modelDescription.xml", old.read("modelDescription.xml"))
        new.writestr("resources/kept.txt", "kept")
        for name, content in sources.items():
            new.writestr(f"sources/{name}", content)
    return path


def source(fmi: int) -> str:
    return DEFINED.format(fmi=fmi) + "#define MODEL mixed\n" + (SOURCES / "mixed.c").read_text()


def answer(path: Path) -> list[object]:
    unit = load_unit(read_fmu(path), "a", read_fmu(path).interface)
    unit.enter_initialization(0.0, 1.0)
    unit.set("u", 0.125)
    unit.set("count_in", 7)
    unit.exit_initialization()
    unit.start_step(FmuSteps.equal(0.0, 0.01, 1))
    found = [unit.get(name) for name in ("y", "count", "switch")]
    unit.terminate()
    unit.free()
    return found


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_the_library_made_here_computes_what_that_of_the_same_source_does(tmp_path: Path, fmi: int) -> None:
    path = bare(tmp_path / "bare.fmu", fmi, {"mixed.c": source(fmi)})
    with pytest.raises(FmuError, match=r"no binary for this machine.*evcosim compile"):
        answer(path)
    made = compile_fmu(path, tmp_path / "made.fmu")
    assert answer(made) == answer(tmp_path / "full.fmu")
    with zipfile.ZipFile(path) as before, zipfile.ZipFile(made) as after:
        assert {n: after.read(n) for n in before.namelist()} == {n: before.read(n) for n in before.namelist()}
    with pytest.raises(FmuError, match="has a binary for this machine already"):
        compile_fmu(made)


def test_the_files_and_definitions_that_an_fmu_of_fmi_3_declares(tmp_path: Path) -> None:
    plain = (SOURCES / "mixed.c").read_text()
    sources = {"mixed.c": plain, "other.c": "#error not this", "buildDescription.xml": BUILD}
    made = compile_fmu(bare(tmp_path / "bare.fmu", 3, sources))
    assert answer(made) == answer(tmp_path / "full.fmu")


@pytest.mark.parametrize(
    ("sources", "message"),
    [
        ({}, "has no C sources"),
        ({"mixed.c": "int x = ;"}, r"cannot compile its sources:\n.*sources/mixed.c:1:9: error"),
        (
            {"buildDescription.xml": BUILD, "a.c": ""},
            "declares the source sources/mixed.c, which is not in it",
        ),
        ({"buildDescription.xml": "<a", "a.c": ""}, "buildDescription.xml is no well-formed XML"),
    ],
)
def test_what_cannot_be_compiled_stays_as_it_is(tmp_path: Path, sources: dict, message: str) -> None:
    need_c_compiler()
    path = bare(tmp_path / "bare.fmu", 3, sources)
    content = path.read_bytes()
    with pytest.raises(FmuError, match=message) as caught:
        compile_fmu(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert path.read_bytes() == content
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bare.fmu", "full.fmu"]


def test_the_command_says_that_there_is_no_compiler(evcosim, tmp_path: Path, monkeypatch) -> None:
    bare(tmp_path / "bare.fmu", 2, {"mixed.c": source(2)})
    monkeypatch.setenv("CC", "no-such-compiler")
    refused = evcosim("compile", "bare.fmu")
    assert refused.code != 0
    assert "there is no C compiler 'no-such-compiler' here" in " ".join(refused.err.split())
    monkeypatch.delenv("CC")
    assert "bare.fmu" in evcosim("compile", "bare.fmu").out
    assert answer(tmp_path / "bare.fmu") == answer(tmp_path / "full.fmu")
