"""The FMU as a zip file: equal entries give equal bytes, on every machine.

Entries are stored, not compressed: the bytes of deflate depend on the installed zlib.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from io import BytesIO

_EPOCH = (1980, 1, 1, 0, 0, 0)  # the first date a zip file can hold
_UNIX = 3  # the system whose permission bits external_attr holds


def packed(entries: Mapping[str, bytes]) -> bytes:
    """Return the zip file of path -> content, modelDescription.xml first and the rest sorted."""
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for path in sorted(entries, key=lambda path: (path != "modelDescription.xml", path)):
            info = zipfile.ZipInfo(path, _EPOCH)
            info.create_system = _UNIX
            info.external_attr = (0o100755 if path.startswith("binaries/") else 0o100644) << 16
            archive.writestr(info, entries[path])
    return buffer.getvalue()
