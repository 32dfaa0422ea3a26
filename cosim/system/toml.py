"""Reading the TOML files, and finding systems, scenarios and data files by name or path."""

from __future__ import annotations

import functools
import math
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    GetJsonSchemaHandler,
    PlainValidator,
    ValidationError,
    WithJsonSchema,
    model_validator,
)

from ..errors import ConfigError, nearest, short
from ..file_names import near_file
from ..interface import Value
from ..reading import content, is_file
from .kinds import kind_of
from .problems import sentences
from .toml_text import parsed

DATA = Path(__file__).parents[1] / "data"
"""The folder of the built-in systems, scenarios, databases and cycles."""


def is_built_in(path: Path) -> bool:
    """Return True for a file below DATA."""
    return DATA.resolve() in path.resolve().parents


class FileModel(BaseModel):
    """Base of the tables of a file: an unknown key is an error, and nothing changes after reading.

    A value has the type that its key declares: `"0.5"` and `true` are no numbers, 1 and "no" no truth values.

    The docstring under a key is its text in the JSON schema (`schema.py`) and in docs/system-file.md.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    @model_validator(mode="before")
    @classmethod
    def _numbers_of_numpy(cls, data: Any) -> Any:
        """Return numbers and arrays of numpy, which Python code may give, as Python's own.

        Raises ValueError for a whole number that would be rounded to a double.
        """
        if not isinstance(data, Mapping):
            return data
        own = {key: _of_python(value) for key, value in data.items()}
        for key, value in own.items():
            whole = isinstance(value, int) and 2**53 < abs(value) <= sys.float_info.max
            if whole and int(float(value)) != value and _takes_doubles(cls, key):
                near = short(int(float(value)))
                raise ValueError(
                    f"{key} = {short(value)} is no number that a double holds exactly, as {near} is"
                )
        return own


@functools.cache
def _takes_doubles(model: type[BaseModel], field: str) -> bool:
    """Return True for a key whose number is a double: of a `Value` the variable says it."""

    def kinds(kind: Any) -> set[Any]:
        return {kind}.union(*map(kinds, get_args(kind)))

    found = kinds(model.model_fields[field].annotation) if field in model.model_fields else set()
    return float in found and int not in found


def _of_python(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [_of_python(each) for each in value]
    return value.tolist() if hasattr(value, "tolist") else value


class FiniteModel(FileModel):
    """Base of tables in which infinity and NaN, which TOML can write, have no meaning."""

    model_config = ConfigDict(allow_inf_nan=False)


def _plain(value: Any) -> Any:
    if not isinstance(value, Value):
        raise ValueError("a value is a number, true, false or a text")
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        raise ValueError(f"a number may be {sys.float_info.max:.3g} at most")
    return value


_VALUE_SCHEMA = {"anyOf": [{"type": kind} for kind in ("number", "string", "boolean")]}

FileValue = Annotated[Value, BeforeValidator(_plain), WithJsonSchema(_VALUE_SCHEMA)]
"""A value that a file gives to a variable, of which the FMU says later what type it has."""


def _finite_plain(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("a finite number is needed")
    return _plain(value)


GivenValue = Annotated[Value, PlainValidator(_finite_plain), WithJsonSchema(_VALUE_SCHEMA)]
"""A value of a stimulus or an event, of which the input says later what type it has."""


def text_type(title: str, pattern: str) -> WithJsonSchema:
    """Return the JSON schema of a text that a validator checks: how it is written, and its pattern."""
    return WithJsonSchema({"type": "string", "title": title, "pattern": pattern})


FORBIDDEN_KEY: dict[str, Any] = {"not": {}}
"""The JSON schema of a key that may not stand there; for `false` some validators mark the whole table."""


def text_as(key: str) -> BeforeValidator:
    """Return the validator of a table for which a file may give the value of one key alone, a text."""

    def table(value: Any) -> Any:
        if isinstance(value, str):
            return {key: value}
        if not isinstance(value, Mapping | BaseModel):
            raise ValueError("a table or a text is needed")
        return value

    return BeforeValidator(table)


class OrText:
    """The mark of a table for which a file may give a text alone; `text_as` makes the table of it."""

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [{"type": "string"}, handler(schema)]}


_Model = TypeVar("_Model", bound=BaseModel)


def read_toml(path: Path, model: type[_Model]) -> _Model:
    """Return a TOML file as a `model`. Raises ConfigError naming file, key, rule and value."""
    try:
        # as the text of a file, with the line ends of all systems
        text = content(path).decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
        data = _parsed_before(text) if len(text) <= _KEPT else parsed(text)
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not UTF-8 text: {error.reason} at byte {error.start}") from error
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{path}: is not valid TOML: {error}") from error
    return validate(data, model, str(path))


_KEPT = 100_000
"""Characters of a text whose tables a process keeps, as of a system that runs often; models copy them."""
_parsed_before = functools.lru_cache(maxsize=32)(parsed)


def validate(data: Any, model: type[_Model], place: str) -> _Model:
    """Return `data` as a `model`. Raises ConfigError with one line for each problem found."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        lines = sentences(error, data, model)
        raise ConfigError(*(f"{place}: {line}" for line in lines)) from error


def names_in(folder: Path) -> list[str]:
    """Return the names (without .toml) of the files in a folder; none where there is no folder."""
    return sorted(path.stem for path in folder.glob("*.toml"))


def find(name: str, folders: list[Path], kind: str, owner: str = "") -> Path:
    """Return the path of a file of this kind by its name in one of the folders, or by its path.

    Raises ConfigError with the nearest name where there is none, or `owner` has none of that name.
    """
    if name.endswith(".toml") or "/" in name or "\\" in name:
        path = Path(name)
        if said := kind_of(path, kind):
            raise ConfigError(said)
        if not is_file(path):
            raise ConfigError(f"{path}: there is no such {kind} file{near_file(path)}")
        return path
    for folder in folders:
        if is_file(folder / f"{name}.toml"):
            return folder / f"{name}.toml"
    if said := kind_of(Path(name), kind):
        raise ConfigError(said)
    known = [known for folder in folders for known in names_in(folder)]
    said = f"{owner} has no {kind} '{name}'" if owner else f"unknown {kind} '{name}'"
    there_are = ", ".join(dict.fromkeys(known)) or "none"
    raise ConfigError(f"{said}{nearest(name, known)}; known: {there_are}")


def data_file(name: str, beside: Path, place: str) -> Path:
    """Return the path of a file that the system or scenario `beside` names: next to it, else built in.

    `place` is the file and the key that names it. Raises ConfigError, which starts with `place`, where there
    is no such file.
    """
    for folder in (beside.parent, DATA):
        if is_file(folder / name):
            return folder / name
    raise ConfigError(f"{place}: there is no file {short(name)}, neither in {beside.parent} nor built in")
