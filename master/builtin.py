"""The files of FMUs by the names that system files give them; built-in ones come from `evcosim.fmus`.

This is the one module of the master that knows the package of FMUs.
"""

from __future__ import annotations

import contextlib
import contextvars
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..cosim.errors import ConfigError, nearest, short
from ..cosim.file_names import check_name, near_file
from ..cosim.reading import is_file
from ..cosim.writing import reason

if TYPE_CHECKING:  # the process of an isolated unit in C imports nothing of the FMUs in Python
    from ..fmus.native.wanted import Wanted as Wanted


def builtin_names() -> tuple[str, ...]:
    """Return the names of the FMUs that evcosim builds itself."""
    from ..fmus import build

    return build.names()


def cache_folder() -> Path:
    """Return the folder of built FMUs and of the compiled engine; it need not exist."""
    from ..fmus import cache

    return cache.folder()


def kept(name: str) -> bytes | None:
    """Return what `keep` kept in the cache under a name; None if there is none that can be trusted."""
    from ..fmus import cache

    return cache.load(name)


def keep(name: str, content: bytes) -> str:
    """Keep bytes in the cache under a name, and return "", or the reason why that is impossible."""
    from ..fmus import cache

    return cache.keep(name, content)


def keep_some(name: str, content: bytes, most: int) -> str:
    """Keep bytes as `keep` does, with so many entries at most whose names begin alike, up to the first "-".

    The oldest ones leave the cache.
    """
    from ..fmus import cache

    return cache.keep(name, content) or cache.leave(f"{name.partition('-')[0]}-*", most)


def held_digest(path: Path) -> str:
    """Return the SHA-256 of a file of the cache that is as its record says; "" for any other file."""
    from ..fmus import cache

    with contextlib.suppress(OSError):
        if path.parent == cache.folder() and cache.once(path, lambda: "held" if cache.holds(path) else ""):
            return cache.digest_of(path)
    return ""


def state_of(path: str) -> tuple[int, ...] | None:
    """Return the state of a file, which stays the same until it is written; None if it was just now.

    Raises OSError where there is none.
    """
    from ..fmus import cache

    return cache.settled(Path(path))


def builtin_text(name: str) -> str:
    """Return one line about a built-in FMU."""
    from ..fmus import catalog

    return catalog.text(name)


def is_builtin(name: str, path: Path) -> bool:
    """Return True if the FMU in a file, of this model name, is the one that evcosim builds or a copy of it.

    Equal sources give equal bytes, so that no other file can pass for it.
    """
    from ..fmus import build

    if name not in build.names():
        return False
    built = build.built(name)
    return built == path or built.read_bytes() == path.read_bytes()


def unpacked(path: Path, binary: str) -> Path | None:
    """Return a folder with the files of an FMU, in which nothing may be written; None if it has none.

    Built-in FMUs have one in the cache, with the entry `binary` as their library.
    """
    from ..fmus import unpacked

    return unpacked.unpacked(path, binary)


def is_ours(name: str, path: Path, digest: str) -> bool:
    """Return True for a built-in FMU, and for one that this user built of a model of their own.

    `name` is that of its model, `digest` the SHA-256 of its file. Nobody else's code passes for ours.
    """
    from ..fmus import records

    return records.is_own(digest) or is_builtin(name, path)


def library_of(digest: str) -> str:
    """Return where the machine code of a native FMU came from, by the SHA-256 of its file.

    It is noted in the cache of who built it: "shipped with evcosim" or "compiled by gcc"; "" for any other.
    """
    from ..fmus import records

    return records.library_of(digest)


@contextlib.contextmanager
def looking_once() -> Iterator[None]:
    """Within the `with` block built-in FMUs are looked for once, however many units have them."""
    from ..fmus import cache

    with cache.looking_once():
        yield


def outdated(path: Path, digest: str) -> str:
    """Return a sentence on an FMU whose Python files have been changed since it was built; "" for any other.

    `digest` is the SHA-256 of its file.
    """
    from ..fmus.outdated import changed_source

    found = changed_source(path, digest)
    if found is None:
        return ""
    command = f"evcosim build {shlex.quote(_as_typed(found.model))}{found.options}"
    if path.resolve().parent != found.model.parent:
        command += f" -o {shlex.quote(str(path.parent))}"
    return f"{path} was built before {_as_typed(found.file)} was changed: '{command}' builds it anew"


def _as_typed(file: Path) -> str:
    """Return a path from the working folder if it lies there, else in full."""
    here = Path.cwd()
    return str(file.relative_to(here) if file.is_relative_to(here) else file)


class Built(NamedTuple):
    """An FMU that was built, by name; `left` is why it holds Python though machine code was asked for."""

    name: str
    path: Path
    left: str = ""

    @property
    def library(self) -> str:
        """The origin of the machine code of a native one; "" for any other."""
        from ..fmus import cache

        return library_of(cache.digest_of(self.path))


def wanted(require: bool, platforms: tuple[str, ...], fmi: int) -> Wanted:
    """Return a wish for native FMUs, for `build_fmu` and `build_models`."""
    from ..fmus.native.wanted import Wanted

    return Wanted(require, platforms, fmi)


