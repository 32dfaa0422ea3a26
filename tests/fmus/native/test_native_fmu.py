"""Native FMUs as importers meet them: validators, phases, logs, instances, and how they are packed."""

from __future__ import annotations

import os
import random
import shutil
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.validation import validate_fmu

from evcosim.fmus.native import toolchain
from evcosim.fmus.native.build import native_built
from evcosim.fmus.native.package import build_native, native_content
from evcosim.master.fmi.compilation import compile_fmu
from support.needs import need_c_compiler

Pairs = Callable[[str], Any]


@pytest.fixture
def unit(pairs: Pairs, load: Callable[[Path], Any]) -> Any:
    """A native FMU that was instantiated."""
    return load(pairs("Handmade").native)


def refused(unit: Any, call: str, *arguments: Any) -> str:
    """Return the message of a call that fails with fmi2Error."""
    before = len(unit.log)
    with pytest.raises(Exception, match="status 3"):
        getattr(unit.fmu, call)(*arguments)
    ((status, category, message),) = unit.log[before:]
    assert (status, category) == (3, "logStatusError")
    return str(message)


@pytest.mark.parametrize("name", ["Handmade", "HandmadeSampled", "HandmadePlain"])
def test_validators_are_silent(name: str, pairs: Pairs) -> None:
    native = pairs(name).native
    assert validate_fmu(str(native)) == []
    both = [
        fmpy.simulate_fmu(str(path), stop_time=0.5, output_interval=0.1)
        for path in (native, pairs(name).python)
    ]
    assert (both[0] == both[1]).all()


def test_the_description_is_that_of_the_python_fmu(pairs: Pairs) -> None:
    python, native = (_description(path) for path in (pairs("Handmade").python, pairs("Handmade").native))
    assert 'needsExecutionTool="true"' in python
    for text in ("needsExecutionTool", "pythonfmu"):
        assert text not in native
    start = "<LogCategories>"
    assert native[native.index(start) :] == python[python.index(start) :]
    units = slice(python.index("<UnitDefinitions>"), python.index(start))
    assert python[units] in native
    for capability in ("canGetAndSetFMUstate", "canSerializeFMUstate", "canNotUseMemoryManagementFunctions"):
        assert f'{capability}="true"' in native
    assert 'canBeInstantiatedOnlyOncePerProcess="false"' in native
    assert '<File name="instance.c" />' in native


def _description(path: Path) -> str:
    with zipfile.ZipFile(path) as archive:
        return archive.read("modelDescription.xml").decode()


# -- phases --------------------------------------------------------------------------------------------------


NOT_ENTERED = "the initialization mode has not been entered"
NOT_LEFT = "the initialization mode has not been left"
LEFT = "the initialization mode has been left"
ENDED = "it was terminated"


def test_calls_out_of_their_phase(unit: Any) -> None:
    assert refused(unit, "getReal", [12]) == f"fmi2GetReal: {NOT_ENTERED}"
    assert refused(unit, "exitInitializationMode") == f"fmi2ExitInitializationMode: {NOT_ENTERED}"
    assert refused(unit, "terminate") == f"fmi2Terminate: {NOT_ENTERED}"
    unit.fmu.setupExperiment()
    unit.fmu.enterInitializationMode()
    assert refused(unit, "enterInitializationMode") == f"fmi2EnterInitializationMode: {NOT_LEFT}"
    assert refused(unit, "setupExperiment") == f"fmi2SetupExperiment: {NOT_LEFT}"
    assert refused(unit, "terminate") == f"fmi2Terminate: {NOT_LEFT}"
    unit.fmu.exitInitializationMode()
    for call in ("enterInitializationMode", "exitInitializationMode", "setupExperiment"):
        assert refused(unit, call) == f"fmi2{call[0].upper()}{call[1:]}: {LEFT}"
    unit.fmu.terminate()
    assert refused(unit, "terminate") == f"fmi2Terminate: {ENDED}"
    assert refused(unit, "setReal", [7], [1.0]) == f"fmi2SetReal: {ENDED}"
    assert unit.get("total") == {"total": 0.75}
    unit.fmu.reset()
    unit.initialize({"speed": 1.0})
    assert unit.get("total") == {"total": 1.75}


def test_a_reference_beyond_31_bits(unit: Any) -> None:
    unit.initialize()
    said = refused(unit, "getReal", [4294967295, 99])
    assert said == "fmi2GetReal: there is no Real variable with value reference 99, 4294967295"


# -- lists of values -----------------------------------------------------------------------------------------


