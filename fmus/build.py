"""Build FMUs: `build` into a folder, `built` through the cache, `build_model` from a model of one's own.

    modelDescription.xml
    binaries/<platform>/<Name>.<so|dll>            pythonfmu's native library
    documentation/licenses/*.txt
    resources/slavemodule.txt                      names the next file
    resources/<Name>_<digest>_slave.py             what pythonfmu imports
    resources/<Name>_<digest>/entry.py             joins model and slave
    resources/<Name>_<digest>/evcosim/...          the model's sources, and the user's own beside them
    resources/<Name>_<digest>/pythonfmu/...

The digest is that of everything that goes in and of the code of this package, which puts it together; it also
gives the guid (recipes). The same sources give the same bytes.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Literal, NamedTuple

from . import cache, records, runtime
from .catalog import CATALOG, Experiment
from .native.errors import Unsupported
from .native.wanted import Wanted
from .recipes import Recipe, catalog_identity, catalog_recipe, recipe_of
from .sources import file_of, own_roots, rewritten

_ENTRY = '''\
"""The slave class of this FMU."""

{imports}
from .pythonfmu.fmi2slave import Fmi2Slave
from .evcosim.fmus.slave import ModelSlave
from .{module} import {name} as Model


class {name}(ModelSlave, Fmi2Slave):
    model = Model
    identity = "{identity}"
'''

_SLAVE = '''\
"""pythonfmu imports this module by its name and, for every instance, runs its text once more."""

import ctypes
import os
import sys


def _settle():
    """Without an instance nobody else lets the library release its interpreter in time (repairs.py)."""
    from {identity}.evcosim.fmus.repairs import settle_at_exit

    settle_at_exit(os.path.dirname(os.path.abspath(__file__)), "{name}")


_PYTHON = "%d.%d.%d in %s" % (sys.version_info[0], sys.version_info[1], sys.version_info[2], sys.prefix)
if sys.version_info < {python}:
    if hasattr(sys, "orig_argv"):  # since Python 3.10; an older one cannot import that file
        _settle()
    raise ImportError("{name}.fmu needs Python {least} or newer; this importer runs Python " + _PYTHON)
try:
{needed}
    from {identity}.entry import {name}
except ImportError as error:
    _settle()
    raise ImportError(
        "{name}.fmu needs a Python package that Python %s does not have (%s); pip installs it there"
        % (_PYTHON, error)
    )

# For every instance, pythonfmu also gives up a reference to this module's globals that it does not own.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))
'''

_PYTHON = (3, 11)
_PACKAGES = ("numpy", "scipy")
"""The packages beside Python's own that a model may import, maybe in a function only; ours import none."""


def names() -> tuple[str, ...]:
    """Return the names of the FMUs that `build` and `built` know, in the catalog's order."""
    return tuple(CATALOG)


def build(name: str, folder: str | Path) -> Path:
    """Write `folder/<name>.fmu` and return its path. Raises ValueError for an unknown name, OSError."""
    return cache.write(Path(folder) / f"{name}.fmu", _content(catalog_recipe(name)))


def built(name: str, anew: bool = False) -> Path:
    """Return the FMU of the present sources in the user's cache, built first if it is missing or damaged.

    With `anew` it is built in any case. Raises ValueError for an unknown name.
    """
    return cache.fetch(f"{catalog_identity(name)}.fmu", lambda: _content(catalog_recipe(name)), anew)


def build_model(
    model: type,
    folder: str | Path,
    *,
    experiment: Experiment | None = None,
    version: str = "",
    license: str = "",
    native: bool | Literal["require"] = False,
    platforms: Sequence[str] = (),
    fmi: int = 2,
) -> Path:
    """Write `folder/<class name>.fmu` of a model of one's own, and return its path.

    `model` is a subclass of evcosim.models.base.Model. The docstring of `sources` lists which of the user's
    files are embedded. `version` and `license` are those of the model, and are left out where empty. Raises
    ValueError for sources that cannot be embedded and for unknown units, OSError. The user's cache notes its
    digest, so that evcosim runs it in its own process as it does the built-in ones.

    With `native` it is machine code for these `platforms` ("linux64", "win64", "darwin64", "aarch64-linux",
    "aarch64-darwin"; default: this machine's), of FMI 2.0 or 3.0. A model that has no native form is left in
    Python, with a warning that names file, line, construct and what to write instead; with "require" that is
    a ValueError. One too is a compiler that is missing or fails.
    """
    if native not in (False, True, "require"):
        raise ValueError(f"native = {native!r}: it is True, False or 'require'")
    if not native and (platforms or fmi != 2):
        raise ValueError("platforms and fmi are those of native FMUs: add native=True")
    wanted = Wanted(native == "require", tuple(platforms), fmi) if native else None
    made = made_of(model, experiment, version, license, wanted)
    if made.left:
        warnings.warn(f"{made.name}: left in Python, because {made.left}", stacklevel=2)
    return cache.write(Path(folder) / f"{made.name}.fmu", made.content)


