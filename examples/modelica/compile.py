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

LIBRARY = {"fmi2": "binaries/linux64/{}.so", "fmi3": "binaries/x86_64-linux/{}.so"}


def compiled(model: Path, folder: Path, target: str = "fmi2") -> Path:
    """Make the FMU of a .mo file in `folder`; its path. `target` is fmi2 or fmi3."""
    import rumoca

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


def main(arguments: list[str]) -> str:
    """Compile what is asked for, and return the FMU's name. Exits with a sentence where that cannot be."""
    if not arguments or not Path(arguments[0]).is_file():
        sys.exit(
            f"{' '.join(arguments[:1]) or 'a model'}: there is no such file; python compile.py Scooter.mo"
        )
    try:
        return str(compiled(Path(arguments[0]), Path(), *arguments[1:2]))
    except ImportError as error:
        sys.exit(f"{error}; in this Python: python -m pip install rumoca==0.9.13")
    except FileNotFoundError as error:
        sys.exit(f"{error.filename}: a C compiler of this name is needed")


if __name__ == "__main__":
    print(main(sys.argv[1:]))
