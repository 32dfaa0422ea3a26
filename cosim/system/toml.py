"""Reading the TOML files, and finding systems, scenarios and data files by name or path."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from ..errors import ConfigError, nearest

DATA = Path(__file__).parents[1] / "data"
"""The folder of the built-in systems, scenarios, databases and cycles."""


class FileModel(BaseModel):
    """Base of what stands in a file: an unknown key is an error, and nothing changes after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class FiniteModel(FileModel):
    """The same for tables in which infinity and NaN, which TOML can write, have no meaning."""

    model_config = ConfigDict(allow_inf_nan=False)


_Model = TypeVar("_Model", bound=BaseModel)


def read_toml(path: Path, model: type[_Model]) -> _Model:
    """Read and validate a TOML file. Raises ConfigError naming file, key, rule and value."""
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not UTF-8 text: {error.reason} at byte {error.start}") from error
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{path}: is not valid TOML: {error}") from error
    return validate(data, model, str(path))


def validate(data: Any, model: type[_Model], place: str) -> _Model:
    """Validate `data` as a `model`. Raises ConfigError with one line for each problem found."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        keys, tagged_by = sorted(_keys(model)), set(_discriminators(model))
        lines = [_explain(problem, keys, tagged_by, data) for problem in error.errors(include_url=False)]
        raise ConfigError("\n".join(f"{place}: {line}" for line in lines)) from error


def _explain(problem: Any, keys: list[str], tagged_by: set[str], data: Any) -> str:
    place, tag = _spelled(problem["loc"], tagged_by, data)
    if problem["type"].startswith("union_tag"):
        return _explain_tag(problem, place)
    path = _dotted(place) or "the file"
    if problem["type"] == "extra_forbidden":
        name = str(place[-1])
        return f"{path}: unknown key{tag}{nearest(name, keys) if name not in keys else ''}"
    if problem["type"] == "missing":
        return f"{path}: this key is needed{tag}"
    return f"{path}: {problem['msg'].removeprefix('Value error, ')}, not {_shown(problem['input'])}"


def _explain_tag(problem: Any, place: list[str | int]) -> str:
    """Return what is wrong with the key, as `action`, that says which table of a union stands at `place`."""
    key, table = problem["ctx"]["discriminator"].strip("'"), problem["input"]
    path = _dotted([*place, key])
    if problem["type"] == "union_tag_invalid":
        known = " or ".join(problem["ctx"]["expected_tags"].rsplit(", ", 1))
        return f"{path}: Input should be {known}, not {_shown(table[key])}"
    typo = next((name for name in table if nearest(name, [key])), None)
    if typo is not None:
        return f"{_dotted([*place, typo])}: unknown key{nearest(typo, [key])}"
    return f"{path}: this key is needed"


def _spelled(path: Iterable[str | int], tagged_by: set[str], data: Any) -> tuple[list[str | int], str]:
    """Return the path without the tags that pydantic puts in where a union's member was chosen by a key.

    The second is that key and its tag as part of a sentence, or nothing.
    """
    place: list[str | int] = []
    tag, chosen = "", False
    for part in path:
        key = next((k for k in tagged_by if isinstance(data, dict) and data.get(k) == part), None)
        if key is not None and not chosen:
            tag, chosen = f' with {key} = "{part}"', True
            continue
        place.append(part)
        chosen, data = False, _inside(data, part)
    return place, tag


def _inside(data: Any, part: str | int) -> Any:
    """The entry `part` of a table or a list; None where there is none."""
    if isinstance(data, list) and isinstance(part, int):
        return data[part]
    return data.get(part) if isinstance(data, dict) else None


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def _dotted(path: Iterable[str | int]) -> str:
    """Where in a file: keys with dots, and the number of an entry, counted from 1, as in 'connect 2.via'."""
    return "".join(f" {part + 1}" if isinstance(part, int) else f".{part}" for part in path).removeprefix(".")


def _keys(model: type[BaseModel]) -> Iterator[str]:
    """All keys that may stand anywhere in a file of this model."""
    for name, field in model.model_fields.items():
        yield field.alias or name
        for inner in _models_in(field.annotation):
            if inner is not model:
                yield from _keys(inner)


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _models_in(argument)


def _discriminators(model: type[BaseModel]) -> Iterator[str]:
    """The keys, as `action`, by which unions anywhere in a file of this model choose a member."""
    for field in model.model_fields.values():
        for info in (field, *_infos_in(field.annotation)):
            if isinstance(info.discriminator, str):
                yield info.discriminator
        for inner in _models_in(field.annotation):
            if inner is not model:
                yield from _discriminators(inner)


def _infos_in(annotation: Any) -> Iterator[FieldInfo]:
    if isinstance(annotation, FieldInfo):
        yield annotation
    for argument in get_args(annotation):
        yield from _infos_in(argument)


def names_in(folder: Path) -> list[str]:
    """The names (without .toml) of the files in a folder; none where there is no folder."""
    return sorted(path.stem for path in folder.glob("*.toml"))


def find(name: str, folders: list[Path], kind: str) -> Path:
    """The file of a built-in name or of a path.

    Raises ConfigError with the nearest name where there is none.
    """
    if name.endswith(".toml") or "/" in name or "\\" in name:
        path = Path(name)
        if not path.is_file():
            raise ConfigError(f"{path}: there is no such {kind} file")
        return path
    for folder in folders:
        if (folder / f"{name}.toml").is_file():
            return folder / f"{name}.toml"
    known = [known for folder in folders for known in names_in(folder)]
    raise ConfigError(f"unknown {kind} '{name}'{nearest(name, known)}; known: {', '.join(known) or 'none'}")


def data_file(name: str, beside: Path) -> Path:
    """A file that a system or scenario names: beside that file, else among the built-in data."""
    for folder in (beside.parent, DATA):
        if (folder / name).is_file():
            return folder / name
    raise ConfigError(f"{beside}: there is no file '{name}', neither in {beside.parent} nor built in")
