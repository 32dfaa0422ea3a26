"""Build FMUs of the models in a Python file of the user's own."""

from __future__ import annotations

import contextlib
import importlib
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from . import cache
from .build import made_of
from .catalog import CATALOG, Experiment, model_file
from .native.wanted import Wanted
from .outdated import model_files


def build_file(path: Path, folder: Path | None = None) -> list[Path]:
    """Write an FMU of each model that a Python file defines, and return their paths.

    `folder` is where they go (default: beside the file). The file is run, as `import` runs it. Raises
    ValueError for a file that cannot be imported, or that defines no model, and for models that cannot be
    built; OSError.
    """
    return [path for path, _ in build_wanted(path, folder, None)]


def build_wanted(path: Path, folder: Path | None, wanted: Wanted | None) -> list[tuple[Path, str]]:
    """Write the FMUs of `build_file`, in machine code where that is wanted.

    Return their paths, each with the reason why it was left in Python or "". All are made before one is
    written. Raises what `build_file` raises, and ValueError for what `wanted` requires and cannot be had.
    """
    from ..models.base import Model

    path = path.resolve()
    with _imported(path) as module:
        own = [
            each
            for each in vars(module).values()
            if isinstance(each, type) and issubclass(each, Model) and each.__module__ == module.__name__
        ]
        if not own:
            raise ValueError("defines no model: a model derives from evcosim.models.base.Model")
        where = folder or path.parent
        for each in own:
            _check_free(where / f"{each.__name__}.fmu", path)
        made = [made_of(each, _experiment(each.__name__), wanted=wanted) for each in own]
    return [(cache.write(where / f"{each.name}.fmu", each.content), each.left) for each in made]


def _check_free(fmu: Path, path: Path) -> None:
    """Raise ValueError where the FMU is that of another file, which has a model of the same name."""
    others = model_files(fmu)
    if others and path not in others:
        other = others[0].name if others[0].parent == path.parent else others[0]
        raise ValueError(
            f"{fmu.name} is there already, of {other}: give one of the two models another name, or "
            "build it elsewhere (--output)"
        )


def _experiment(name: str) -> Experiment | None:
    """Return the experiment of a built-in model, for a copy of it; None for a model of another name."""
    return CATALOG[name].experiment if name in CATALOG else None


@contextlib.contextmanager
def _imported(path: Path) -> Iterator[ModuleType]:
    """Import a file by its name, with the files beside it, and forget all of them at the end."""
    if not path.stem.isidentifier():
        raise ValueError("the name of a Python module is made of letters, digits and '_'")
    before = set(sys.modules)
    taken = f"Python has a module '{path.stem}' already; give the file another name"
    if path.stem in before:
        raise ValueError(taken)
    sys.path.insert(0, str(path.parent))
    importlib.invalidate_caches()
    try:
        module = importlib.import_module(path.stem)
        if Path(module.__file__ or "").resolve() != path:
            raise ValueError(taken)
        yield module
    except (ValueError, OSError):
        raise
    except Exception as error:  # whatever the user's code raises
        raise ValueError(f"cannot be imported: {_last_line(error, path)}") from error
    finally:
        sys.path.remove(str(path.parent))
        for name in set(sys.modules) - before:
            file = getattr(sys.modules[name], "__file__", None)
            if file is not None and Path(file).resolve().parent == path.parent:
                del sys.modules[name]


def _last_line(error: Exception, path: Path) -> str:
    """Return what an error says, with the line of the file in which it arose."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == str(path)]
    line = error.lineno if isinstance(error, SyntaxError) else (lines[-1] if lines else None)
    said = error.msg if isinstance(error, SyntaxError) else f"{type(error).__name__}: {error}"
    return f"line {line}: {said}" if line is not None else said


def model_source(name: str) -> tuple[str, str]:
    """Return the file name and the text of a built-in model, so that it can stand outside of evcosim."""
    file = model_file(name)
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    return file.name, "".join(
        line.replace("from .", "from evcosim.models.", 1) if line.startswith("from .") else line
        for line in lines
    )
