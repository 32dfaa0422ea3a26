"""The facts of a manifest, which may be an earlier one or edited by hand: each may be missing or other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def items_of(value: Any) -> list[tuple[str, Any]]:
    """Return the keys and values of an object; none of anything else."""
    return [(str(key), inner) for key, inner in value.items()] if isinstance(value, Mapping) else []


def records_of(value: Any) -> list[Mapping[str, Any]]:
    """Return the objects in a list; none of anything else."""
    return [each for each in value if isinstance(each, Mapping)] if isinstance(value, list) else []


def texts_of(value: Any) -> list[str]:
    """Return the texts in a list; none of anything else."""
    return [each for each in value if isinstance(each, str)] if isinstance(value, list) else []


def shown(value: Any) -> str:
    """Return a value as a cell of a table has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, list):
        return ", ".join(shown(each) for each in value)
    return "" if value is None else str(value)
