"""Codes of the kernel for what the plan says in words; mypy names the word that has none."""

from __future__ import annotations

from typing import assert_never

from ...machine import tables as L
from ..turn import Effect


def effect_kind(effect: Effect) -> int:
    """Return the code of what an effect does to the value in its slot."""
    match effect.kind:
        case "replace":
            return L.REPLACE
        case "add":
            return L.ADD_TO
        case "follow":
            return L.FOLLOW
        case _:
            assert_never(effect.kind)