def test_lists_of_any_references_are_as_each_by_itself(load: Callable[[Path], Any]) -> None:
    need_c_compiler()
    unit, draw = load(native_built("Scooter")), random.Random(1)
    real = [v.valueReference for v in unit.variables.values() if v.type == "Real"]
    inputs = [v.valueReference for v in unit.variables.values() if v.causality == "input"]
    assert (len(real), len(inputs)) == (25, 4)
    unit.initialize({"throttle": 60.0})
    get, put = unit.fmu.getReal, unit.fmu.setReal
    for k in range(200):
        if k % 4 == 0:
            unit.fmu.doStep(0.1 * k, 0.4)
        chosen = draw.choice([_run(draw, real), _run(draw, real)[::-1], draw.choices(real, k=9)])
        assert get(chosen) == [get([r])[0] for r in chosen]
        given = draw.choice([_run(draw, inputs), _run(draw, inputs)[::-1], draw.sample(inputs, 3)])
        values = [draw.uniform(0.0, 9.0) for _ in given]
        before = dict(zip(real, get(real), strict=True))
        put(given, values)
        assert get(inputs) == [dict(zip(given, values, strict=True)).get(r, before[r]) for r in inputs]


def test_of_a_list_with_a_fixed_parameter_nothing_is_set(load: Callable[[Path], Any]) -> None:
    need_c_compiler()
    unit = load(native_built("Scooter"))
    unit.initialize()
    places = {name: v.valueReference for name, v in unit.variables.items()}
    last, first = places["initial_speed"], places["throttle"]
    assert first == last + 1
    expected = "fmi2SetReal: initial_speed is a fixed parameter: it cannot be set after the initialization"
    for given in ([last, first], [first, last]):
        assert refused(unit, "setReal", given, [7.0, 7.0]) == expected
        assert unit.fmu.getReal([last, first]) == [0.0, 0.0]


def _run(draw: random.Random, references: list[int]) -> list[int]:
    """Return some references, one after the other."""
    first = draw.randrange(len(references))
    return references[first : draw.randint(first, len(references)) + 1]


# -- logs ----------------------------------------------------------------------------------------------------


def test_the_categories_of_the_log(unit: Any) -> None:
    unit.initialize({"limit": 1, "active": False})

    def told() -> list[str]:
        before = len(unit.log)
        unit.fmu.doStep(0.0, 0.1)
        with pytest.raises(Exception, match="status 2"):
            unit.fmu.doStep(0.0, 0.0)
        return [category for _, category, _ in unit.log[before:]]

    assert told() == ["logStatusWarning", "logStatusError"]
    for _ in range(2):
        told()  # of the notices that come
    for categories, expected in (
        (["logStatusError"], ["logStatusError"]),
        (["logStatusWarning", "another"], ["logStatusWarning"]),
        ([], ["logStatusWarning", "logStatusError"]),
    ):
        for _ in range(3):  # there is a new notice at each third step
            unit.fmu.setDebugLogging(False, [])
            assert told() == []
        unit.fmu.reset()
        unit.initialize({"limit": 1})
        unit.fmu.setDebugLogging(True, categories)
        assert told() == expected


def test_a_notice_for_each_of_256_sentences(unit: Any) -> None:
    unit.initialize({"limit": 0})
    before = len(unit.log)
    for k in range(3 * 300):
        unit.fmu.doStep(float(k), 1.0)
    told = [message for _, _, message in unit.log[before:]]
    assert len(told) == 256
    last = "(the last of 256 different notices: no other one is told)"
    assert told[-1] == f"first at t = 765 s: 765 of 0 steps, 100 % of them {last}"
    assert told[-2] == "first at t = 762 s: 762 of 0 steps, 100 % of them"


def test_the_wrong_guid_and_the_wrong_interface(pairs: Pairs, load: Callable[[Path], Any]) -> None:
    unit = load(pairs("Handmade").native)
    before = len(unit.log)
    kept = unit.fmu.guid
    unit.fmu.guid = "{100 %}"
    with pytest.raises(Exception, match="Failed to instantiate"):
        unit.fmu.instantiate(callbacks=unit.callbacks)
    assert unit.log[before][2].startswith("fmi2Instantiate: the guid is '{100 %}', that of Handmade is '{")
    unit.fmu.guid = kept


# -- instances -----------------------------------------------------------------------------------------------


def test_a_thousand_instances_know_nothing_of_each_other(pairs: Pairs, tmp_path: Path) -> None:
    native = pairs("HandmadePlain").native
    fmpy.extract(str(native), str(tmp_path))
    description = fmpy.read_model_description(str(native))
    units = [_instance(description, tmp_path, f"unit {k}") for k in range(1000)]
    for k, unit in enumerate(units):
        unit.setReal([0, 7], [0.001 * k, float(k)])
    for unit in units:
        unit.enterInitializationMode()
        unit.exitInitializationMode()
    for unit in units:
        unit.doStep(0.0, 0.1)
    found = [unit.getReal([0, 7, 11])[2] for unit in units]
    assert found == [k + 0.001 * k * 50.0 / 100.0 + 0.1 * (0.1 * k + 2.0) / 3.0 for k in range(1000)]
    for unit in units:
        unit.freeInstance()


