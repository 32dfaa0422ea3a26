"""The units of pint, which take half a second to read: once, and only where a test asks."""

from __future__ import annotations

import functools
from typing import Any


@functools.cache
def registry() -> Any:
    """Return the registry of pint's own units."""
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


def errors() -> Any:
    """Return the class of what pint raises."""
    import pint

    return pint.PintError
