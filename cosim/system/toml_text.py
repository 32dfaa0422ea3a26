"""The text of TOML files, read within limits: what a stranger wrote takes no hours and no deep recursion."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from typing import Any

_DEEPEST = 64
_PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')"""
_DEEP_KEY = re.compile(rf"(?<![A-Za-z0-9_-])(?:{_PART}[ \t]*+\.[ \t]*+){{{_DEEPEST}}}")


def parsed(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text. Raises tomllib.TOMLDecodeError, whatever is wrong with it."""
    too_deep = tomllib.TOMLDecodeError(f"tables or lists are nested more than {_DEEPEST} deep")
    if _DEEP_KEY.search(text):  # tomllib takes hours for a key of many thousand parts
        raise too_deep
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except ValueError as error:  # of thousands of digits
        raise tomllib.TOMLDecodeError("a number has too many digits") from error
    except RecursionError as error:
        raise too_deep from error
    level: list[Any] = [data]
    for _ in range(_DEEPEST):
        level = [inner for each in level for inner in _values(each)]
    if level:
        raise too_deep
    return data


def _values(data: Any) -> Iterable[Any]:
    return data.values() if isinstance(data, dict) else data if isinstance(data, list) else ()
