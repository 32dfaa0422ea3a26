"""A constant that a function changes: a model that imports it is refused."""

from __future__ import annotations

KEPT = [0.0]


def change(value: float) -> None:
    """Change the constant."""
    KEPT[0] = value
