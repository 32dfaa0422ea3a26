"""The reason why an FMU was not instantiated, as far as it can be known."""

from __future__ import annotations

import re
from pathlib import Path

from ...cosim.shortage import reason_of_import
from .fmu import Fmu, is_true

_GUID = re.compile(rb"[0-9a-fA-F]{8}(?:-[0-9a-fA-F]{4}){3}-[0-9a-fA-F]{12}")
_ABOUT_GUID = re.compile(r"^(?!\[OK\]).*(guid|instantiation ?token)", re.IGNORECASE | re.MULTILINE)


def why_refused(fmu: Fmu, library: Path, said: str) -> str:
    """Return a clause that begins with ":" and ends with the FMU's own words `said`, where there are any.

    The usual reason is a GUID (FMI 3.0: instantiationToken) that is not that of the library: the FMU says so,
    or its library holds another one. Another is the absence of the tool that the FMU needs, or a limit of
    this process.
    """
    if short := reason_of_import(Exception(said)):  # of a library, or a file of Python
        return f": {short}"
    description = fmu.description
    name = "instantiationToken" if description.fmiVersion.startswith("3") else "GUID"
    declared = description.guid or ""
    words = f"\n{said}" if said else ""
    apart = "modelDescription.xml and library do not belong together"
    if other := _other_guid(library, declared):
        return (
            f": modelDescription.xml has the {name} '{declared}', its library holds '{other}': {apart}{words}"
        )
    if _ABOUT_GUID.search(said):
        return f": it does not accept the {name} '{declared}' of modelDescription.xml: {apart}{words}"
    if is_true(fmu.kind, "needsExecutionTool") and not fmu.holds_python:
        tool = description.generationTool or "it does not say which"
        return f": it needs the tool that made it ({tool}) to be installed (needsExecutionTool){words}"
    return f":{words}" if words else ": its instantiate function returned nothing and no message"


def _other_guid(library: Path, declared: str) -> str:
    """Return the one GUID in a library that does not hold the declared one; "" when there is no such."""
    content = library.read_bytes()
    bare = declared.strip("{} ").encode()
    if not bare or bare in content:
        return ""
    found = set(_GUID.findall(content))
    return found.pop().decode() if len(found) == 1 else ""
