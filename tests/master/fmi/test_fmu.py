"""FMU files: which are read, what they offer to a plan, and which can run here."""

from __future__ import annotations

import dataclasses
import hashlib
import os
import zipfile
from pathlib import Path
from types import SimpleNamespace

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.fmus import cache
from evcosim.master.builtin import fmu_file
from evcosim.master.fmi import fmu as module
from evcosim.master.fmi.fmu import Fmu, FmuError, check_runnable, is_true, read_fmu, reading_once
from evcosim.master.prepare import prepare
from evcosim.master.simulation import simulate
from support.c_fmu import mixed_fmu, vehicle_fmu
from support.descriptions import GOOD, changed, described, redescribed
from support.equations import equations_fmu


def archive(path: Path, **entries: str) -> Path:
    with zipfile.ZipFile(path, "w") as file:
        for name, text in entries.items():
            file.writestr(name, text)
    return path


# ---- reading


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        ("folder/modelDescription.xml", "there is one in 'folder/': zip the content of that folder, not the"),
        ("modelDescripton.xml", "did you mean 'modelDescripton.xml'"),
        ("other.txt", "it has no modelDescription.xml"),
    ],
)
def test_an_archive_without_a_description_is_no_fmu(tmp_path: Path, entry: str, reason: str) -> None:
    with pytest.raises(FmuError, match=r"a.fmu: is not an FMU: it has no modelDescription.xml") as refusal:
        read_fmu(archive(tmp_path / "a.fmu", **{entry: GOOD}))
    assert reason in str(refusal.value)


def test_strict_makes_an_error_of_all_defects(tmp_path: Path) -> None:
    path = described(tmp_path, changed(('start="1.5"', 'start="x"'), ('start="3"', 'start="y"')))
    assert len(read_fmu(path).defects) == 2
    with pytest.raises(FmuError, match=r"a.fmu: strict: 2 defects: u: start = 'x' .*; n: start = 'y'"):
        read_fmu(path, strict=True)


def test_the_digest_is_that_of_the_file(tmp_path: Path) -> None:
    path = described(tmp_path, GOOD)
    assert read_fmu(path).digest == hashlib.sha256(path.read_bytes()).hexdigest()


# ---- what it offers


def test_what_cannot_be_used_is_named_with_its_reason(tmp_path: Path) -> None:
    alias = '<ScalarVariable name="v" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>'
    fmu = read_fmu(described(tmp_path, changed(("</ModelVariables>", f"{alias}</ModelVariables>"))))
    assert fmu.interface.unusable == {"v": "is an alias of the input u: connect that one"}
    assert "v" not in fmu.interface.variables


def test_references_are_shared_by_the_functions_of_a_type(tmp_path: Path) -> None:
    """In FMI 2.0 Enumerations are read as Integers; in FMI 3.0 all types share their references."""

    def variable(name: str, kind: str) -> str:
        about = f'name="{name}" valueReference="5" causality="input"'
        return f'<ScalarVariable {about}><{kind} start="1"/></ScalarVariable>'

    for one, other, shared in [
        ("Integer", "Enumeration", True),
        ("Integer", "Integer", True),
        ("Integer", "Boolean", False),
        ("Real", "Integer", False),
    ]:
        both = variable("first", one) + variable("second", other)
        path = described(tmp_path, changed(("</ModelVariables>", f"{both}</ModelVariables>")))
        refused = {"second": "is an alias of the input first: connect that one"} if shared else {}
        assert read_fmu(path).interface.unusable == refused


def test_an_interface_that_an_fmu_lacks_is_refused(tmp_path: Path) -> None:
    for kinds, wanted in (("CS", "model_exchange"), ("ME", "co_simulation")):
        fmu = read_fmu(equations_fmu(tmp_path / "decay.fmu", "decay", 3, kinds))
        with pytest.raises(
            ConfigError, match=rf'decay.fmu: interface = "{wanted}": it has no such interface'
        ):
            fmu.using(wanted)  # type: ignore[arg-type] # one of both


def test_co_simulation_is_the_default_where_there_are_both(tmp_path: Path) -> None:
    for kinds, default in (("ME CS", "co_simulation"), ("ME", "model_exchange")):
        path = equations_fmu(tmp_path / "decay.fmu", "decay", 2, kinds)
        assert read_fmu(path).interface_type == read_fmu(path).using(None).interface_type == default
        assert read_fmu(path).using("model_exchange").interface_type == "model_exchange"