def _instance(description: Any, folder: Path, name: str) -> Any:
    unit = fmpy.fmi2.FMU2Slave(
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=name,
    )
    unit.instantiate()
    return unit


# -- packing -------------------------------------------------------------------------------------------------


def test_the_same_bytes_each_time(parts: Callable[..., Any], pairs: Pairs) -> None:
    made = pairs("HandmadePlain").native
    assert made.name == "HandmadePlain.fmu"
    assert native_content(parts("HandmadePlain")) == made.read_bytes()


def test_what_is_in_it(pairs: Pairs) -> None:
    with zipfile.ZipFile(pairs("Handmade").native) as archive:
        names = archive.namelist()
        library = archive.getinfo("binaries/linux64/Handmade.so")
    assert names[0] == "modelDescription.xml"
    assert {"sources/model.c", "sources/buildDescription.xml", "documentation/licenses/evcosim.txt"} < set(
        names
    )
    assert not any(name.startswith("resources/") for name in names)
    assert library.external_attr >> 16 == 0o100755


def test_the_sources_are_compiled_again(pairs: Pairs, tmp_path: Path, load: Callable[[Path], Any]) -> None:
    bare, made = tmp_path / "bare.fmu", tmp_path / "made.fmu"
    with zipfile.ZipFile(pairs("Handmade").native) as old, zipfile.ZipFile(bare, "w") as new:
        for name in old.namelist():
            if not name.startswith("binaries/"):
                new.writestr(name, old.read(name))
    compile_fmu(bare, made)
    one, other = load(pairs("Handmade").native), load(made)
    for unit in (one, other):
        unit.initialize({"gain": 0.3})
        unit.run([{"speed": 0.1 * k} for k in range(20)])
    assert one.get() == other.get()


# -- what goes wrong -----------------------------------------------------------------------------------------


def test_a_compiler_that_fails(parts: Callable[..., Any], tmp_path: Path) -> None:
    broken = parts("Handmade")._replace(source="int missing(void) { return 1 }\n")
    with pytest.raises(toolchain.ToolchainError) as raised:
        build_native(broken, tmp_path)
    first, *more = str(raised.value).splitlines()
    assert first.endswith("fails for linux64 (exit code 1):")
    assert any("model.c" in line for line in more)
    assert len(more) <= 13
    assert list(tmp_path.iterdir()) == []  # nothing is half-written


def test_no_compiler(parts: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(toolchain, "has_zig", lambda: False)
    with pytest.raises(toolchain.ToolchainError, match=r"no C compiler here .*evcosim\[native\]"):
        build_native(parts("Handmade"), tmp_path)
    monkeypatch.setenv("CC", "no-such-compiler -O1")
    with pytest.raises(toolchain.ToolchainError, match="there is no C compiler 'no-such-compiler' here"):
        build_native(parts("Handmade"), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_cc_chooses_the_compiler(
    parts: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    need_c_compiler()
    chosen = tmp_path / "my compiler"
    chosen.write_text(f'#!/bin/sh\necho "$@" > "{tmp_path}/said"\nexec {shutil.which("cc")} "$@"\n')
    chosen.chmod(0o755)
    monkeypatch.setenv("CC", f"'{chosen}' -DHERE")
    build_native(parts("HandmadePlain"), tmp_path)
    said = (tmp_path / "said").read_text().split()
    assert said[0] == "-DHERE"
    assert {"-ffp-contract=off", "-fno-builtin-exp", "-fvisibility=hidden", "-lm"} < set(said)


def test_a_compiler_that_writes_nothing(
    parts: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "true")
    with pytest.raises(toolchain.ToolchainError, match="nothing was written"):
        build_native(parts("Handmade"), tmp_path)


def test_an_unknown_platform(parts: Callable[..., Any], tmp_path: Path) -> None:
    known = "linux64, win64, darwin64, aarch64-darwin, aarch64-linux"
    with pytest.raises(toolchain.ToolchainError, match=f"no platform 'win32'; the platforms are {known}"):
        build_native(parts("Handmade"), tmp_path, platforms=("linux64", "win32"))


def test_zig_is_missing(parts: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(toolchain, "has_zig", lambda: False)
    with pytest.raises(toolchain.ToolchainError, match=r"for win64 .*: pip install \"evcosim\[native\]\""):
        build_native(parts("Handmade"), tmp_path, platforms=("win64",))


def test_an_unknown_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(toolchain.platform, "machine", lambda: "riscv64")
    with pytest.raises(toolchain.ToolchainError, match="no platform is known for this machine"):
        toolchain.here()
    monkeypatch.setattr(toolchain.platform, "machine", lambda: "AMD64")
    monkeypatch.setattr(sys, "platform", "win32")
    assert toolchain.here().fmi2 == "win64"


def test_a_folder_that_cannot_be_written(parts: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        build_native(parts("Handmade"), tmp_path / "file" / "folder")
    assert os.listdir(tmp_path) == ["file"]