class Made(NamedTuple):
    """The bytes of an FMU; `left` is why they hold Python though machine code was wanted, else ""."""

    name: str
    content: bytes
    left: str = ""


def made_of(
    model: type,
    experiment: Experiment | None = None,
    version: str = "",
    license: str = "",
    wanted: Wanted | None = None,
) -> Made:
    """Return the FMU of a model of one's own, noted as built here. Raises what `build_model` raises."""
    module, file = file_of(model.__module__)
    recipe = recipe_of(model.__qualname__, module, file, experiment or Experiment(), version, license)
    left, folder = "", own_roots(module, file).folder
    if wanted is not None:
        from .native.build import content_of

        try:
            return Made(recipe.name, content_of(recipe, model, wanted, folder))
        except Unsupported as error:
            if wanted.require:
                raise
            left = str(error)
    content = _content(recipe, model)
    records.note(content, recipe.name, folder)
    return Made(recipe.name, content, left)


def build_native(name: str, folder: Path | None, wanted: Wanted) -> tuple[Path, str]:
    """Write the native FMU of a built-in model into a folder (default: the cache, anew).

    Return its path, and why it was left in Python or "". Raises ValueError for an unknown name, for what
    `wanted` requires and cannot be had, and where a compiler is missing or fails; OSError.
    """
    from .native.build import content_of, native_built

    try:
        if folder is None:
            return native_built(name, anew=True, wanted=wanted), ""
        content = content_of(catalog_recipe(name), None, wanted)
    except Unsupported as error:
        if wanted.require:
            raise
        return built(name, anew=True) if folder is None else build(name, folder), str(error)
    return cache.write(folder / f"{name}.fmu", content), ""


def _content(recipe: Recipe, model: type | None = None) -> bytes:
    """Return the FMU's bytes. A catalog model is imported only now, for its declarations."""
    import uuid  # this and the two below are slow to import, and a run that finds its FMUs builds nothing

    from .archive import packed
    from .description import Origin, describe

    if model is None:
        model = getattr(import_module(recipe.module), recipe.name)
    origin = Origin(
        guid="{" + str(uuid.UUID(recipe.digest)) + "}",
        tool=f"evcosim {runtime.version('evcosim')} with pythonfmu {runtime.version('pythonfmu')}",
        version=recipe.version,
        license=recipe.license,
    )
    entries = {"modelDescription.xml": describe(model, origin, recipe.experiment)}
    for place, content in runtime.binaries().items():
        platform, _, suffix = place.partition("/")
        entries[f"binaries/{platform}/{recipe.name}{suffix}"] = content
    for file, content in runtime.licenses().items():
        entries[f"documentation/licenses/{file}"] = content
    entries.update({f"resources/{path}": content for path, content in _resources(recipe).items()})
    return packed(entries)


def _resources(recipe: Recipe) -> dict[str, bytes]:
    package = recipe.identity
    embedded = {source.module for source in recipe.sources}
    # All modules are imported at once: a folder that was unpacked for the first instance may be gone later.
    imports = "\n".join(f"from . import {m}" if "." not in m else _import_line(m) for m in sorted(embedded))
    fields = {
        "name": recipe.name,
        "identity": package,
        "module": recipe.module,
        "imports": imports,
        "python": repr(_PYTHON),
        "least": ".".join(map(str, _PYTHON)),
        "needed": "\n".join(f"    import {p}" for p in _needed(recipe)) or "    pass",
    }
    files = {
        "slavemodule.txt": f"{package}_slave\n".encode(),
        f"{package}_slave.py": _SLAVE.format(**fields).encode(),
        f"{package}/__init__.py": b"",
        f"{package}/entry.py": _ENTRY.format(**fields).encode(),
        f"{package}/evcosim/__init__.py": b"",
        f"{package}/pythonfmu/__init__.py": b"",
    }
    for source in recipe.sources:
        files[f"{package}/{source.path}"] = rewritten(source, package, embedded)
    for file, content in runtime.python_files().items():
        files[f"{package}/pythonfmu/{file}"] = content
    return files


def _needed(recipe: Recipe) -> list[str]:
    """Return which of `_PACKAGES` the sources import, wherever that stands in them."""
    text = b"\n".join(source.content for source in recipe.sources).decode()
    return [p for p in _PACKAGES if re.search(rf"^\s*(import|from) {p}\b", text, re.MULTILINE)]


def _import_line(module: str) -> str:
    parent, _, last = module.rpartition(".")
    return f"from .{parent} import {last}"