def test_the_interface_of_a_system_is_the_one_that_runs(tmp_path: Path) -> None:
    fmu = equations_fmu(tmp_path / "decay.fmu", "decay", 2, "ME CS")
    for wanted in ("model_exchange", "co_simulation"):
        (tmp_path / "one.toml").write_text(
            'name = "one"\n[experiment]\nstop_time = 0.1\n'
            f'[units.a]\nfmu = "{fmu.name}"\ninterface = "{wanted}"\nisolation = "none"\n'
        )
        assert simulate(tmp_path / "one.toml", trust=True).manifest["units"]["a"]["interface"] == wanted


# ---- running it here


def test_an_fmu_without_a_binary_for_this_machine(tmp_path: Path) -> None:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2))
    check_runnable(fmu)
    other = dataclasses.replace(fmu, entries=("binaries/win64/mixed.dll", "sources/mixed.c"))
    with pytest.raises(FmuError, match=r"it has binaries for win64; it has its sources: evcosim compile"):
        check_runnable(other)
    with pytest.raises(FmuError, match=r"is missing; it has binaries for no platform$"):
        check_runnable(dataclasses.replace(fmu, entries=()))


COUNTS = {
    "numberOfContinuousStates": 'numberOfContinuousStates="2"',
    "numberOfEventIndicators": 'numberOfEventIndicators="1"',
}


@pytest.mark.parametrize("name", COUNTS)
@pytest.mark.parametrize("count", ["-5", "x", "1e3", "", "1_0"])
def test_model_exchange_needs_its_counts(tmp_path: Path, name: str, count: str) -> None:
    path = redescribed(equations_fmu(tmp_path / "a.fmu", "ball", 1), (COUNTS[name], f'{name}="{count}"'))
    with pytest.raises(FmuError, match=f"{name} = '{count}' is no number, and Model Exchange needs it"):
        read_fmu(path)


def test_model_exchange_of_fmi_1_counts_its_states(tmp_path: Path) -> None:
    path = equations_fmu(tmp_path / "a.fmu", "ball", 1)
    with pytest.raises(FmuError, match="has no numberOfContinuousStates, and Model Exchange needs it"):
        read_fmu(redescribed(path, ('numberOfContinuousStates="2"', "")))


@pytest.mark.parametrize(
    ("fmi", "name"),
    [(1, "numberOfContinuousStates"), (1, "numberOfEventIndicators"), (2, "numberOfEventIndicators")],
)
@pytest.mark.parametrize("count", ["100000000", "3000000000000", "9" * 40])
def test_more_than_the_solver_has_room_for_is_refused(
    tmp_path: Path, fmi: int, name: str, count: str
) -> None:
    fmu = equations_fmu(tmp_path / "a.fmu", "ball", fmi)
    fmu = read_fmu(redescribed(fmu, (COUNTS[name], f'{name}="{count}"')))
    with pytest.raises(FmuError, match=rf"has {count} [a-z ]+; Model Exchange solves [\d,]+ at most"):
        check_runnable(fmu)


def test_an_fmu_of_pythonfmu_is_known_by_its_resources(tmp_path: Path) -> None:
    assert read_fmu(fmu_file("Rider")).holds_python
    assert not read_fmu(mixed_fmu(tmp_path / "mixed.fmu", 2)).holds_python


def test_the_uri_of_the_resources_is_what_the_library_decodes() -> None:
    """pythonfmu's own library decodes %20 alone."""

    def uri(folder: str, *entries: str) -> bytes:
        return Fmu(Path("a.fmu"), None, entries).resources_uri(Path(folder))

    python = "resources/slavemodule.txt"
    assert uri("/units/a b") == b"file:///units/a%20b/resources"
    assert uri("/units/a b", python) == b"file:///units/a%20b/resources"
    assert uri("/units/\u00fc%") == b"file:///units/%C3%BC%25/resources"
    assert uri("/units/\u00fc%", python) == "file:///units/\u00fc%/resources".encode()
    with pytest.raises(
        FmuError, match=r"cannot run from the temporary folder .*'%20' in its name is read as"
    ):
        uri("/units/a%20b", python)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (True, True),
        ("true", True),
        (" 1 ", True),
        ("True", True),
        (False, False),
        ("0", False),
        (None, False),
    ],
)
def test_a_capability_may_be_text(value: object, expected: bool) -> None:
    assert is_true(SimpleNamespace(canDo=value), "canDo") is expected
    assert not is_true(SimpleNamespace(), "canDo")


