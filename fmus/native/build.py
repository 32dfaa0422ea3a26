"""Native FMUs of built-in models in the user's cache, and of a model of one's own.

What takes long is done once: the FMU is kept by the digest of all that goes into it, and so is the reason why
there is none, and the outcome of the comparison with the model in Python. What is there already is found
without the model, the translator and a compiler. What is not is made with a library that a wheel has shipped
for these very sources, or else compiled.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from .. import cache, records
from ..recipes import Recipe, catalog_digests, catalog_recipe, digest_of
from .basis import mathematical_library, python_minor
from .errors import NoNativeError, ToolchainError, Unsupported
from .wanted import DEFAULT, Wanted

if TYPE_CHECKING:
    from ...models.base import Model
    from .package import NativeParts

_HERE = Path(__file__).parent


def native_built(name: str, anew: bool = False, wanted: Wanted = DEFAULT) -> Path:
    """Return the native FMU of a built-in model's present sources in the cache, built first if it is missing.

    With `anew` it is built in any case. Raises Unsupported for a model that has no native form,
    ToolchainError where it cannot be compiled, ValueError for an unknown name.
    """
    digest = _digest(catalog_digests(name).model)
    kind = Wanted(False, wanted.platforms, wanted.fmi)
    key = _short(digest.encode(), b"%d" % python_minor(), repr(kind).encode())
    entry = f"{name}_native_{key[:12]}.fmu"
    path = cache.fetch(entry, lambda: _made(name, digest, anew, wanted), anew)
    if path.parent == cache.folder() and not records.is_own(cache.digest_of(path)):
        # its record was damaged or removed: without one it would be a stranger's for good
        return cache.fetch(entry, lambda: _made(name, digest, anew, wanted), anew=True)
    return path


def why_not(name: str) -> str:
    """Return why a built-in model has no native FMU here, "" where it has one. Raises ValueError."""
    try:
        native_built(name)
    except NoNativeError as error:
        return str(error)
    return ""


def difference(name: str, steps: int = 1000) -> str:
    """Return the first difference of a built-in model's native FMU from Python, or "".

    Both take so many random steps. The outcome is kept by what it depends on: the file's digest, the version
    of Python and the mathematical library. Raises what `native_built` raises.
    """
    path = native_built(name)
    about = (cache.digest_of(path), sys.version, steps, *mathematical_library())
    entry = f"native-bits-{name}-{_short(repr(about).encode())}"
    kept = cache.load(entry)
    if kept is None:
        kept = _compared(name, path, steps).encode()
        cache.keep(entry, kept)
    return kept.decode()


def native_parts(recipe: Recipe, model: type[Model]) -> NativeParts:
    """Return what the native FMU of a recipe's model is made of. Raises Unsupported."""
    return _parts(recipe, model, _digest(recipe.model_digest))


def content_of(
    recipe: Recipe, model: type[Model] | None = None, wanted: Wanted = DEFAULT, folder: Path | None = None
) -> bytes:
    """Return the bytes of the native FMU of a recipe's model, which are noted as built here.

    `folder` is that of the files of a model of the user's own. Raises Unsupported, ToolchainError, ValueError
    for an unknown unit of measure or another version of FMI.
    """
    _require_libraries(wanted, built_in=model is None)
    return _noted(native_parts(recipe, model or _model(recipe)), wanted, folder)


def _require_libraries(wanted: Wanted, built_in: bool) -> None:
    """Raise ToolchainError for a platform that is unknown, or for which nothing makes libraries here.

    Those of built-in models may be shipped.
    """
    from .shipped import offers
    from .toolchain import compiler, targets

    for target in targets(wanted.platforms):
        if not (built_in and offers(target)):
            compiler(target)


def _noted(parts: NativeParts, wanted: Wanted, folder: Path | None = None) -> bytes:
    from .package import native_made

    made = native_made(parts, platforms=wanted.platforms, fmi=wanted.fmi)
    records.note(made.content, parts.model.__name__, folder, made.library)
    return made.content


