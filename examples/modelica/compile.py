"""Compile a Modelica model into an FMU beside it: python compile.py Scooter.mo [fmi2 | fmi3].

Needs rumoca (`pip install rumoca==0.9.13`) and a C compiler. rumoca makes the model description and the C
source; what is left is to compile the one and to pack both.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import rumoca

LIBRARY = {"fmi2": "binaries/linux64/{}.so", "fmi3": "binaries/x86_64-linux/{}.so"}


def compiled(model: Path, folder: Path, target: str = "fmi2") -> Path:
    """Make the FMU of a .mo file in `folder`; its path. `target` is fmi2 or fmi3."""
    fmu = folder / f"{model.stem}.fmu"
    with tempfile.TemporaryDirectory() as made:
        rumoca.load(str(model)).codegen(target).save_all(made)
        library = Path(made) / LIBRARY[target].format(model.stem)
        library.parent.mkdir(parents=True)
        source = Path(made) / "sources" / f"{model.stem}.c"
        subprocess.run(["cc", "-shared", "-fPIC", "-O2", "-w", source, "-o", library, "-lm"], check=True)
        with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(p for p in Path(made).rglob("*") if p.is_file()):
                archive.write(path, path.relative_to(made).as_posix())
    return fmu


if __name__ == "__main__":
    print(compiled(Path(sys.argv[1]), Path(), *sys.argv[2:]))
