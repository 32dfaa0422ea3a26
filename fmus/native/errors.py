"""Reasons why a model has no native FMU; light to import."""

from __future__ import annotations


class NoNativeError(ValueError):
    """A native FMU that cannot be made; the text says why, and what to do."""


class Unsupported(NoNativeError):
    """A construct that has no native form; its text is file, line, source text, rule and what to write."""


class ToolchainError(NoNativeError):
    """A library that cannot be compiled; the text says why, and what to do."""
