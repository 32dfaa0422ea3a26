"""The system file: every built-in one, and what a system knows of its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import System, SystemFile, load_system, system_names
from evcosim.cosim.system.toml import DATA, read_toml, validate

HEAD = {"name": "s", "units": {"u": {"fmu": "F"}, "w": {"fmu": "F"}}}


@pytest.mark.parametrize("name", system_names())
def test_a_built_in_system_is_named_as_its_file(name: str) -> None:
    system = load_system(name)
    assert system.file.name == name
    assert system.path == DATA / "systems" / f"{name}.toml"
    assert system.file.title
    assert system.file.source


@pytest.mark.parametrize("name", system_names())
def test_what_a_built_in_system_connects_is_there(name: str) -> None:
    file = load_system(name).file
    for connection in file.connect:
        assert {v.partition(".")[0] for v in (connection.source, *connection.to)} <= set(file.units)
        assert connection.via is None or connection.via.partition(".")[0] in file.buses


def test_a_variable_stands_for_a_table_of_a_map() -> None:
    units = {"u": {"fmu": "F", "map": {"inputs": {"x": "y"}, "outputs": {"z": {"variable": "y"}}}}}
    tables = SystemFile.model_validate({"name": "s", "units": units}).units["u"].map.by_causality
    assert tables["input"]["x"] == tables["output"]["z"]
    assert tables["parameter"] == {}


def test_a_key_has_one_spelling() -> None:
    """`from` is the key; `source`, its name in the program, is none."""
    validate(HEAD | {"connect": [{"from": "u.y", "to": ["w.x"]}]}, SystemFile, "s.toml")
    with pytest.raises(ConfigError, match=r"connect 1.source: unknown key"):
        validate(HEAD | {"connect": [{"source": "u.y", "to": ["w.x"]}]}, SystemFile, "s.toml")


@pytest.mark.parametrize("value", ["ü", "_", "a1", "车"])
def test_names_are_made_of_letters_of_any_language(value: str) -> None:
    assert validate(HEAD | {"name": value}, SystemFile, "s.toml").name == value


def test_nothing_changes_after_reading() -> None:
    file = validate(HEAD, SystemFile, "s.toml")
    with pytest.raises(ValueError, match="frozen"):
        file.name = "t"  # type: ignore[misc] # what is tested


def test_a_direct_connection_has_no_value_before_the_first_message() -> None:
    connection = {"from": "u.y", "to": ["w.x"], "initial": 1.0}
    with pytest.raises(ConfigError, match="connect 1: 'initial' is what is there before the first message"):
        validate(HEAD | {"connect": [connection]}, SystemFile, "s.toml")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name = 'x'\n[units.a]\nfmu = 'A'\nparametres = {}\n", r"units.a.parametres: unknown key \(did you mean 'parameters'"),
        ("name = 'x'\n", "units: this key is needed"),
        ("name = 'x'\n[units.a]\n", "units.a.fmu: this key is needed"),
        ("name = 'x'\n[units.a]\nfmu = 'A'\nsubsteps = 0\n", "units.a.substeps: .* not 0"),
        ("name = 'x'\n[units.a]\nfmu = 'A'\n[[connect]]\nfrom = 'a'\nto = ['a.b']\n", "written unit.variable, not 'a'"),
        ("name = 'x'\n[units.a]\nfmu = 'A'\n[experiment]\nalgorithm = 'gauss'\n", "algorithm: .*'gauss_seidel' or 'jacobi'"),
        ("name = x\n", "is not valid TOML: .*line 1"),
    ],
)  # fmt: skip # one case a line
def test_a_wrong_system_file_names_file_key_and_value(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=said) as caught:
        read_toml(path, SystemFile)
    assert "mine.toml" in str(caught.value)


def test_scenarios_are_looked_up_beside_the_file_first(tmp_path: Path) -> None:
    system = System(tmp_path / "s.toml", validate(HEAD, SystemFile, "s.toml"))
    assert system.scenario_folders == [tmp_path / "scenarios" / "s", DATA / "scenarios" / "s"]


def test_the_keys_of_a_unit_stand_in_the_system_or_in_its_swap_file() -> None:
    file = validate(HEAD, SystemFile, "s.toml")
    system = System(Path("s.toml"), file, {"w": Path("swap.toml")})
    assert f"{system.keys_of('u')}period" == "s.toml: units.u.period"
    assert f"{system.keys_of('w')}period" == "swap.toml: period"
