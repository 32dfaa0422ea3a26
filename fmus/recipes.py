"""Recipes of FMUs: all that goes into one, known without importing the model, and its digest.

There are two: `model_digest` of the model's sources and of the code of this package, which puts the FMU
together, and `digest` of that and of pythonfmu's parts, for FMUs of Python. Equal recipes give equal bytes.
"""

from __future__ import annotations

import functools
import hashlib
import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from . import cache, runtime
from .catalog import CATALOG, Experiment, model_file
from .sources import Source, collect, models_folder

PYTHON_FILES = "sources/python_files.txt"
"""The entry of a native FMU that names the files of a user's own model, with digests, as `sha256sum` does."""

_OWN_LICENSE = "MIT"
_HERE = Path(__file__).parent


class Digests(NamedTuple):
    """The digests of a recipe, each of 32 hexadecimal digits."""

    fmu: str
    model: str


class Recipe(NamedTuple):
    """The ingredients of an FMU, known without importing the model; digests have 32 hexadecimal digits."""

    name: str
    module: str
    sources: tuple[Source, ...]
    experiment: Experiment
    version: str
    license: str
    model_digest: str

    @property
    def digest(self) -> str:
        """The digest of the FMU of Python: of pythonfmu's parts too, which must be installed."""
        return digest_of([self.model_digest.encode(), _pythonfmu().encode()])[:32]

    @property
    def digests(self) -> Digests:
        """Both digests."""
        return Digests(self.digest, self.model_digest)

    @property
    def identity(self) -> str:
        """Name of the package inside the FMU of Python."""
        return identity_of(self.name, self.digest)

    @property
    def python_files(self) -> str:
        """The content of `PYTHON_FILES`, the model's file first; "" for a built-in model."""
        own = [each for each in self.sources if each.module.partition(".")[0] != "evcosim"]
        own.sort(key=lambda each: (each.module != self.module, each.path))
        return "".join(f"{hashlib.sha256(each.content).hexdigest()}  {each.path}\n" for each in own)


def catalog_identity(name: str) -> str:
    """Return the identity of a catalog FMU, as its recipe says. Raises ValueError for an unknown name."""
    return identity_of(name, catalog_digests(name).fmu)


def catalog_digests(name: str) -> Digests:
    """Return the digests of a catalog FMU's recipe; the cache keeps them by all that may change them.

    To follow the import statements of a model takes longer than all the rest of finding its FMU.
    Raises ValueError for an unknown name.
    """
    if name not in CATALOG:
        return catalog_recipe(name).digests
    folder = models_folder()
    models = cache.once(folder, lambda: _models(folder))
    about = repr((name, CATALOG[name], _common(_HERE, runtime.version("evcosim")), models))
    if about not in _found:
        entry = f"digests-{name}-{hashlib.sha256(about.encode()).hexdigest()[:16]}"
        kept = (cache.load(entry) or b"").decode("ascii", "replace")
        if not re.fullmatch(f"{name} [0-9a-f]{{32}} [0-9a-f]{{32}}", kept):
            kept = " ".join((name, *catalog_recipe(name).digests))
            cache.keep(entry, kept.encode())  # a cache that keeps nothing is told with the FMU
        _found[about] = Digests(*kept.split()[1:])
    return _found[about]


_found: dict[str, Digests] = {}


def identity_of(name: str, digest: str) -> str:
    """Return the name of the package inside an FMU of Python, which stands for this version of the model."""
    return f"{name}_{digest[:12]}"


@functools.cache
def _common(folder: Path, version: str) -> str:
    """Return a digest of what all FMUs have in common; `folder` is that of this package."""
    return digest_of([version.encode(), *_flat(own_code(folder)), _pythonfmu().encode()])


@functools.cache
def _pythonfmu() -> str:
    """Return a digest of pythonfmu's parts of an FMU, and of the licenses."""
    parts = runtime.binaries(), runtime.python_files(), runtime.licenses()
    about = [runtime.version("pythonfmu").encode(), *(p for part in parts for p in _flat(part))]
    return digest_of(about)


_digests: dict[Path, tuple[object, str]] = {}


def _models(folder: Path) -> str:
    """Return a digest of the models of this package, read again where one was written since."""
    names = (os.path.join(where, name) for where, _, found in os.walk(folder) for name in found)
    files = sorted(name for name in names if name.endswith(".py"))
    state = [(file, cache.settled(file)) for file in files]
    before, digest = _digests.get(folder, (None, ""))
    if before != state or not all(about for _, about in state):
        digest = digest_of([part for file in files for part in (os.fsencode(file), Path(file).read_bytes())])
        _digests[folder] = state, digest
    return digest


def catalog_recipe(name: str) -> Recipe:
    """Return the recipe of a built-in FMU. Raises ValueError for an unknown name, with the nearest one."""
    if name not in CATALOG:
        import difflib  # slow to import

        near = difflib.get_close_matches(name, CATALOG, n=1, cutoff=0.5)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        raise ValueError(f"there is no built-in FMU {name!r}{hint}; there are {', '.join(CATALOG)}")
    entry = CATALOG[name]
    module = f"evcosim.models.{entry.module}"
    version = runtime.version("evcosim")
    return recipe_of(name, module, model_file(name), entry.experiment, version, _OWN_LICENSE)


def recipe_of(
    name: str, module: str, file: Path, experiment: Experiment, version: str, license: str
) -> Recipe:
    """Return the recipe of a model in a file. Raises ValueError for one that cannot go into an FMU."""
    if not (name.isidentifier() and name.isascii()):
        raise ValueError(f"{name}: an FMU is built from a class at the top of its module, with an ASCII name")
    sources = tuple(collect(module, file))
    about = (name, module, experiment, version, license, runtime.version("evcosim"))
    digest = digest_of(
        [
            repr(about).encode(),
            *(part for source in sources for part in (source.path.encode(), source.content)),
            *_flat(own_code(_HERE)),
            runtime.license_text("evcosim"),
        ]
    )
    return Recipe(name, module, sources, experiment, version, license, digest[:32])


def digest_of(parts: Iterable[bytes]) -> str:
    """Return SHA-256 of parts, each with its length."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "big"))
        digest.update(part)
    return digest.hexdigest()


@functools.cache
def own_code(folder: Path) -> dict[str, bytes]:
    """Return every module that may decide on the bytes of an FMU of Python, by its path: all but `native`."""
    files = sorted(file for file in folder.rglob("*.py") if folder / "native" not in file.parents)
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


def _flat(files: dict[str, bytes]) -> list[bytes]:
    return [part for name, content in files.items() for part in (name.encode(), content)]
