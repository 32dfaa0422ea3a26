"""LLVM makes machine code of a structure: imported only where the cache has none."""

# llvmlite has no types
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

import llvmlite.binding as llvm

from ...machine.flat import NotFlatError, linked, object_of
from .straight_code import ENTRY, straight_code
from .structure import Structure

IS_OPAQUE = llvm.llvm_version_info[0] >= 16
"""True where pointers of LLVM's language have no types."""


def machine_code(structure: Structure) -> bytes | None:
    """Return code as plain bytes; None: it needs more than its own bytes on this machine."""
    return linked_code(straight_code(structure, IS_OPAQUE), ENTRY)


def linked_code(text: str, entry: str) -> bytes | None:
    """Return the machine code of a module in LLVM's language that begins with a function, or None."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    try:
        return linked(object_of(text), entry)
    except NotFlatError:
        return None
