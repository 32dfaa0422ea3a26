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
gives the guid. The same sources give the same bytes.
"""

from __future__ import annotations

import functools
import hashlib
import re
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from . import cache, runtime
from .catalog import CATALOG, Experiment, model_file
from .sources import Source, collect, file_of, models_folder, own_roots, rewritten

_OWN_LICENSE = "MIT"
_HERE = Path(__file__).parent

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
"""The packages beside Python's own that a model of ours imports, some of them in a function only."""


class Recipe(NamedTuple):
    """The ingredients of an FMU, known without importing the model; `digest` has 32 hexadecimal digits."""

    name: str
    module: str
    sources: tuple[Source, ...]
    experiment: Experiment
    version: str
    license: str
    digest: str

    @property
    def identity(self) -> str:
        """Name of the package inside the FMU, which stands for this version of the model."""
        return f"{self.name}_{self.digest[:12]}"


def names() -> tuple[str, ...]:
    """Return the names of the FMUs that `build` and `built` know, in the catalog's order."""
    return tuple(CATALOG)


def build(name: str, folder: str | Path) -> Path:
    """Write `folder/<name>.fmu` and return its path. Raises ValueError for an unknown name, OSError."""
    return cache.write(Path(folder) / f"{name}.fmu", _content(_catalog_recipe(name)))


def built(name: str, anew: bool = False) -> Path:
    """Return the FMU of the present sources in the user's cache, built first if it is missing or damaged.

    With `anew` it is built in any case. Raises ValueError for an unknown name.
    """
    return cache.fetch(f"{_identity(name)}.fmu", lambda: _content(_catalog_recipe(name)), anew)


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
    recipe = _recipe(model.__qualname__, module, file, experiment or Experiment(), version, license)
    content = _content(recipe, model)
    path = cache.write(Path(folder) / f"{recipe.name}.fmu", content)
    noted = f"{recipe.name}\n{own_roots(module, file).folder}\n"
    cache.keep(_record(hashlib.sha256(content).hexdigest()), noted.encode("utf-8", "surrogateescape"))
    return path


def is_own(digest: str) -> bool:
    """Return True if `build_model` made the file of this SHA-256 for this user on this machine.

    The record of it is in the user's cache, which is trusted as its docstring says. Without a cache that can
    be used there is none, and the FMU counts as anybody's.
    """
    return cache.load(_record(digest)) is not None


def folder_of(digest: str) -> list[Path]:
    """Return the folder of the files of which `build_model` made the FMU of a SHA-256, if it is known."""
    noted = (cache.load(_record(digest)) or b"").decode("utf-8", "surrogateescape").split("\n")
    return [Path(noted[1])] if len(noted) > 1 and noted[1] else []


def _record(digest: str) -> str:
    """Return the name in the cache that notes the FMU of a SHA-256 as built here."""
    return f"built-here-{digest}"


def _identity(name: str) -> str:
    """Return the identity of a catalog FMU, as its recipe says; the cache keeps it by all that may change it.

    To follow the import statements of a model takes longer than all the rest of finding its FMU.
    Raises ValueError for an unknown name.
    """
    if name not in CATALOG:
        return _catalog_recipe(name).identity
    about = repr((name, CATALOG[name], _common(_HERE, runtime.version("evcosim")), _models(models_folder())))
    if about not in _identities:
        entry = f"identity-{name}-{hashlib.sha256(about.encode()).hexdigest()[:16]}"
        kept = (cache.load(entry) or b"").decode("ascii", "replace")
        if not re.fullmatch(rf"{name}_[0-9a-f]{{12}}", kept):
            kept = _catalog_recipe(name).identity
            cache.keep(entry, kept.encode())  # a cache that keeps nothing is told with the FMU
        _identities[about] = kept
    return _identities[about]


_identities: dict[str, str] = {}


@functools.cache
def _common(folder: Path, version: str) -> str:
    """Return a digest of what all FMUs have in common; `folder` is that of this package."""
    parts = runtime.binaries(), runtime.python_files(), runtime.licenses()
    return _digest([version.encode(), *_flat(_own_code(folder)), *(p for part in parts for p in _flat(part))])


_digests: dict[Path, tuple[object, str]] = {}


def _models(folder: Path) -> str:
    """Return a digest of the models of this package, read again where one was written since."""
    files = sorted(folder.rglob("*.py"))
    state = [(file, cache.settled(file)) for file in files]
    before, digest = _digests.get(folder, (None, ""))
    if before != state or not all(about for _, about in state):
        digest = _digest([part for file in files for part in (str(file).encode(), file.read_bytes())])
        _digests[folder] = state, digest
    return digest


def _catalog_recipe(name: str) -> Recipe:
    if name not in CATALOG:
        import difflib  # slow to import

        near = difflib.get_close_matches(name, CATALOG, n=1, cutoff=0.5)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        raise ValueError(f"there is no built-in FMU {name!r}{hint}; there are {', '.join(CATALOG)}")
    entry = CATALOG[name]
    module = f"evcosim.models.{entry.module}"
    version = runtime.version("evcosim")
    return _recipe(name, module, model_file(name), entry.experiment, version, _OWN_LICENSE)


def _recipe(name: str, module: str, file: Path, experiment: Experiment, version: str, license: str) -> Recipe:
    if not (name.isidentifier() and name.isascii()):
        raise ValueError(f"{name}: an FMU is built from a class at the top of its module, with an ASCII name")
    sources = tuple(collect(module, file))
    about = (name, module, experiment, version, license, runtime.version("evcosim"))
    digest = _digest(
        [
            repr(about).encode(),
            *(part for source in sources for part in (source.path.encode(), source.content)),
            *_flat(_own_code(_HERE)),
            *_flat(runtime.binaries()),
            *_flat(runtime.python_files()),
            *_flat(runtime.licenses()),
        ]
    )
    return Recipe(name, module, sources, experiment, version, license, digest[:32])


def _digest(parts: Iterable[bytes]) -> str:
    """Return SHA-256 of parts, each with its length."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "big"))
        digest.update(part)
    return digest.hexdigest()


@functools.cache
def _own_code(folder: Path) -> dict[str, bytes]:
    """Return every module that may decide on the bytes of an FMU of Python, by its path: all but `native`."""
    files = sorted(file for file in folder.rglob("*.py") if folder / "native" not in file.parents)
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


def _flat(files: dict[str, bytes]) -> list[bytes]:
    return [part for name, content in files.items() for part in (name.encode(), content)]


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
