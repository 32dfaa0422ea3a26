"""Codes of the kernel for what the plan says in words; mypy names the word that has none."""

from __future__ import annotations

from typing import assert_never

from ....cosim.can.quantization import SignalOperation
from ...machine import tables as L
from ..engine import Effect


def effect_kind(effect: Effect) -> int:
    """Return the code of what an effect does to the value in its slot."""
    match effect.kind:
        case "replace":
            return L.REPLACE
        case "add":
            return L.ADD_TO
        case _:
            assert_never(effect.kind)


def raw_mode(operation: SignalOperation) -> int:
    """Return the code of the steps from a value to the raw value."""
    match operation.kind:
        case "float32":
            return L.FLOAT32
        case "float64":
            return L.FLOAT64
        case "integer" | "exact":
            pass
        case _:
            assert_never(operation.kind)
    match operation.settings.rounding:
        case "nearest":
            return L.NEAREST
        case "half_even":
            return L.HALF_EVEN
        case "truncate":
            return L.TRUNCATE
        case _:
            assert_never(operation.settings.rounding)
