"""FMUs that bring their C sources get a library for this machine."""

import zipfile
from pathlib import Path

import pytest

from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.master.fmi.compilation import compile_fmu
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.fmi.loading import load_unit
from evcosim.master.simulation import simulate
from support.c_fmu import SOURCES, mixed_fmu
from support.equations import equations_fmu
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


@pytest.mark.parametrize("fmi", [1, 3])
def test_sources_in_an_archive_that_separates_folders_otherwise(tmp_path: Path, fmi: int) -> None:
    path = bare(tmp_path / "bare.fmu", fmi, {"mixed.c": source(fmi), "buildDescription.xml": BUILD})
    path.write_bytes(path.read_bytes().replace(b"sources/", b"sources\\"))
    assert answer(compile_fmu(path, tmp_path / "made.fmu")) == answer(tmp_path / "full.fmu")


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


def equations_source(fmi: int) -> str:
    return f"#define FMI {fmi}\n#define MODEL DECAY\n" + (SOURCES / "equations.c").read_text()


@pytest.mark.parametrize("fmi", [1, 2, 3])
def test_the_library_of_model_exchange(tmp_path: Path, fmi: int) -> None:
    full = equations_fmu(tmp_path / "full.fmu", "decay", fmi)
    path = tmp_path / "bare.fmu"
    with zipfile.ZipFile(full) as old, zipfile.ZipFile(path, "w") as new:
        new.writestr("modelDescription.xml", old.read("modelDescription.xml"))
        new.writestr("sources/equations.c", equations_source(fmi))
    one, other = (simulate(fmu, stop_time=1.0, isolation="none") for fmu in (full, compile_fmu(path)))
    assert one["fmu.x0"][-1] == pytest.approx(0.36788, abs=1e-5)
    assert one.data.tobytes() == other.data.tobytes()


@pytest.mark.parametrize(
    ("include", "place"), [("template.c", "template.c"), ("../deep/template.c", "deep/template.c")]
)
def test_a_c_file_that_another_one_includes_is_compiled_within_it_only(
    tmp_path: Path, include: str, place: str
) -> None:
    """As the FMUs of FMI 1.0 are made of a template, and declare nothing."""
    text = f'#define FMI 1\n#define MODEL mixed\n#define BEHAVIOR 0\n # include "{include}"\n'
    sources = {
        "main/model.c" if "/" in include else "model.c": text,
        place: (SOURCES / "mixed.c").read_text(),
    }
    made = compile_fmu(bare(tmp_path / "bare.fmu", 1, sources))
    assert answer(made) == answer(tmp_path / "full.fmu")


def test_the_files_and_definitions_that_an_fmu_of_fmi_3_declares(tmp_path: Path) -> None:
    plain = (SOURCES / "mixed.c").read_text()
    sources = {"mixed.c": plain, "other.c": "#error not this", "buildDescription.xml": BUILD}
    made = compile_fmu(bare(tmp_path / "bare.fmu", 3, sources))
    assert answer(made) == answer(tmp_path / "full.fmu")


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_options_that_a_build_description_declares(tmp_path: Path, fmi: int) -> None:
    needed = "#ifndef WANTED\n#error no option\n#endif\n#ifdef WRONG\n#error of another compiler\n#endif\n"
    options = f'language="C99" compilerOptions="-DWANTED=1 -ffp-contract=off -o {tmp_path}/elsewhere -O9"'
    build = BUILD.replace("<SourceFileSet>", f"<SourceFileSet {options}>")
    assert build != BUILD
    other = '<SourceFileSet compiler="MSVC" compilerOptions="/O2 -DWRONG"></SourceFileSet></BuildConf'
    build = build.replace("</BuildConf", other)
    sources = {
        "mixed.c": needed + source(fmi).replace("#define MODEL mixed", ""),
        "buildDescription.xml": build,
    }
    made = compile_fmu(bare(tmp_path / "bare.fmu", fmi, sources))
    assert answer(made) == answer(tmp_path / "full.fmu")
    assert not (tmp_path / "elsewhere").exists()


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