def extracted_library(path: Path, folder: Path) -> Path:
    """Write the library for this machine of a native FMU of FMI 2.0 into a folder, and return its path."""
    import zipfile

    from .toolchain import here

    with zipfile.ZipFile(path) as archive:
        (entry,) = (n for n in archive.namelist() if n.startswith(f"binaries/{here().fmi2}/"))
        return Path(archive.extract(entry, folder))


def _made(name: str, digest: str, anew: bool, wanted: Wanted) -> bytes:
    """Return the bytes of a built-in model's native FMU. Raises what `native_built` raises.

    What was refused is not tried again, with the same compiler.
    """
    _require_libraries(wanted, built_in=True)  # without one, nothing is imported and lowered in vain
    left, failed = f"native-left-{digest}", f"native-failed-{_short(digest.encode(), *_compilers(wanted))}"
    for entry, kind in ((left, Unsupported), (failed, ToolchainError)):
        if not anew and (kept := cache.load(entry)) is not None:
            raise kind(kept.decode())
    recipe = catalog_recipe(name)
    try:
        return _noted(_parts(recipe, _model(recipe), digest), wanted)
    except NoNativeError as error:
        cache.keep(failed if isinstance(error, ToolchainError) else left, str(error).encode())
        raise


def _compilers(wanted: Wanted) -> Iterator[bytes]:
    """Return what changes with the version of Python, with a compiler's command and with its file."""
    import shutil

    from .shipped import offers
    from .toolchain import compiler, targets

    yield b"%d" % python_minor()
    for target in targets(wanted.platforms):
        try:
            command = compiler(target)
        except ToolchainError:  # a library may be shipped
            command = [""]
        found = shutil.which(command[0])
        yield repr(
            (wanted.fmi, offers(target), command, found and cache.state(Path(found).resolve()))
        ).encode()


def _compared(name: str, path: Path, steps: int) -> str:
    """Return the first difference of a file from the model in Python. Raises OSError, RuntimeError."""
    from .check import first_difference
    from .package import token_of

    token = token_of(_digest(catalog_digests(name).model))
    with cache.temporary_folder() as folder:
        library = extracted_library(path, folder)
        return first_difference(_model(catalog_recipe(name)), library, token, steps)


def sources_by_version(name: str) -> dict[int, str]:
    """Return the C of a built-in model for each minor version of Python 3. Raises Unsupported, ValueError."""
    from . import emit, lower, package
    from .basis import MINORS

    recipe = catalog_recipe(name)
    model, digest = _model(recipe), _digest(recipe.model_digest)
    program, given = lower.lower(model), (package.identity_of(name, digest), package.token_of(digest))
    return {minor: emit.c_source(model, program, *given, minor) for minor in MINORS}


def _parts(recipe: Recipe, model: type[Model], digest: str) -> NativeParts:
    from . import emit, lower, package

    identity, token = package.identity_of(recipe.name, digest), package.token_of(digest)
    source = emit.c_source(model, lower.lower(model), identity, token)
    about = recipe.experiment, recipe.version, recipe.license, recipe.python_files
    return package.NativeParts(model, source, digest, *about)


def _model(recipe: Recipe) -> type[Model]:
    model: type[Model] = getattr(import_module(recipe.module), recipe.name)
    return model


def _digest(model_digest: str) -> str:
    """Return the digest of a native FMU by that of its recipe's model: also of translator and runtime.

    It is the same for every version of Python, so that a library can be shipped for several.
    """
    return _short(model_digest.encode(), _own_code(_HERE).encode())


@functools.cache
def _own_code(folder: Path) -> str:
    """Return the digest of what makes a native FMU, Python and C; `folder` is that of this package."""
    files = sorted([*folder.glob("*.py"), *(folder / "c").glob("*.[ch]")])
    return digest_of([part for file in files for part in (file.name.encode(), file.read_bytes())])


def _short(*parts: bytes) -> str:
    """Return 32 hexadecimal digits of the digest of parts."""
    return digest_of(parts)[:32]
