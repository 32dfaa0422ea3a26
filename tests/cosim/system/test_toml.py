"""Reading TOML files and finding files by name, and what is said where nothing is found."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, Field, ValidationError

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.system import SystemFile, load_system, system_names
from evcosim.cosim.system.toml import (
    DATA,
    FileModel,
    FileValue,
    FiniteModel,
    data_file,
    find,
    is_built_in,
    names_in,
    parsed,
    read_toml,
)

DEEP = "is not valid TOML: tables or lists are nested more than 64 deep"


class Numbers(FiniteModel):
    """A table of finite numbers."""

    x: float = 0.0


class Many(FiniteModel):
    """Numbers of several types."""

    pair: tuple[float, float] = Field(strict=False)
    count: int = 0


class Values(FileModel):
    """A table of values of any type."""

    x: FileValue


@pytest.mark.parametrize("mark", ["", "\ufeff"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_files_of_other_editors(tmp_path: Path, mark: str, end: str) -> None:
    path = tmp_path / "a.toml"
    text = f'{mark}name = "a"{end}[units.u]{end}fmu = "F"{end}'
    path.write_bytes(text.encode())
    assert load_system(str(path)).file.units["u"].fmu == "F"


def test_unknown_names_say_what_there_is(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigError, match=r"unknown system 'scoter' \(did you mean 'scooter'\?\); known: .*scooter"
    ):
        load_system("scoter")
    with pytest.raises(ConfigError, match="there is no such system file"):
        load_system(str(tmp_path / "none.toml"))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"name = 1\nname = 2\n", "is not valid TOML: Cannot overwrite a value"),
        (b"name = '\xff'\n", "is not UTF-8 text: invalid start byte at byte 8"),
        (None, "cannot be read: "),
        (b"name = " + b"1" * 5000, "is not valid TOML: a number has too many digits"),
        (b"name = " + b"[" * 200_000, DEEP),
        (b"name = " + b"{a=" * 200_000, DEEP),
        (b"name = " + b"[" * 65 + b"]" * 65, DEEP),
        (b"[" + b"a." * 200_000 + b"a]", DEEP),
        (b"'a'." * 200_000 + b"a = 1", DEEP),
        (b'"a" .\t' * 65 + b"a = 1", DEEP),
        (b"[x." + b"a." * 40 + b"a]\ny." + b"b." * 40 + b"b = 1", DEEP),
    ],
)
def test_what_cannot_be_read_is_said(tmp_path: Path, content: bytes | None, said: str) -> None:
    path = tmp_path / "a.toml"
    if content is None:
        path.mkdir()
    else:
        path.write_bytes(content)
    with pytest.raises(ConfigError) as caught:
        read_toml(path, SystemFile)
    assert str(caught.value).startswith(f"{path}: {said}")


def test_what_is_long_and_not_deep_is_read() -> None:
    long = ".".join("a" * 30)
    text = (
        f"# {'word. ' * 50}\n[{long}]\nx = {'[' * 30}1{']' * 30}\ny = '{'-' * 100_000}'\nz = 0x{'f' * 5000}\n"
    )
    inner = parsed(text)
    for _ in range(30):
        inner = inner["a"]
    assert inner["z"] == 16**5000 - 1
    assert parsed("x = 1e5000")["x"] == math.inf


@pytest.mark.parametrize("x", [math.nan, math.inf, -math.inf])
def test_a_finite_table_has_finite_numbers(x: float) -> None:
    with pytest.raises(ValidationError, match="finite number"):
        Numbers(x=x)


@pytest.mark.parametrize("number", [np.float32(2.0), np.int64(2), np.float64(2.0)])
def test_numbers_of_numpy_are_numbers(number: Any) -> None:
    assert Numbers(x=number).x == 2.0
    read = Many(pair=np.array([number, number]), count=np.int64(3))
    assert (read.pair, read.count, type(read.pair[0])) == ((2.0, 2.0), 3, float)
    assert Many(pair=[number, 1]).pair == (2.0, 1.0)


@given(st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text())
def test_a_value_keeps_its_type(value: bool | int | float | str) -> None:
    read = Values(x=value).x
    assert (type(read), read) == (type(value), value)


@pytest.mark.parametrize("value", [None, [1], {"a": 1}, b"x"])
def test_a_value_is_a_scalar(value: object) -> None:
    with pytest.raises(ValidationError, match="a value is a number, true, false or a text"):
        Values.model_validate({"x": value})


def test_a_name_is_found_in_the_first_folder_that_has_it(tmp_path: Path) -> None:
    folders = [tmp_path / "none", tmp_path / "a", tmp_path / "b"]
    for folder, name in ((folders[1], "x"), (folders[2], "x"), (folders[2], "y")):
        folder.mkdir(exist_ok=True)
        (folder / f"{name}.toml").write_text("")
    assert find("x", folders, "thing") == folders[1] / "x.toml"
    assert find("y", folders, "thing") == folders[2] / "y.toml"
    assert find(str(folders[2] / "x.toml"), folders, "thing") == folders[2] / "x.toml"
    assert [names_in(folder) for folder in folders] == [[], ["x"], ["x", "y"]]
    with pytest.raises(ConfigError, match=r"^unknown thing 'z'; known: x, y$"):
        find("z", folders, "thing")


def test_a_file_beside_comes_before_a_built_in_one(tmp_path: Path) -> None:
    system = tmp_path / "s.toml"
    assert data_file("can/ev.dbc", system, "s.toml: buses.can0.dbc") == DATA / "can" / "ev.dbc"
    (tmp_path / "can").mkdir()
    (tmp_path / "can" / "ev.dbc").write_text("")
    assert data_file("can/ev.dbc", system, "s.toml: buses.can0.dbc") == tmp_path / "can" / "ev.dbc"
    with pytest.raises(
        ConfigError, match=r"^s.toml: buses.can0.dbc: there is no file 'no.dbc', neither in .* nor built in"
    ):
        data_file("no.dbc", system, "s.toml: buses.can0.dbc")


def test_the_data_of_evcosim_is_built_in(tmp_path: Path) -> None:
    assert is_built_in(DATA / "systems" / "scooter.toml")
    assert not is_built_in(tmp_path / "scooter.toml")
    assert not is_built_in(DATA)


def test_a_whole_number_that_a_double_rounds_is_refused_for_a_key_of_doubles() -> None:
    assert Numbers(x=2**53).x == 2.0**53
    assert Numbers(x=2**53 + 2).x == 2.0**53 + 2.0
    assert Numbers(x=9007199254740993.0).x == 2.0**53
    with pytest.raises(
        ValidationError, match="x = 9007199254740993 is no number that a double holds exactly"
    ):
        Numbers(x=2**53 + 1)


def test_what_is_made_of_a_text_twice_has_nothing_in_common() -> None:
    """The tables of a text are kept, and whoever changes what was made of them changes that alone."""

    def parts(model: object) -> Iterator[object]:
        for part in vars(model).values() if isinstance(model, BaseModel) else model:  # type: ignore[attr-defined] # of its kind
            if isinstance(part, list | dict | BaseModel):
                yield part
                yield from parts(list(part.values()) if isinstance(part, dict) else part)

    for name in system_names():
        path = DATA / "systems" / f"{name}.toml"
        first, second = read_toml(path, SystemFile), read_toml(path, SystemFile)
        assert first == second
        assert not {id(part) for part in parts(first)} & {id(part) for part in parts(second)}