PREFIXED = """
#define PASTE(a, b) a##b
#define FULL(a, b) PASTE(a, b)
#if {condition}
#define fmi2Instantiate FULL(PREFIX, fmi2Instantiate)
#define fmi2DoStep FULL(PREFIX, fmi2DoStep)
#endif
#define PREFIX mixed_
"""


@pytest.mark.parametrize(
    "condition", ["!defined NO_FUNCTION_PREFIX", "!defined FMI2_OVERRIDE_FUNCTION_PREFIX"]
)
def test_a_prefix_of_the_functions_is_left_out(tmp_path: Path, condition: str) -> None:
    made = compile_fmu(
        bare(tmp_path / "bare.fmu", 2, {"mixed.c": PREFIXED.format(condition=condition) + source(2)})
    )
    assert answer(made) == answer(tmp_path / "full.fmu")


CLOSED = [
    (PREFIXED.format(condition=1), "lacks the function fmi2Instantiate; it has mixed_fmi2Instantiate$"),
    ("#define fmi2DoStep other\n", "lacks the function fmi2DoStep$"),
    (
        'char *_strdup(const char *); char *copy(void) { return _strdup(""); }\n',
        r'undefined symbol: _strdup, which strdup is here: CC="cc -D_strdup=strdup" evcosim compile',
    ),
    ("void gone(void); void call(void) { gone(); }\n", "undefined symbol: gone: its sources call a function"),
    ("__attribute__((constructor)) void ends(void) { __builtin_trap(); }\n", "loading it ended with SIGILL"),
    ("void _exit(int); __attribute__((constructor)) void ends(void) { _exit(3); }\n", "no reason was given"),
]


@pytest.mark.parametrize(("more", "message"), CLOSED)
def test_a_library_that_is_of_no_use_is_not_put_in(tmp_path: Path, more: str, message: str) -> None:
    path = bare(tmp_path / "bare.fmu", 2, {"mixed.c": more + source(2)})
    content = path.read_bytes()
    with pytest.raises(FmuError, match=rf"{path}: the library of its sources .*{message}"):
        compile_fmu(path)
    assert path.read_bytes() == content


def test_the_advice_for_a_function_of_windows_works(tmp_path: Path, monkeypatch) -> None:
    use = 'char *_strdup(const char *); char *copy(void) { return _strdup(""); }\n'
    path = bare(tmp_path / "bare.fmu", 2, {"mixed.c": use + source(2)})
    monkeypatch.setenv("CC", "cc -D_strdup=strdup")
    assert answer(compile_fmu(path)) == answer(tmp_path / "full.fmu")


@pytest.mark.parametrize("written", ["./deep/mixed.c", "deep\\mixed.c", "deep/../deep//mixed.c"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_source_paths_as_tools_write_them(tmp_path: Path, fmi: int, written: str) -> None:
    """Their headers are found in other folders of the sources too."""
    sources = {
        "deep/mixed.c": '#include "about.h"\n'
        + source(fmi).partition("#define BEHAVIOR")[2].partition("\n")[2],
        "include/about.h": DEFINED.format(fmi=fmi),
        "other.c": "#error not this",
    }
    if fmi == 3:
        build = BUILD.partition("<PreprocessorDefinition")[0].replace('"mixed.c"', f'"{written}"')
        sources["buildDescription.xml"] = (
            f"{build}</SourceFileSet></BuildConfiguration></fmiBuildDescription>"
        )
    path = bare(tmp_path / "bare.fmu", fmi, sources)
    if fmi == 2:
        files = f'<SourceFiles><File name="{written}"/></SourceFiles>'
        with zipfile.ZipFile(path) as old:
            entries = {name: old.read(name) for name in old.namelist()}
        text = entries["modelDescription.xml"].decode()
        begin = '<CoSimulation modelIdentifier="mixed"'
        entries["modelDescription.xml"] = text.replace(
            f"{begin}/>", f"{begin}>{files}</CoSimulation>"
        ).encode()
        with zipfile.ZipFile(path, "w") as new:
            for name, content in entries.items():
                new.writestr(name, content)
    assert answer(compile_fmu(path)) == answer(tmp_path / "full.fmu")