def build_fmu(name: str, folder: Path | None = None, native: Wanted | None = None) -> Built:
    """Build a built-in FMU into a folder (default: the cache, anew) and return its file.

    Raises ConfigError if the folder cannot be written, and for a native FMU that cannot be had.
    """
    from ..fmus import build

    if folder is not None:
        check_name(folder, f"{name}.fmu cannot be written: ")
    left = ""
    try:
        if native is not None:
            path, left = build.build_native(name, folder, native)
        else:
            path = build.built(name, anew=True) if folder is None else build.build(name, folder)
    except ValueError as error:
        raise ConfigError(*f"{name}: {error}".splitlines()) from error
    except OSError as error:
        where = folder or cache_folder()
        said = reason(where / f"{name}.fmu", error)
        raise ConfigError(f"{where}: {name}.fmu cannot be written: {said}") from error
    if folder is None and path.parent != cache_folder():  # it lasts as long as this process
        raise ConfigError(f"{cache_folder()}: {name}.fmu cannot be kept there; --output DIR builds elsewhere")
    return Built(name, path, left)


def build_models(path: Path, folder: Path | None = None, native: Wanted | None = None) -> list[Built]:
    """Build an FMU of each model in a Python file, beside it or into a folder, and return their files.

    The file is run. Raises ConfigError for what is no such file or cannot be built, and where nothing can be
    written.
    """
    from ..fmus import from_file

    if not is_file(path):
        raise ConfigError(f"{path}: there is no such file{near_file(path)}")
    try:
        made = from_file.build_wanted(path, folder, native)
    except ValueError as error:
        raise ConfigError(*f"{path}: {error}".splitlines()) from error
    except OSError as error:
        where = folder or path.parent
        raise ConfigError(f"{where}: an FMU cannot be written: {reason(where, error)}") from error
    return [Built(file.stem, file, left) for file, left in made]


def model_source(name: str) -> tuple[str, str]:
    """Return the file name and the text of the model of a built-in FMU, to be copied and changed."""
    from ..fmus import from_file

    return from_file.model_source(name)


def by_names(text: str) -> str:
    """Return a message in which the files of built-in FMUs, which are in the cache, are their names."""
    from ..fmus import cache

    folders = "|".join(re.escape(str(each)) for each in cache.folders())
    return re.sub(rf"(?:{folders})[/\\](\w+?)(?:_native)?_[0-9a-f]{{12}}\.fmu", r"\1", text)


@contextlib.contextmanager
def units_run(kind: str | None) -> Iterator[None]:
    """Let built-in FMUs run as `kind` (a UnitsName) where nobody says otherwise; None changes nothing."""
    token = _KIND.set(kind or _KIND.get())
    try:
        yield
    finally:
        _KIND.reset(token)


_KIND: contextvars.ContextVar[str] = contextvars.ContextVar("kind of units", default="python")


def left_in_python(name: str) -> str:
    """Return why a built-in FMU runs in Python where the kind of units is "auto"; "" for one that is native.

    The first time a model is compiled and compared with itself in Python; the cache keeps the outcome.
    """
    from ..fmus.native import build

    return build.why_not(name) or build.difference(name)


def _built_in(name: str, kind: str, start: str) -> Path:
    """Return the file of a built-in FMU of a kind. Raises ConfigError where it must be native and cannot."""
    if kind != "python":
        from ..fmus.native import build as native

        if not (reason := native.why_not(name) if kind == "native" else left_in_python(name)):
            return native.native_built(name)
        if kind == "native":
            raise ConfigError(
                f'{start}{name} cannot be a native unit: {reason}; --units auto, in Python units="auto", '
                "runs it in Python"
            )
    from ..fmus import build

    return build.built(name)


def fmu_file(name: str, beside: Path | None = None, place: str = "", units: str | None = None) -> Path:
    """Return the file of an FMU: a built-in name (built now if the cache does not have it), or a path.

    `units` is the kind of built-in FMUs, a UnitsName, by default that of `units_run`. A relative path is
    looked up beside the file `beside` that names it, then from the working folder. Raises ConfigError with
    the nearest name if there is no such file; it starts with `place`, the file and its key.
    """
    from ..fmus import build

    start = f"{place}: " if place else ""
    if name in build.names():
        return _built_in(name, units or _KIND.get(), start)
    for path in ([beside.parent / name] if beside is not None else []) + [Path(name)]:
        if is_file(path):
            from ..cosim.system.kinds import kind_of, other_file  # heavy for the process of a unit

            if path.suffix.lower() == ".toml" and (said := other_file(path)):
                raise ConfigError(f"{start}{said}")
            if path.suffix.lower() not in (".fmu", ".zip") and (said := kind_of(path, "FMU")):
                raise ConfigError(f"{start}{said}")
            return path
    if name.endswith(".fmu") or "/" in name or "\\" in name:
        sought = beside.parent / name if beside is not None else Path(name)
        raise ConfigError(f"{start}{name[:200]}: there is no such FMU file{near_file(sought)}")
    raise ConfigError(
        f"{start}there is no built-in FMU {short(name)}{nearest(name, build.names())}; "
        f"built in: {', '.join(build.names())}"
    )
