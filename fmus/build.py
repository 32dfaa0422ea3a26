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
from importlib import import_module
from pathlib import Path

from . import cache, records, runtime
from .catalog import CATALOG, Experiment
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
) -> Path:
    """Write `folder/<class name>.fmu` of a model of one's own, and return its path.

    `model` is a subclass of evcosim.models.base.Model. The docstring of `sources` lists which of the user's
    files are embedded. `version` and `license` are those of the model, and are left out where empty. Raises
    ValueError for sources that cannot be embedded and for unknown units, OSError. The user's cache notes its
    digest, so that evcosim runs it in its own process as it does the built-in ones.
    """
    module, file = file_of(model.__module__)
    recipe = recipe_of(model.__qualname__, module, file, experiment or Experiment(), version, license)
    content = _content(recipe, model)
    path = cache.write(Path(folder) / f"{recipe.name}.fmu", content)
    records.note(content, recipe.name, own_roots(module, file).folder)
    return path


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
