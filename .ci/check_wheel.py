"""A wheel holds evcosim.* and its own metadata, all data files, and nothing at the top level beside them."""

import pathlib
import sys
import zipfile

root = pathlib.Path(__file__).parent.parent
names = zipfile.ZipFile(sys.argv[1]).namelist()
tops = {name.split("/")[0] for name in names}
strangers = sorted(top for top in tops if top != "evcosim" and not top.endswith(".dist-info"))
if strangers:
    sys.exit(f"the wheel has top-level entries that do not belong there: {strangers}")
wanted = [
    f"evcosim/{path.relative_to(root).as_posix()}"
    for folder in ("models", "fmus", "cosim", "master")
    for path in (root / folder).rglob("*")
    if path.is_file() and "__pycache__" not in path.parts
]
missing = sorted(set(wanted) - set(names))
if missing:
    sys.exit(f"the wheel lacks {missing}")
print(f"wheel: {len(names)} files, only evcosim/ and metadata at the top level, none missing")