@pytest.mark.parametrize(
    ("change", "differences"),
    [
        ((), set()),
        (('unit="km/h"', 'unit="km/h" relativeQuantity="true"'), {"u"}),
        (('<Real unit="m/s"/>', '<Real unit="m/s" relativeQuantity="1"/>'), {"y"}),
        (
            ('<Real declaredType="Speed"/>', '<Real declaredType="Speed" relativeQuantity="false"/>'),
            set(),
        ),
    ],
)
def test_which_variables_are_differences(
    tmp_path: Path, change: tuple[str, str], differences: set[str]
) -> None:
    text = changed(change) if change else GOOD
    interface = read_fmu(described(tmp_path, text)).interface
    assert {v.name for v in interface.variables.values() if v.difference} == differences


def test_a_variable_says_against_its_type_that_it_is_no_difference(tmp_path: Path) -> None:
    text = changed(
        ('<Real unit="m/s"/>', '<Real unit="m/s" relativeQuantity="true"/>'),
        ('<Real declaredType="Speed"/>', '<Real declaredType="Speed" relativeQuantity="false"/>'),
    )
    assert not read_fmu(described(tmp_path, text)).interface.variables["y"].difference


def test_a_file_is_read_once_within_a_block(tmp_path: Path) -> None:
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 2, **{'start="200"': 'start="heavy"'})
    (tmp_path / "again.fmu").symlink_to(fmu)
    with reading_once():
        first, again, linked = read_fmu(fmu), read_fmu(fmu), read_fmu(tmp_path / "again.fmu")
        assert again is first
        assert linked.description is first.description
        assert linked.path == tmp_path / "again.fmu"  # messages name the file as it was given
        with pytest.raises(FmuError, match=r"again.fmu: strict: 1 defect: m_total: start = 'heavy'"):
            read_fmu(tmp_path / "again.fmu", strict=True)
    os.utime(fmu)
    assert read_fmu(fmu).description is not first.description


def test_a_file_is_read_again_when_it_was_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "_JUST_NOW", -1)
    fmu = vehicle_fmu(tmp_path / "Vehicle.fmu", 2)
    first = read_fmu(fmu)
    assert read_fmu(fmu) is first
    (tmp_path / "again.fmu").symlink_to(fmu)
    assert read_fmu(tmp_path / "again.fmu").description is first.description
    about = fmu.stat()
    vehicle_fmu(fmu, 2, **{'start="200"': 'start="201"'})
    os.utime(fmu, ns=(about.st_atime_ns, about.st_mtime_ns))
    second = read_fmu(fmu)
    assert (first.interface.variables["m_total"].start, second.interface.variables["m_total"].start) == (
        200,
        201,
    )
    monkeypatch.setenv("EVCOSIM_FMU_LIMITS", "entries=1")
    with pytest.raises(FmuError, match="entries, more than 1"):
        read_fmu(fmu)
    fmu.unlink()
    with pytest.raises(FmuError, match="there is no such file"):
        read_fmu(fmu)


def test_the_last_ones_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "_JUST_NOW", -1)
    monkeypatch.setattr(module, "_MOST_KEPT", 2)
    monkeypatch.setattr(module, "_kept", {})
    a, b, c = (vehicle_fmu(tmp_path / f"{name}.fmu", 2) for name in "abc")
    first, second = read_fmu(a), read_fmu(b)
    assert read_fmu(a) is first and read_fmu(c).path == c
    assert read_fmu(a) is first and read_fmu(b) is not second


def test_an_fmu_by_itself_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[Path] = []
    inner = module._read

    def noted(path: Path) -> Fmu:
        read.append(path)
        return inner(path)

    monkeypatch.setattr(module, "_read", noted)
    prepared = prepare(vehicle_fmu(tmp_path / "Vehicle.fmu", 2))
    assert len(read) == 1
    assert prepared.fmus["fmu"].path == tmp_path / "Vehicle.fmu"
